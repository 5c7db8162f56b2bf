//! What scenes look like: a replay page that plays runs in a browser without a network, and pictures.
//!
//! A [`Run`] is the motion of a scene over time, [`Run::from_rollout`] makes one, and [`replay_html`] is
//! the page that plays it. A [`Picture`] of so many pixels draws a scene at a state as an [`Image`], which is
//! RGB bytes or a PNG file; the part of the world that it shows is a [`View`], and [`View::fit`] finds one for a
//! state or a whole run.
//!
//! The crate reads scenes, states and records, and knows nothing of solvers, gradients or files: what it
//! makes are strings and bytes, and the same input gives the same ones.

// In reading order: what things look like,
mod joint_look;
mod look;
mod palette;
mod view;
// pages,
mod replay;
mod run;
// pictures,
mod canvas;
mod clip;
mod draw_body;
mod draw_joint;
mod image;
mod picture;
// and what can be wrong.
mod error;

pub use error::ViewError;
pub use image::Image;
pub use palette::Rgb;
pub use picture::{Picture, Style};
pub use replay::{escape_html, replay_html};
pub use run::{Frame, Push, Run};
pub use view::View;
