//! What Clarabel's statuses mean here, one by one.

use clarabel::solver::SolverStatus;

/// Why Clarabel gave no iterate to go on with.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ClarabelFailure {
    /// Clarabel refused the program's data.
    #[error("clarabel refused the program: {reason}")]
    Refused {
        /// In Clarabel's words.
        reason: String,
    },
    /// Clarabel stopped without an iterate.
    #[error("clarabel stopped with status {status}")]
    Stopped {
        /// Clarabel's status.
        status: String,
    },
}

/// What to do with an iterate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Judge it by the natural residual.
    Judge,
    /// The rows contradict each other.
    Infeasible,
    /// There is nothing to judge.
    Failed,
}

/// The verdict on a status. Clarabel may stop short of its own tolerance (`AlmostSolved`,
/// `InsufficientProgress`, `NumericalError`, `MaxIterations`) with an iterate that shows the modes.
pub(crate) fn verdict(status: SolverStatus) -> Verdict {
    match status {
        SolverStatus::Solved
        | SolverStatus::AlmostSolved
        | SolverStatus::MaxIterations
        | SolverStatus::MaxTime
        | SolverStatus::NumericalError
        | SolverStatus::InsufficientProgress => Verdict::Judge,
        SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => {
            Verdict::Infeasible
        }
        // The objective is strictly convex, so this is a failure and not a fact.
        SolverStatus::DualInfeasible
        | SolverStatus::AlmostDualInfeasible
        | SolverStatus::Unsolved
        | SolverStatus::CallbackTerminated => Verdict::Failed,
    }
}
