//! Problems without inequalities: one linear solve.

use std::sync::Arc;

use crate::banded::solve_banded;
use crate::{
    ActiveSystem, Law, Lcp, LcpError, LcpSolution, Metric, Mode, Reduced, Residual, Scratch,
    SolveStats,
};

/// Above this residual, relative to s*, redundant equations contradict each other.
const CONSISTENT: f64 = 1e-9;
/// Above this one, rows are nearly dependent, and the dense system is tried.
const EXACT: f64 = 1e-12;

impl Lcp {
    /// Whether every row is an equality, so that [`solve_linear`] applies.
    #[must_use]
    pub fn is_linear(&self) -> bool {
        self.rows.iter().all(|row| row.law == Law::Equality)
    }
}

/// Solves a problem that has equality rows only, or none (closed form v = M⁻¹ p).
///
/// # Errors
/// [`LcpError::Infeasible`] if dependent equations contradict each other, and a refusal of wrong
/// sizes and numbers that are not finite.
///
/// # Panics
/// If a row is not an equality.
pub fn solve_linear(problem: &Lcp) -> Result<LcpSolution, LcpError> {
    assert!(problem.is_linear(), "solve_linear takes equality rows only");
    let mut scratch = Scratch::default();
    Ok(solve_linear_in(problem, &Metric::checked(problem)?, &mut scratch)?.0)
}

/// The same for a problem that is valid and linear, with its metric.
pub(crate) fn solve_linear_in(
    problem: &Lcp,
    metric: &Metric,
    scratch: &mut Scratch,
) -> Result<(LcpSolution, Residual), LcpError> {
    debug_assert!(problem.is_linear());
    if problem.rows.is_empty() {
        let velocities = problem.free_velocities();
        return Ok((LcpSolution { velocities, ..LcpSolution::default() }, Residual::default()));
    }
    if let Some(answer) = solve_banded(problem, metric, scratch) {
        return Ok(answer);
    }
    let modes = scratch.modes.filled(problem.rows.len(), Mode::Active);
    let mut system = scratch.system();
    if let Some(system) = Arc::get_mut(&mut system) {
        system.renew(problem, metric, &modes, scratch);
    }
    let (velocities, impulses) = (scratch.vectors.take(), scratch.floats.take());
    let mut reduced = Reduced { velocities, impulses, defect: 0.0 };
    system.solve_gathered(problem, None, scratch, &mut reduced);
    let (solution, residual) = assemble(problem, metric, &system, reduced, modes, scratch);
    if residual.max() <= EXACT {
        return Ok((solution, residual));
    }
    let Some(stiff) = system.solve_stiff(problem) else {
        return accepted(solution, residual);
    };
    let modes = solution.modes.clone();
    let (stiff, again) = assemble(problem, metric, &system, stiff, modes, scratch);
    if again.max() < residual.max() { accepted(stiff, again) } else { accepted(solution, residual) }
}

fn accepted(
    solution: LcpSolution,
    residual: Residual,
) -> Result<(LcpSolution, Residual), LcpError> {
    let greatest = residual.max();
    if greatest <= CONSISTENT {
        Ok((solution, residual))
    } else {
        Err(LcpError::Infeasible { residual: greatest })
    }
}

fn assemble(
    problem: &Lcp,
    metric: &Metric,
    system: &Arc<ActiveSystem>,
    reduced: Reduced,
    modes: Vec<Mode>,
    scratch: &mut Scratch,
) -> (LcpSolution, Residual) {
    let mut impulses = scratch.floats.take();
    system.spread_into(problem, &reduced.impulses, &mut impulses);
    scratch.floats.give(reduced.impulses);
    let mut slacks = scratch.floats.take();
    let residual = problem.assess(metric, &reduced.velocities, &impulses, &mut slacks, scratch);
    let solution = LcpSolution {
        velocities: reduced.velocities,
        impulses,
        slacks,
        modes,
        stats: SolveStats { factorisations: 1, ..SolveStats::default() },
        system: Some(Arc::clone(system)),
        central: None,
    };
    (solution, residual)
}
