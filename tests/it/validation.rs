//! The validation cases by number, *step* grade, with the derivatives that plain stepping gets
//! right. Their figures are never loosened.

mod chain;
mod collisions;
mod cradle;
mod flight;
mod incline;
mod pendulum;
mod quiet;
mod redundant;
mod rolling;
mod sliding;
mod standing;
