//! What tests, examples and benchmarks share: scenes, the finite difference, measurements.
//!
//! Nothing here is part of the engine. [`finite_difference`] is the only place of the repository
//! that approximates a derivative by differences; [`scenes`] holds the scenes of the validation
//! cases, of the paper's experiment, and some small machines; [`random_scene`] makes others from
//! seeds; [`retelling`] tells the same scene otherwise; [`state_hash`] tells whether two
//! runs are the same.
//!
//! What is measured: an [`Engine`](engine::Engine), [ours](own) or one of the `peers`, in a
//! [race] on the same scenes, as [time against error](precision), over the [size](growth) of a scene; the
//! [paths] that steps took; solvers alone on [recorded] problems; and that a scene costs
//! [only what it needs](lean). [`timing`] is the clock.

pub mod finite_difference;
pub mod mutation;
pub mod problems;
mod random_scene;
pub mod retelling;
pub mod scenes;
pub mod signature;
mod state_hash;

pub mod check;
pub mod memory;
pub mod timing;
// What runs,
pub mod engine;
pub mod own;
#[cfg(feature = "peers")]
pub mod peers;
// and what is asked of it.
pub mod batch;
pub mod gradients;
pub mod growth;
pub mod lean;
pub mod paths;
pub mod precision;
pub mod race;
pub mod recorded;

pub use random_scene::{is_driven, random_scene};
pub use state_hash::state_hash;
