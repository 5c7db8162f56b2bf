//! Derivatives of the complementarity problem, of steps, and of whole rollouts.
//!
//! Differentiated is everything that enters a step: initial state, controls, masses, inertias,
//! friction, restitution, shapes, gravity, anchors, lengths, motors, limits, springs, forces, dt.
//! Held fixed are discrete choices: which features touch, and on which piece of its law each row
//! lies. At a switch the derivative is one-sided, and [`GradientReport`] says so.
//!
//! Needed are only the problem and its solution, whichever solver found it: the modules mirror the
//! engine's stages, and none looks inside a solver. The formulas are in `docs/maths.md`, section 5.

// In reading order: one problem,
pub mod lcp;
// what it was assembled from,
mod contact_row;
mod island;
mod joint_row;
mod momentum;
mod rotations;
mod shape;
mod softening;
mod spring;
mod vector;
// steps and rollouts,
mod checkpoints;
mod division;
mod error;
mod event;
mod growth;
mod impulse;
mod mode;
mod report;
mod reverse;
mod rollout;
mod seeds;
mod sizes;
mod smooth;
mod step;
// all derivatives of a step at once, and products with those of a rollout,
mod coordinates;
mod gauss_newton;
mod joint_force;
mod step_jacobian;
// and what may be differentiated by: parameters by name, joints with what hangs on them.
mod joint_motion;
mod loop_motion;
mod parameter;

pub use checkpoints::{checkpointed_gradient, checkpointed_gradient_with_impulses};
pub use coordinates::Coordinates;
pub use error::DiffError;
pub use gauss_newton::{GaussNewton, ResidualSeed};
pub use impulse::RowImpulse;
pub use joint_motion::{JointMotion, JointMotionError, joint_motion};
pub use mode::GradientMode;
pub use parameter::{Parameter, ParameterError};
pub use report::{GaveWay, GradientReport, OneSided, Switch};
pub use rollout::{
    Gradient, gradient, gradient_adding, gradient_with_impulses, tangent, tangent_with_impulses,
};
pub use step::{step_jvp, step_vjp};
pub use step_jacobian::{StepJacobian, step_jacobian};
pub use vector::{BodyVector, Direction, JointVector, RolloutVector, SceneVector, StateVector};
