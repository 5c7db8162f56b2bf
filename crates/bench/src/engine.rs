//! What is timed: an engine that builds worlds from scene definitions, and worlds that step.

use tangency_batch::BatchError;
use tangency_core::lcp::LcpError;
use tangency_core::{SceneDef, SceneError, State, StepError};
use tangency_diff::DiffError;

use crate::paths::Paths;

/// Why something was not measured.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// The definition is no scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A step of ours was refused.
    #[error(transparent)]
    Step(#[from] StepError),
    /// A derivative of ours was refused.
    #[error(transparent)]
    Derivative(#[from] DiffError),
    /// A problem was refused by ours.
    #[error(transparent)]
    Problem(#[from] LcpError),
    /// A batch of ours was refused, or one of its environments.
    #[error(transparent)]
    Batch(#[from] BatchError),
    /// The engine has no counterpart for a part of the scene.
    #[error("{engine} has no {what}")]
    Unsupported {
        /// The engine.
        engine: &'static str,
        /// What it lacks.
        what: String,
    },
    /// Another engine gave up.
    #[error("{engine}: {message}")]
    Peer {
        /// The engine.
        engine: &'static str,
        /// What it says.
        message: String,
    },
    /// A state that is not finite.
    #[error("{engine}: the state is not finite after {steps} steps")]
    NotFinite {
        /// The engine.
        engine: String,
        /// Steps so far.
        steps: usize,
    },
    /// A run that nobody could wait for.
    #[error("{engine}: left out, as a step takes about {seconds:.1} s")]
    TooSlow {
        /// The engine.
        engine: String,
        /// Time of one step, s.
        seconds: f64,
    },
}

/// A value and its gradient, computed anew by every call.
pub type ValueAndGradient<'a> = Box<dyn FnMut() -> Result<f64, Refusal> + 'a>;

/// An engine with its settings.
pub trait Engine {
    /// What tables call it.
    fn name(&self) -> String;

    /// What differs from its defaults, and what its defaults are where they matter.
    fn settings(&self) -> String;

    /// A world in the scene's initial state.
    ///
    /// # Errors
    /// A [`Refusal`] where the scene cannot be built.
    fn build(&self, def: &SceneDef) -> Result<Box<dyn World + '_>, Refusal>;

    /// The last body's x after some steps and its gradient, or `None` for an engine without gradients.
    ///
    /// # Errors
    /// A [`Refusal`] where the scene cannot be built.
    fn value_and_gradient(
        &self,
        _def: &SceneDef,
        _steps: usize,
    ) -> Result<Option<ValueAndGradient<'_>>, Refusal> {
        Ok(None)
    }

    /// Which ways the steps of a run take, for an engine that tells.
    fn paths(&self, _def: &SceneDef, _steps: usize) -> Option<Paths> {
        None
    }
}

/// A scene in motion.
pub trait World {
    /// One step of the scene's dt with all controls zero.
    ///
    /// # Errors
    /// A [`Refusal`] where the step has no answer.
    fn step(&mut self) -> Result<(), Refusal>;

    /// Poses and velocities of all bodies, in the definition's order.
    fn state(&self) -> State;
}

/// Whether all numbers of a state are finite.
#[must_use]
pub fn is_finite(state: &State) -> bool {
    state.q.iter().chain(&state.v).all(|part| part.iter().all(|x| x.is_finite()))
}
