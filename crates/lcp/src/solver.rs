//! The one trait that every backend implements.

use crate::{Lcp, LcpError, LcpSolution, Mode, Residual, solve_linear};

/// A starting guess, from the step before or from the caller; it never changes what is accepted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Guess {
    /// Mode per row.
    pub modes: Vec<Mode>,
    /// Impulses per row.
    pub impulses: Vec<f64>,
}

/// Buffers that survive between solves so that they need not be allocated again; their content
/// never changes a result.
#[derive(Debug, Default)]
pub struct Scratch {
    buffers: Vec<Vec<f64>>,
}

impl Scratch {
    /// A zeroed buffer of `len` numbers.
    pub fn take(&mut self, len: usize) -> Vec<f64> {
        let mut buffer = self.buffers.pop().unwrap_or_default();
        buffer.clear();
        buffer.resize(len, 0.0);
        buffer
    }

    /// Gives a buffer back for later use.
    pub fn give(&mut self, buffer: Vec<f64>) {
        self.buffers.push(buffer);
    }
}

/// Solves mixed complementarity problems: a pure function of problem, settings and guess.
pub trait LcpSolver: Send + Sync {
    /// Name for messages and records.
    fn name(&self) -> &'static str;

    /// Solves `problem`.
    ///
    /// # Errors
    /// An [`LcpError`] with the best residual reached when no solution was found.
    fn solve(
        &self,
        problem: &Lcp,
        guess: Option<&Guess>,
        scratch: &mut Scratch,
    ) -> Result<LcpSolution, LcpError>;
}

/// Solves and judges: the solution with its natural residual, which is at most `tolerance`.
/// Problems without inequalities never reach the solver.
///
/// # Errors
/// What the solver reports, or [`LcpError::Rejected`] if the residual does not confirm its answer.
pub fn solve_checked(
    solver: &dyn LcpSolver,
    problem: &Lcp,
    guess: Option<&Guess>,
    scratch: &mut Scratch,
    tolerance: f64,
) -> Result<(LcpSolution, Residual), LcpError> {
    let solution = if problem.is_linear() {
        solve_linear(problem)?
    } else {
        solver.solve(problem, guess, scratch)?
    };
    let residual = problem.residual(&solution);
    if residual.max() <= tolerance {
        Ok((solution, residual))
    } else {
        let (solver, residual) = (solver.name(), residual.max());
        Err(LcpError::Rejected { solver, residual, tolerance })
    }
}
