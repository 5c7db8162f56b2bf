//! Solvers in turn.

use crate::{Guess, Lcp, LcpError, LcpSolution, LcpSolver, Scratch};

/// Tries solvers in turn until the natural residual confirms an answer.
///
/// [`SolveStats::attempt`](crate::SolveStats::attempt) of the solution says which one answered. A refusal of the problem
/// itself ends the search; every other failure hands over. If all fail, the error is a conflict of
/// constraints if one found such, and otherwise the failure with the least residual.
pub struct Fallback {
    /// The solvers, in the order in which they are tried.
    pub solvers: Vec<Box<dyn LcpSolver>>,
    /// Greatest natural residual, free of units, of an accepted answer.
    pub acceptance: f64,
}

impl Fallback {
    /// The solvers given, accepting residuals up to 1e-10.
    #[must_use]
    pub fn new(solvers: Vec<Box<dyn LcpSolver>>) -> Self {
        Self { solvers, acceptance: 1e-10 }
    }

    /// Name of the solver that gave a solution of this `Fallback`.
    #[must_use]
    pub fn answered(&self, solution: &LcpSolution) -> Option<&'static str> {
        Some(self.solvers.get(solution.stats.attempt as usize)?.name())
    }
}

impl LcpSolver for Fallback {
    fn name(&self) -> &'static str {
        "fallback"
    }

    fn solve(
        &self,
        problem: &Lcp,
        guess: Option<&Guess>,
        scratch: &mut Scratch,
    ) -> Result<LcpSolution, LcpError> {
        problem.validate()?;
        let mut failure = None;
        for (attempt, solver) in (0..).zip(&self.solvers) {
            let error = match solver.solve(problem, guess, scratch) {
                Ok(mut solution) => {
                    let residual = problem.residual(&solution).max();
                    if residual <= self.acceptance {
                        solution.stats.attempt = attempt;
                        return Ok(solution);
                    }
                    let (solver, tolerance) = (solver.name(), self.acceptance);
                    LcpError::Rejected { solver, residual, tolerance }
                }
                Err(error) => error,
            };
            failure = Some(worth_more(error, failure));
        }
        Err(failure.unwrap_or(NOTHING_TRIED))
    }
}

const NOTHING_TRIED: LcpError = LcpError::NotConverged { iterations: 0, residual: f64::INFINITY };

/// The error that says more.
fn worth_more(error: LcpError, other: Option<LcpError>) -> LcpError {
    let told = |error: &LcpError| {
        let infeasible = matches!(error, LcpError::Infeasible { .. });
        (!infeasible, error.residual().unwrap_or(f64::INFINITY))
    };
    match other {
        Some(other) if told(&other) <= told(&error) => other,
        _ => error,
    }
}
