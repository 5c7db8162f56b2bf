//! Problems whose modes are known, as those along a motion are between its events: one linear system.

use crate::linear::solve_linear_in;
use crate::metric::quotient;
use crate::{Law, Lcp, LcpError, LcpSolution, Metric, Mode, Polish, Polished, Residual, Scratch};

/// Above this defect, rows are nearly dependent, and the dense system is tried.
const EXACT: f64 = 1e-12;

/// Solves `problem` on the pieces that `modes` (one per row) name: active rows leave nothing over, open
/// ones have no impulse, those on a bound have it. What else their laws say is not asked. Also gives what
/// the equations leave over, relative to the problem's scale; it is at most `tolerance`.
///
/// # Errors
/// [`LcpError::Infeasible`] if the equations contradict each other.
///
/// # Panics
/// If there is not one mode per row.
pub fn solve_in_modes(
    problem: &Lcp,
    modes: &[Mode],
    scratch: &mut Scratch,
    tolerance: f64,
) -> Result<(LcpSolution, f64), LcpError> {
    assert_eq!(modes.len(), problem.rows.len(), "a mode per row");
    let metric = scratch.metric(problem);
    let found = if problem.is_linear() {
        solve_linear_in(problem, &metric, scratch).map(|(solution, residual)| {
            let defect = residual.max();
            (solution, defect)
        })
    } else {
        Ok(of_pieces(problem, modes, &metric, scratch))
    };
    scratch.give_metric(metric);
    match found? {
        (solution, defect) if defect <= tolerance => Ok((solution, defect)),
        (_, residual) => Err(LcpError::Infeasible { residual }),
    }
}

fn of_pieces(
    problem: &Lcp,
    modes: &[Mode],
    metric: &Metric,
    scratch: &mut Scratch,
) -> (LcpSolution, f64) {
    let polish = Polish::new(problem, metric, 0.0, 0);
    let found = polish.evaluate(modes, None, scratch);
    let defect = defect(problem, metric, &found);
    if defect <= EXACT {
        return (found.solution, defect);
    }
    match polish.solved_stiff(&found, scratch) {
        Some(stiff) if self::defect(problem, metric, &stiff) < defect => {
            let defect = self::defect(problem, metric, &stiff);
            (stiff.solution, defect)
        }
        _ => (found.solution, defect),
    }
}

/// What momentum and active rows leave over, relative to all that drives the problem, motors included.
fn defect(problem: &Lcp, metric: &Metric, found: &Polished) -> f64 {
    let Polished { solution, residual: Residual { momentum, .. } } = found;
    let active = |row: &usize| {
        solution.modes[*row] == Mode::Active || problem.rows[*row].law == Law::Equality
    };
    let rows = (0..problem.rows.len()).filter(active);
    let left = rows.map(|row| metric.remainder(row, solution.slacks[row]).abs());
    let bound = |row: usize| match (problem.rows[row].law, solution.modes[row]) {
        (Law::Bounded { .. }, Mode::Upper | Mode::Lower) => {
            metric.impulse(row, solution.impulses[row].abs())
        }
        _ => 0.0,
    };
    let scale = (0..problem.rows.len()).map(bound).fold(metric.scale, f64::max);
    quotient(left.fold(0.0, f64::max), scale).max(*momentum)
}
