//! The state of all bodies at one time.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::StepError;

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

impl State {
    /// Refuses a state that does not fit a scene of so many bodies, or is not finite.
    ///
    /// # Errors
    /// [`StepError::StateSize`], [`StepError::NotFinite`] or [`StepError::TimeNotFinite`].
    pub fn check(&self, expected: usize) -> Result<(), StepError> {
        for found in [self.q.len(), self.v.len()] {
            if found != expected {
                return Err(StepError::StateSize { expected, found });
            }
        }
        let bad = |x: &Vector3<f64>| !x.iter().all(|x| x.is_finite());
        let lists = [("pose of body", &self.q), ("velocity of body", &self.v)];
        for (what, list) in lists {
            if let Some(index) = list.iter().position(bad) {
                return Err(StepError::NotFinite { what, index });
            }
        }
        if self.time.is_finite() {
            Ok(())
        } else {
            Err(StepError::TimeNotFinite { time: self.time })
        }
    }
}
