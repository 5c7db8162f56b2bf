//! Plans motions: which controls bring a system where it should be, at the least cost?
//!
//! ```text
//!  minimise  Σₖ l(k, xₖ, uₖ) + l_T(x_T)     xₖ₊₁ = f(xₖ, uₖ)     lower ≤ uₖ ≤ upper
//! ```
//!
//! [`Planner`] improves a first guess of the controls by iterative LQR: it expands dynamics and cost
//! along the motion, solves the quadratic problem that this gives backwards in time, within the limits,
//! and steps along its solution as far as that pays (Tassa, Mansard & Todorov 2014, *Control-limited
//! differential dynamic programming*). The answer is a [`Plan`]: controls, motion, and gains that
//! correct small deviations from it.
//!
//! What moves is anything that has [`Dynamics`]: [`SceneDynamics`] are those of a scene. What it costs
//! is anything that is a [`Cost`]: [`Quadratic`] or one's own. Neither knows of the other, and nothing
//! here knows how a step is solved. Same input, same bits.
//!
//! Where not controls but a few numbers are sought (a throw, a mass), or second derivatives are of no use,
//! a loss is made small by [`GradientDescent`], [`Lbfgs`] or [`GaussNewton`]: of anything that is an
//! [`Objective`] or a sum of [`LeastSquares`]. [`Shooting`] is the cost of a scene's motion as such a loss.

// In reading order: what is planned for,
mod cost;
mod dynamics;
mod limits;
mod quadratic;
mod scene_dynamics;
// one quadratic problem, a sweep of them backwards in time, a motion forwards,
mod backward;
mod box_qp;
mod motion;
mod regularisation;
// the iteration, and how it ends.
mod error;
mod plan;
mod planner;
// Losses of numbers, and how they are made small.
mod bounds;
mod gauss_newton;
mod gradient_descent;
mod lbfgs;
mod objective;
mod shooting;

pub use bounds::Bounds;
pub use box_qp::{BoxQp, BoxQpSolution};
pub use cost::{Cost, Expansion, LastExpansion};
pub use dynamics::{Dynamics, Linearisation};
pub use error::PlanError;
pub use gauss_newton::GaussNewton;
pub use gradient_descent::GradientDescent;
pub use lbfgs::Lbfgs;
pub use limits::ControlLimits;
pub use objective::{Iterate, LeastSquares, Objective, Residuals, SearchError, Slope, Watch};
pub use plan::{Ending, Plan};
pub use planner::Planner;
pub use quadratic::Quadratic;
pub use scene_dynamics::{SceneDynamics, SceneDynamicsError};
pub use shooting::{Shooting, ShootingError};
