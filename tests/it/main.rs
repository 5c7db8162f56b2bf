//! The engine as its users see it, on every backend of the build.
//!
//! Modules by question; what they share is [`engine`] (runs on every backend). Scenes and the finite
//! difference come from `tangency-bench`.

#![expect(
    clippy::excessive_precision,
    reason = "figures are those of the validation cases, digit by digit"
)]

mod engine;

mod accurate;
mod afar;
mod backends;
mod conformance;
mod conservation;
mod determinism;
mod forces;
mod fuzzed;
mod gauss_newton;
mod giving_way;
mod gradients;
mod horizons;
mod impacts;
mod impulses;
mod joint_motions;
mod joints;
mod modelling;
mod motors;
mod planning;
mod random_scenes;
mod reach;
mod records;
mod refusals;
mod regressions;
mod searching;
mod smoothed;
mod springs;
mod stabilisation;
mod step_jacobians;
mod transpose;
mod validation;
mod walks;
