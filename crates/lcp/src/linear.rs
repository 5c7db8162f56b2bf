//! Problems without inequalities: one linear solve.

use std::sync::Arc;

use crate::{ActiveSystem, Law, Lcp, LcpError, LcpSolution, Metric, Mode, SolveStats};

/// Above this residual, relative to s*, redundant equations contradict each other.
const CONSISTENT: f64 = 1e-9;

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
/// [`LcpError::Infeasible`] if dependent equations contradict each other.
///
/// # Panics
/// If a row is not an equality.
pub fn solve_linear(problem: &Lcp) -> Result<LcpSolution, LcpError> {
    assert!(problem.is_linear(), "solve_linear takes equality rows only");
    if problem.rows.is_empty() {
        return Ok(LcpSolution { velocities: problem.free_velocities(), ..LcpSolution::default() });
    }
    let metric = Metric::new(problem);
    let modes = vec![Mode::Active; problem.rows.len()];
    let system = ActiveSystem::new(problem, &metric, &modes);
    let reduced = system.solve(problem, None);
    let impulses = system.spread(problem, &reduced.impulses);
    let slacks = problem.remainders(&reduced.velocities, &impulses);
    let solution = LcpSolution {
        velocities: reduced.velocities,
        impulses,
        slacks,
        modes,
        stats: SolveStats { iterations: 0, factorisations: 1 },
        system: Some(Arc::new(system)),
    };
    let residual = problem.residual_in(&metric, &solution).max();
    if residual <= CONSISTENT { Ok(solution) } else { Err(LcpError::Infeasible { residual }) }
}
