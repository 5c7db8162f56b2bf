//! What can go wrong when differentiating.

use crate::lcp::LcpDiffError;

/// A derivative that could not be taken.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DiffError {
    /// The derivative of an island's problem failed.
    #[error(transparent)]
    Lcp(#[from] LcpDiffError),
    /// The same, with the step at which it happened.
    #[error("step {step}: {source}")]
    Step {
        /// The step.
        step: usize,
        /// Why.
        source: LcpDiffError,
    },
}

impl DiffError {
    /// Adds the step.
    pub(crate) fn at(self, step: usize) -> Self {
        match self {
            Self::Lcp(source) | Self::Step { source, .. } => Self::Step { step, source },
        }
    }
}
