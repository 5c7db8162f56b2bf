//! Physics with known answers: closed forms, conservation laws, exact rational solutions and
//! high-precision references, and what the engine makes of them.
//!
//! ```text
//!  Case ── parts ──► Lab (one backend) ──► Figure (quantity, expected, got, error, tolerance)
//! ```
//!
//! The command `tangency validate` and the tests run the same [`cases`]; [`report`] writes the table.
//! Figures of the grade [`Grade::Step`] must be met by plain fixed stepping. Those of the grades
//! [`Grade::Fine`] and [`Grade::Impact`] are measured with the most accurate stepping that the
//! engine has ([`recommended`]) and are *not reached* until it meets them.
//!
//! Conventions of the cases: plane, SI units, y up, g = 9.81 m/s² downwards unless given, friction
//! and restitution are those of the pair of bodies. This crate names no backend.
//!
//! Reading order: `figure`, `lab` and `run` (how a part measures), `case`, `cases`, `report`.

#![expect(
    clippy::excessive_precision,
    reason = "figures are those of their sources, digit by digit"
)]
#![expect(clippy::unnecessary_wraps, reason = "parts share one signature")]

mod figure;
mod lab;
mod run;
mod tally;

mod case;
mod cases;
pub mod report;

pub use case::{Backend, Case, Part, Stop, measure};
pub use cases::cases;
pub use figure::{Figure, Grade, Relation, Verdict};
pub use lab::{Lab, recommended};
pub use run::{Direction, Run};
pub use tally::Tally;
