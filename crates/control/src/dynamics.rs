//! What moves: a state, a control, the state after a step, and how that depends on both.

use std::error::Error;

use nalgebra::{DMatrix, DVector};

/// A system in discrete time, x⁺ = f(x, u).
///
/// A state may be more than its coordinates x: whatever a step needs. A step may be more than the state
/// after it: whatever its derivative needs.
pub trait Dynamics {
    /// A state.
    type State: Clone;
    /// A step taken.
    type Step;
    /// Why a step or a derivative could not be taken.
    type Error: Error + Send + Sync + 'static;

    /// n, how many coordinates a state has.
    fn states(&self) -> usize;

    /// m, how many numbers a control has.
    fn controls(&self) -> usize;

    /// x, the coordinates that the cost sees.
    fn coordinates(&self, state: &Self::State) -> DVector<f64>;

    /// One step. The step before it, if there is one, may serve as a first guess.
    ///
    /// # Errors
    /// Why it could not be taken; the planner then looks for a shorter way.
    fn step(
        &mut self,
        state: &Self::State,
        before: Option<&Self::Step>,
        control: &[f64],
    ) -> Result<Self::Step, Self::Error>;

    /// The state after a step.
    fn after<'a>(&self, step: &'a Self::Step) -> &'a Self::State;

    /// A and B of a step that was taken from `state`.
    ///
    /// # Errors
    /// Why they could not be computed.
    fn linearise(
        &self,
        state: &Self::State,
        step: &Self::Step,
    ) -> Result<Linearisation, Self::Error>;
}

/// The derivatives of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct Linearisation {
    /// A = ∂x⁺/∂x, n × n.
    pub state: DMatrix<f64>,
    /// B = ∂x⁺/∂u, n × m.
    pub control: DMatrix<f64>,
}
