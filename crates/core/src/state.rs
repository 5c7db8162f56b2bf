//! The state of all bodies at one time.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Poses and velocities of all bodies, static ones included, in the scene's order.
///
/// Saved and loaded by serde without loss.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Time, s.
    pub time: f64,
    /// Poses of the centres of mass, (x m, y m, θ rad) each.
    pub q: Vec<Vector3<f64>>,
    /// Velocities, (m/s, m/s, rad/s) each.
    pub v: Vec<Vector3<f64>>,
}
