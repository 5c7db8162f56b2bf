//! What tests, examples and benchmarks share: named scenes, and the finite difference.
//!
//! Nothing here is part of the engine. [`finite_difference`] is the only place of the repository
//! that approximates a derivative by differences; [`scenes`] holds the scenes of the validation
//! cases, of the paper's experiment, and some small machines; [`random_scene`] makes others from
//! seeds; [`retelling`] tells the same scene otherwise; [`state_hash`] tells whether two
//! runs are the same.

pub mod finite_difference;
pub mod mutation;
pub mod problems;
mod random_scene;
pub mod retelling;
pub mod scenes;
mod state_hash;

pub use random_scene::{is_driven, random_scene};
pub use state_hash::state_hash;
