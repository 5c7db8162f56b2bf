//! The trait of backends that take raw problems.

use super::{RawFriction, RawLcp, RawSolution};
use crate::LcpError;

/// Solves raw problems: a pure function of problem and settings, as
/// [`LcpSolver`](crate::LcpSolver).
pub trait RawSolver: Send + Sync {
    /// Name for messages and tables.
    fn name(&self) -> &'static str;

    /// Solves `problem`.
    ///
    /// # Errors
    /// [`LcpError::OutsideClass`] if the backend does not take such matrices,
    /// [`LcpError::Infeasible`] if no z ≥ 0 has w ≥ 0, [`LcpError::NotConverged`] if no solution was
    /// found (there may be none), and a refusal of wrong sizes and numbers that are not finite.
    fn solve_raw(&self, problem: &RawLcp) -> Result<RawSolution, LcpError>;

    /// Solves a planar friction problem; the solution is that of [`RawFriction::to_raw`].
    ///
    /// # Errors
    /// As [`solve_raw`](Self::solve_raw).
    fn solve_friction(&self, problem: &RawFriction) -> Result<RawSolution, LcpError> {
        problem.validate()?;
        problem.judged(self.name(), self.solve_raw(&problem.to_raw())?)
    }
}
