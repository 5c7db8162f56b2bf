//! What can go wrong in a batch, and in one environment of it.

use tangency_core::StepError;
use tangency_diff::DiffError;

/// Why one environment of a batch failed. The others are not affected.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Failure {
    /// A step could not be taken.
    #[error("environment {environment}, step {step}: {source}")]
    Step {
        /// The environment.
        environment: usize,
        /// The step, counted from 0 in the call that failed.
        step: usize,
        /// Why.
        source: StepError,
    },
    /// There is no rollout to differentiate.
    #[error("environment {environment} has no rollout; look at why that failed")]
    NoRollout {
        /// The environment.
        environment: usize,
    },
    /// A derivative could not be taken.
    #[error("environment {environment}: {source}")]
    Gradient {
        /// The environment.
        environment: usize,
        /// Why.
        source: DiffError,
    },
    /// A loss is NaN or infinite.
    #[error(
        "environment {environment}: the loss is {value}; look for a division by zero or an overflow"
    )]
    Loss {
        /// The environment.
        environment: usize,
        /// The loss.
        value: f64,
    },
}

impl Failure {
    /// The environment that failed.
    #[must_use]
    pub fn environment(&self) -> usize {
        match self {
            Self::Step { environment, .. }
            | Self::NoRollout { environment }
            | Self::Gradient { environment, .. }
            | Self::Loss { environment, .. } => *environment,
        }
    }
}

/// What a batch refuses, or the failures of its environments.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BatchError {
    /// Scenes that are driven by different numbers of channels.
    #[error(
        "the scene of environment {environment} has {found} control channels, that of environment 0 \
         {expected}; give all scenes the same channels"
    )]
    Channels {
        /// The environment.
        environment: usize,
        /// Channels of environment 0.
        expected: usize,
        /// Channels of this one.
        found: usize,
    },
    /// Controls that do not fit the batch.
    #[error("the controls have {found} numbers; {layout} is {expected}")]
    ControlSize {
        /// How they are laid out.
        layout: &'static str,
        /// Expected length.
        expected: usize,
        /// Length found.
        found: usize,
    },
    /// Not one rollout, or one empty place, per environment.
    #[error("{found} rollouts were given for {expected} environments")]
    Rollouts {
        /// Environments.
        expected: usize,
        /// Rollouts and empty places given.
        found: usize,
    },
    /// A state that an environment cannot be put into.
    #[error("environment {environment} cannot be reset: {source}")]
    State {
        /// The environment.
        environment: usize,
        /// Why.
        source: StepError,
    },
    /// Some environments failed; all others are done.
    #[error("{} of {of} environments failed; the first: {}", failures.len(), failures[0])]
    Failed {
        /// Environments in all.
        of: usize,
        /// Why each of them failed, in their order; never empty.
        failures: Vec<Failure>,
    },
}
