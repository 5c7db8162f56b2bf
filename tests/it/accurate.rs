//! Accurate stepping: order 4 between events, events at their own time, derivatives of the motion.

mod events;
mod gradients;
mod smooth;
mod users;

use tangency::{SceneDef, Stepping};

/// The scene in accurate steps of a length.
pub(crate) fn accurate(def: SceneDef, dt: f64) -> SceneDef {
    SceneDef { dt, stepping: Stepping::Accurate { max_events: 32 }, ..def }
}
