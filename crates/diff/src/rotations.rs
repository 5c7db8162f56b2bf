//! Rotations of bodies: their sines and cosines cost more than all else that is done with them.

use nalgebra::UnitComplex;
use tangency_core::Pose;

/// R(θ) per body, computed when it is first asked for.
#[derive(Debug, Default)]
pub(crate) struct Rotations(Vec<Option<UnitComplex<f64>>>);

impl Rotations {
    /// Forgets all, for other poses of so many bodies.
    pub(crate) fn renew(&mut self, bodies: usize) {
        self.0.clear();
        self.0.resize(bodies, None);
    }

    /// R(θ) of a body at its pose.
    pub(crate) fn of(&mut self, body: usize, pose: &Pose) -> UnitComplex<f64> {
        *self.0[body].get_or_insert_with(|| UnitComplex::new(pose.z))
    }
}
