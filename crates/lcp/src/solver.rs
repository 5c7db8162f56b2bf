//! The one trait that every backend implements.

use crate::linear::solve_linear_in;
use crate::{
    Lcp, LcpError, LcpSolution, Method, Metric, Mode, Polish, Polished, Residual, Scratch,
};

/// A starting guess, from the step before or from the caller; it never changes what is accepted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Guess {
    /// Mode per row.
    pub modes: Vec<Mode>,
    /// Impulses per row.
    pub impulses: Vec<f64>,
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

/// Corrections of a guess's modes before the solver is asked.
const WARM_FLIPS: u32 = 8;
/// Natural residual at which a guess counts as confirmed.
const WARM_TARGET: f64 = 1e-12;
/// The same where rows depend on each other, if the tolerance is not smaller.
const WARM_DEPENDENT: f64 = 1e-10;

/// Solves and judges: the solution with its natural residual, which is at most `tolerance`.
///
/// Problems without inequalities never reach the solver, nor do those that a guess solves: its modes,
/// corrected a few times, give an exact solution or none.
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
    problem.validate()?;
    let metric = scratch.metric(problem);
    let judged = judged(solver, problem, guess, &metric, scratch, tolerance);
    scratch.give_metric(metric);
    judged
}

/// The same for a problem whose sizes, indices and signs are right because an engine put them there.
///
/// # Errors
/// As [`solve_checked`]: numbers that are not finite or too large are found all the same.
///
/// # Panics
/// If an index is out of range.
pub fn solve_assembled(
    solver: &dyn LcpSolver,
    problem: &Lcp,
    guess: Option<&Guess>,
    scratch: &mut Scratch,
    tolerance: f64,
) -> Result<(LcpSolution, Residual), LcpError> {
    let metric = scratch.metric(problem);
    if !metric.is_finite() {
        problem.validate()?;
    }
    let judged = judged(solver, problem, guess, &metric, scratch, tolerance);
    scratch.give_metric(metric);
    judged
}

fn judged(
    solver: &dyn LcpSolver,
    problem: &Lcp,
    guess: Option<&Guess>,
    metric: &Metric,
    scratch: &mut Scratch,
    tolerance: f64,
) -> Result<(LcpSolution, Residual), LcpError> {
    let (solution, residual) = answer(solver, problem, guess, metric, tolerance, scratch)?;
    if residual.max() <= tolerance {
        Ok((solution, residual))
    } else {
        let (solver, residual) = (solver.name(), residual.max());
        Err(LcpError::Rejected { solver, residual, tolerance })
    }
}

fn answer(
    solver: &dyn LcpSolver,
    problem: &Lcp,
    guess: Option<&Guess>,
    metric: &Metric,
    tolerance: f64,
    scratch: &mut Scratch,
) -> Result<(LcpSolution, Residual), LcpError> {
    if problem.is_linear() {
        return solve_linear_in(problem, metric, scratch);
    }
    if let Some(warm) = guess.and_then(|guess| warm(problem, metric, guess, tolerance, scratch)) {
        return Ok((warm.solution, warm.residual));
    }
    let solution = solver.solve(problem, None, scratch)?;
    let residual = problem.residual_with(metric, &solution, scratch);
    Ok((solution, residual))
}

/// The solution that a guess leads to. Where rows depend on each other, right-hand sides contradict each
/// other by their rounding, which weighs the more the shorter a step is: nobody could find a better one, and
/// it is enough that the residual is accepted.
fn warm(
    problem: &Lcp,
    metric: &Metric,
    guess: &Guess,
    tolerance: f64,
    scratch: &mut Scratch,
) -> Option<Polished> {
    let rows = problem.rows.len();
    if guess.modes.len() != rows {
        return None;
    }
    let usable = guess.impulses.len() == rows && guess.impulses.iter().all(|y| y.is_finite());
    let start = usable.then_some(&guess.impulses[..]);
    let polish = Polish::new(problem, metric, WARM_TARGET, WARM_FLIPS);
    let mut found = polish.modes(&guess.modes, start, scratch);
    found.solution.stats.method = Method::Warm;
    let dependent = found.solution.system.as_ref().is_some_and(|it| it.rank_defect() > 0);
    if polish.reached(&found) || (dependent && found.max() <= tolerance.min(WARM_DEPENDENT)) {
        return Some(found);
    }
    scratch.recycle(found.solution);
    None
}
