//! Batches: many environments stepped, rolled out and differentiated side by side over all cores.
//!
//! A [`Batch`] holds environments: each a scene (one for all, or one each with numbers of its own) and
//! the state that it has come to. Two kinds of work are done on all of them at once:
//!
//! ```text
//!  step, advance                     move the environments, each warm from its own last step
//!  rollout, map_rollouts,            look ahead from where each environment is, and leave it there
//!  gradient, value_and_gradient,
//!  checkpointed_value_and_gradient
//! ```
//!
//! Environments know nothing of each other: what one does has the same bits as a
//! [`Simulator`](tangency_core::Simulator), [`rollout`](tangency_core::rollout) or
//! [`gradient`](tangency_diff::gradient) by itself, whatever the number of threads. If one fails, that
//! one is reported with its index and all others go on.
//!
//! Work is shared out over the threads of rayon: those of the pool in which a method is called
//! (`pool.install(|| batch.step(…))`), else all cores.

// In reading order: what a batch is,
mod batch;
mod environment;
// what drives it,
mod controls;
mod workspace;
// what it does,
mod advance;
mod gradient;
mod rollout;
// and how that ends.
mod error;
mod outcomes;

pub use batch::Batch;
pub use controls::{Controls, Policy};
pub use error::{BatchError, Failure};
pub use gradient::Evaluation;
pub use outcomes::Outcomes;
