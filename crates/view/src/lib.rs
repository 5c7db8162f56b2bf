//! What scenes look like: a replay page that plays runs in a browser, without a network.
//!
//! A [`Run`] is the motion of a scene over time, [`Run::from_rollout`] makes one, and [`replay_html`] is
//! the page that plays it. The crate reads scenes, states and records, and knows nothing of solvers, gradients or
//! files: what it makes are strings and bytes.

mod replay;
mod run;

pub use replay::{escape_html, replay_html};
pub use run::{Frame, Push, Run};
