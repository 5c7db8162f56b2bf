//! What a loss tells the reverse pass: its derivatives by states and by impulses.

use tangency_core::{Scene, State, StepRecord};

use crate::error::DiffError;
use crate::impulse::RowImpulse;
use crate::sizes;
use crate::vector::StateVector;

pub(crate) const SEED: &str = "the seed of a state";

/// Derivatives of a loss, asked for from the last state to the first.
pub(crate) trait Seeds {
    /// Adds ∂L/∂(state k) to `bar`, or refuses.
    fn add(
        &mut self,
        scene: &Scene,
        k: usize,
        state: &State,
        bar: &mut StateVector,
    ) -> Result<(), DiffError>;

    /// ∂L/∂λ of step k.
    fn impulses(&mut self, _k: usize, _record: &StepRecord) -> Vec<RowImpulse> {
        Vec::new()
    }
}

/// A loss that gives its derivative by a state.
pub(crate) struct Giving<F>(pub(crate) F);

impl<F: FnMut(usize, &State) -> Option<StateVector>> Seeds for Giving<F> {
    fn add(
        &mut self,
        scene: &Scene,
        k: usize,
        state: &State,
        bar: &mut StateVector,
    ) -> Result<(), DiffError> {
        let Some(more) = (self.0)(k, state) else { return Ok(()) };
        sizes::state_vector(SEED, scene, &more)?;
        bar.add(&more);
        Ok(())
    }
}

/// A loss that adds its derivative by a state.
pub(crate) struct Adding<F>(pub(crate) F);

impl<F: FnMut(usize, &State, &mut StateVector)> Seeds for Adding<F> {
    fn add(
        &mut self,
        scene: &Scene,
        k: usize,
        state: &State,
        bar: &mut StateVector,
    ) -> Result<(), DiffError> {
        (self.0)(k, state, bar);
        sizes::state_vector(SEED, scene, bar)
    }
}

/// A loss that sees impulses, too.
pub(crate) struct WithImpulses<S, F>(pub(crate) S, pub(crate) F);

impl<S: Seeds, F: FnMut(usize, &StepRecord) -> Vec<RowImpulse>> Seeds for WithImpulses<S, F> {
    fn add(
        &mut self,
        scene: &Scene,
        k: usize,
        state: &State,
        bar: &mut StateVector,
    ) -> Result<(), DiffError> {
        self.0.add(scene, k, state, bar)
    }

    fn impulses(&mut self, k: usize, record: &StepRecord) -> Vec<RowImpulse> {
        (self.1)(k, record)
    }
}
