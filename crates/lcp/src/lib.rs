//! The mixed linear complementarity problem of one planar time step.
//!
//! Knows masses, momenta and scalar rows with a law each; knows nothing of shapes, joints, time or
//! any solver's inside. Read in the order of the modules: the problem and what a solution is; the
//! residual, which alone decides whether a candidate is one; the linear system that remains once
//! every row's mode is known; the polish, which turns a guess of the modes into an exact solution;
//! sweeps, walks and combinations of modes for where that fails; the trait that backends implement, and
//! the search that they share; the paper's dense form.

mod active_rows;
mod active_system;
mod amplification;
mod band;
mod banded;
mod barrier;
mod block;
mod block_factor;
mod body_system;
mod box_form;
mod candidate;
mod central;
mod cholesky;
mod combinations;
mod corrections;
mod delassus;
mod dense;
mod determined;
mod equations;
mod error;
mod factor;
mod fallback;
mod given;
mod linear;
mod metric;
mod modes;
mod narrow;
mod order;
mod pattern;
mod polish;
mod pool;
mod problem;
mod pseudo_inverse;
mod raw;
mod refinement;
mod released;
mod residual;
mod rows;
mod saddle;
mod scratch;
mod search;
mod solution;
mod solver;
mod sweeps;
mod validate;
mod walk;

pub use active_system::{ActiveSystem, Fold};
pub use band::{BandMatrix, Lu};
pub use body_system::{Added, BodySystem};
pub use box_form::{BoxForm, BoxLaw};
pub use candidate::Polished;
pub use central::CentralPoint;
pub use cholesky::Cholesky;
pub use delassus::Delassus;
pub use dense::{PaperForm, PaperSolution};
pub use error::LcpError;
pub use fallback::Fallback;
pub use given::solve_in_modes;
pub use linear::solve_linear;
pub use metric::Metric;
pub use modes::{WeakKind, WeakRow};
pub use polish::Polish;
pub use pool::Pool;
pub use problem::{Law, Lcp, NO_BODY, Row};
pub use pseudo_inverse::pseudo_inverse;
pub use raw::{RawFriction, RawLcp, RawPolish, RawSolution, RawSolver};
pub use refinement::Reduced;
pub use residual::Residual;
pub use scratch::Scratch;
pub use search::Search;
pub use solution::{LcpSolution, Method, Mode, SolveStats};
pub use solver::{Guess, LcpSolver, solve_assembled, solve_checked};
pub use sweeps::Sweeps;
pub use walk::{Walk, walks};
