//! Clarabel as a backend: friction by a sequence of convex programs.
//!
//! The problem with friction is not convex: handed its matrix as a quadratic program, a convex solver
//! answers *solved* with a wrong answer. De Saxcé's change of variables makes it convex once
//! `s = μ|u_t|` is held fixed (De Saxcé & Feng 1998; Cadoux and Acary's fixed point, Acary et al.
//! 2011):
//!
//! ```text
//!  QP(s):  min ½ vᵀMv − pᵀv    subject to    J_e v = b_e
//!                                            (Jₙ ± μ Jₜ) v − (bₙ ± μ bₜ) + s ≥ 0
//!  s ← μ |Jₜ v − bₜ|           until the modes that the iterate shows solve the problem
//! ```
//!
//! The iterate only has to be good enough to read a mode per row: the polish that all backends share
//! then gives the solution to rounding, and the residual judges it. Without friction one program is
//! enough. Where the accelerated iteration cycles, Tresca's frozen bounds and a damped iteration are
//! tried; a problem that none of them solves is an error with its residual.
//!
//! Read `conic` for the program, `fixed_point` for the iterations, `status` for what Clarabel's answers
//! mean, `raw` for problems given as a matrix.

mod anderson;
mod conic;
mod fixed_point;
mod raw;
mod status;

pub use fixed_point::{Clarabel, FrictionCone};
pub use status::ClarabelFailure;
