//! What can go wrong when differentiating.

use tangency_core::{RowSource, StepError};

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
    /// A vector or a rollout does not fit the scene.
    #[error("{what} has {found} entries, expected {expected}; make it for this scene and rollout")]
    Size {
        /// The vector.
        what: &'static str,
        /// Expected length.
        expected: usize,
        /// Length found.
        found: usize,
    },
    /// An index beyond the end of what it counts.
    #[error("{what} is {found}, but there are only {count}, counted from 0")]
    Index {
        /// The index.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// The index found.
        found: usize,
    },
    /// The loss is said to depend on the impulse of a row that the step did not model.
    #[error(
        "the step has no row {row:?} in its part {part:?}; take the rows from the step's record"
    )]
    NoSuchRow {
        /// The part of the step.
        part: Option<usize>,
        /// The row.
        row: RowSource,
    },
    /// A segment of a checkpointed run could not be run again.
    #[error("running a segment again: {0}; give the scene and the solver of the run")]
    Replay(#[from] StepError),
    /// A segment of a checkpointed run did not end where it did.
    #[error(
        "steps {first} to {last}, run again, end in another state; give the scene and the solver of \
         the run"
    )]
    OtherRun {
        /// The first step of the segment.
        first: usize,
        /// Its last step.
        last: usize,
    },
    /// A number that was given, or that came out, is NaN or infinite.
    #[error("{what} is not finite; look for a division by zero in the loss, or for an overflow")]
    NotFinite {
        /// The vector.
        what: &'static str,
    },
}

impl DiffError {
    /// Adds the step.
    pub(crate) fn at(self, step: usize) -> Self {
        match self {
            Self::Lcp(source) | Self::Step { source, .. } => Self::Step { step, source },
            other => other,
        }
    }
}
