//! Problems without inequalities: one linear solve.

use std::sync::Arc;

use crate::{ActiveSystem, Law, Lcp, LcpError, LcpSolution, Metric, Mode, Reduced, SolveStats};

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
    problem.validate()?;
    if problem.rows.is_empty() {
        return Ok(LcpSolution { velocities: problem.free_velocities(), ..LcpSolution::default() });
    }
    let metric = Metric::new(problem);
    let modes = vec![Mode::Active; problem.rows.len()];
    let system = ActiveSystem::new(problem, &metric, &modes);
    let system = Arc::new(system);
    let solution = assemble(problem, &system, &system.solve(problem, None));
    let residual = problem.residual_in(&metric, &solution).max();
    if residual <= EXACT {
        return Ok(solution);
    }
    let Some(stiff) = system.solve_stiff(problem) else {
        return accepted(solution, residual);
    };
    let stiff = assemble(problem, &system, &stiff);
    let again = problem.residual_in(&metric, &stiff).max();
    if again < residual { accepted(stiff, again) } else { accepted(solution, residual) }
}

fn accepted(solution: LcpSolution, residual: f64) -> Result<LcpSolution, LcpError> {
    if residual <= CONSISTENT { Ok(solution) } else { Err(LcpError::Infeasible { residual }) }
}

fn assemble(problem: &Lcp, system: &Arc<ActiveSystem>, reduced: &Reduced) -> LcpSolution {
    let impulses = system.spread(problem, &reduced.impulses);
    LcpSolution {
        slacks: problem.remainders(&reduced.velocities, &impulses),
        velocities: reduced.velocities.clone(),
        impulses,
        modes: vec![Mode::Active; problem.rows.len()],
        stats: SolveStats { factorisations: 1, ..SolveStats::default() },
        system: Some(Arc::clone(system)),
    }
}
