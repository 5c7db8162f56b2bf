#![doc = include_str!("../README.md")]

#[cfg(feature = "parallel")]
pub use tangency_batch as batch;
pub use tangency_collision as collision;
pub use tangency_control as control;
pub use tangency_core as core;
pub use tangency_diff as diff;
pub use tangency_lcp as lcp;
#[cfg(feature = "clarabel")]
pub use tangency_lcp_clarabel as lcp_clarabel;
#[cfg(feature = "ipm")]
pub use tangency_lcp_ipm as lcp_ipm;
#[cfg(feature = "lemke")]
pub use tangency_lcp_lemke as lcp_lemke;

mod scene_file;

#[doc = include_str!("../docs/scene-file.md")]
pub mod scene_file_format {}

pub use scene_file::{
    Place, SceneFileError, SceneFormat, load_scene, parse_scene, read_scene, scene_to_json,
    scene_to_toml,
};
pub use tangency_core::*;
pub use tangency_diff::{
    Gradient, GradientMode, GradientReport, Parameter, RolloutVector, RowImpulse, SceneVector,
    StateVector, checkpointed_gradient, gradient, gradient_adding, gradient_with_impulses,
    joint_motion, tangent, tangent_with_impulses,
};
pub use tangency_lcp::{Fallback, LcpSolver};

/// The solver for who does not care which: the first of [`solvers`].
///
/// # Panics
/// Never: it exists only where a backend's feature is on.
#[cfg(any(feature = "ipm", feature = "clarabel"))]
#[must_use]
pub fn default_solver() -> Box<dyn LcpSolver> {
    solvers().swap_remove(0)
}

/// Names of the backends that this build has, as the command line takes them: those of the
/// features.
pub const BACKENDS: &[&str] = &[
    #[cfg(feature = "ipm")]
    "ipm",
    #[cfg(feature = "clarabel")]
    "clarabel",
    #[cfg(feature = "lemke")]
    "lemke",
];

/// The solver of a backend's name, one of [`BACKENDS`].
#[must_use]
pub fn backend(name: &str) -> Option<Box<dyn LcpSolver>> {
    BACKENDS.iter().zip(all_solvers()).find(|(known, _)| **known == name).map(|(_, solver)| solver)
}

/// The solvers of this build that take scenes of any size, in the order of [`BACKENDS`]; empty if
/// no such backend's feature is on.
#[must_use]
pub fn solvers() -> Vec<Box<dyn LcpSolver>> {
    vec![
        #[cfg(feature = "ipm")]
        Box::new(tangency_lcp_ipm::InteriorPoint::default()),
        #[cfg(feature = "clarabel")]
        Box::new(tangency_lcp_clarabel::Clarabel::default()),
    ]
}

/// [`solvers`] that stop at a natural residual of `tolerance` and refuse one above it, or above 1e-10
/// where that is more: for comparing what accuracy costs.
#[cfg(any(feature = "ipm", feature = "clarabel"))]
#[must_use]
pub fn solvers_at(tolerance: f64) -> Vec<Box<dyn LcpSolver>> {
    let acceptance = tolerance.max(1e-10);
    vec![
        #[cfg(feature = "ipm")]
        Box::new(tangency_lcp_ipm::InteriorPoint { tolerance, acceptance, ..Default::default() }),
        #[cfg(feature = "clarabel")]
        Box::new(tangency_lcp_clarabel::Clarabel { tolerance, acceptance, ..Default::default() }),
    ]
}

/// [`solvers`], and those for small problems only: every backend, in the order of [`BACKENDS`].
#[must_use]
pub fn all_solvers() -> Vec<Box<dyn LcpSolver>> {
    let small: Vec<Box<dyn LcpSolver>> = vec![
        #[cfg(feature = "lemke")]
        Box::new(tangency_lcp_lemke::Lemke::default()),
    ];
    solvers().into_iter().chain(small).collect()
}

/// The solvers of raw problems, in the order of [`BACKENDS`].
#[must_use]
pub fn raw_solvers() -> Vec<Box<dyn lcp::RawSolver>> {
    vec![
        #[cfg(feature = "ipm")]
        Box::new(tangency_lcp_ipm::InteriorPoint::default()),
        #[cfg(feature = "clarabel")]
        Box::new(tangency_lcp_clarabel::Clarabel::default()),
        #[cfg(feature = "lemke")]
        Box::new(tangency_lcp_lemke::Lemke::default()),
    ]
}

/// All backends of this build in turn, in the order of [`BACKENDS`].
#[must_use]
pub fn fallback() -> Fallback {
    Fallback::new(all_solvers())
}
