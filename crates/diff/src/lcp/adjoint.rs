//! The backward solve of one problem, and the cotangents that follow from it row by row.

use nalgebra::Vector3;
use tangency_lcp::{
    ActiveSystem, CentralPoint, Law, Lcp, LcpSolution, Metric, NO_BODY, Reduced, Scratch,
};

use super::{
    LcpDiffError, LcpGradientReport, LcpVector, RowVector, check, check_finite, check_solution,
    switches,
};

/// The adjoint a = (a_v, a_y) of a problem's solution, in memory that the next problem uses again.
///
/// [`lcp_vjp`](super::lcp_vjp) spreads it out into an [`LcpVector`]; who has a use for every row at
/// once takes [`row`](Self::row) instead and needs none.
#[derive(Debug, Default)]
pub struct LcpAdjoint {
    scratch: Scratch,
    reduced: Reduced,
    /// Cotangents of the active impulses.
    y_bar: Vec<f64>,
    rows: Vec<RowAdjoint>,
    /// Memory for the search of weak rows.
    weights: Vec<f64>,
    rank_defect: u32,
    undetermined: bool,
}

/// Parts of a cotangent below this, relative to it, are rounding.
const DETERMINED: f64 = 1e-6;

/// What belongs to one row of the problem.
#[derive(Clone, Copy, Debug, Default)]
struct RowAdjoint {
    /// a_y, 0 where the row is not active.
    a_y: f64,
    /// μ̄ or h̄.
    bound: f64,
}

impl LcpAdjoint {
    /// Solves for the cotangents of velocities (per body) and of impulses (per row; none for `None`).
    ///
    /// # Errors
    /// As [`lcp_vjp`](super::lcp_vjp).
    pub fn solve(
        &mut self,
        problem: &Lcp,
        solution: &LcpSolution,
        velocity_bar: &[Vector3<f64>],
        impulse_bar: Option<&[f64]>,
    ) -> Result<(), LcpDiffError> {
        check_solution(problem, solution)?;
        check("velocity_bar", problem.mass.len(), velocity_bar.len())?;
        if let Some(bar) = impulse_bar {
            check("impulse_bar", problem.rows.len(), bar.len())?;
        }
        if let Some(central) = &solution.central {
            return self.solve_softened(central, problem, velocity_bar, impulse_bar);
        }
        if let Some(system) = &solution.system {
            return self.solve_in(system, problem, solution, velocity_bar, impulse_bar);
        }
        let system = ActiveSystem::new(problem, &Metric::new(problem), &solution.modes);
        self.solve_in(&system, problem, solution, velocity_bar, impulse_bar)
    }

    /// a_v per body, the cotangents of the momenta p.
    #[must_use]
    pub fn momentum(&self) -> &[Vector3<f64>] {
        &self.reduced.velocities
    }

    /// The cotangent −a_v ∘ v of a body's mass diagonal.
    #[must_use]
    pub fn mass(&self, solution: &LcpSolution, body: usize) -> Vector3<f64> {
        -self.reduced.velocities[body].component_mul(&solution.linearised().velocities[body])
    }

    /// The cotangents of one row, a_y being 0 where it is not active:
    ///
    /// ```text
    ///  b̄ᵢ = a_y,i      c̄ᵢ = −a_y,i λᵢ      J̄ᵢ = λᵢ a_v − a_y,i v
    /// ```
    #[must_use]
    #[inline]
    pub fn row(&self, problem: &Lcp, solution: &LcpSolution, row: usize) -> RowVector {
        let solution = solution.linearised();
        let (RowAdjoint { a_y, bound }, impulse) = (self.rows[row], solution.impulses[row]);
        let [a, b] = problem.rows[row].bodies;
        let jacobian =
            [self.block(solution, a, a_y, impulse), self.block(solution, b, a_y, impulse)];
        RowVector { jacobian, rhs: a_y, compliance: -a_y * impulse, bound }
    }

    #[inline]
    fn block(&self, solution: &LcpSolution, body: u32, a_y: f64, impulse: f64) -> Vector3<f64> {
        if body == NO_BODY {
            return Vector3::zeros();
        }
        let body = body as usize;
        self.reduced.velocities[body] * impulse - solution.velocities[body] * a_y
    }

    /// Whether nothing depends on a row: an open contact, say.
    #[must_use]
    pub fn is_idle(&self, solution: &LcpSolution, row: usize) -> bool {
        let RowAdjoint { a_y, bound } = self.rows[row];
        a_y == 0.0 && bound == 0.0 && solution.linearised().impulses[row] == 0.0
    }

    /// What the user of the derivative should know.
    #[must_use]
    pub fn report(&mut self, problem: &Lcp, solution: &LcpSolution) -> LcpGradientReport {
        let weak = match solution.central {
            Some(_) => Vec::new(),
            None => switches::weak_rows(problem, solution, &mut self.weights),
        };
        LcpGradientReport {
            weak,
            rank_defect: self.rank_defect,
            undetermined: self.undetermined,
            defect: self.reduced.defect,
        }
    }

    /// All cotangents.
    pub(super) fn spread(&self, problem: &Lcp, solution: &LcpSolution) -> LcpVector {
        LcpVector {
            mass: (0..problem.mass.len()).map(|body| self.mass(solution, body)).collect(),
            momentum: self.reduced.velocities.clone(),
            rows: (0..problem.rows.len()).map(|row| self.row(problem, solution, row)).collect(),
        }
    }

    fn solve_in(
        &mut self,
        system: &ActiveSystem,
        problem: &Lcp,
        solution: &LcpSolution,
        velocity_bar: &[Vector3<f64>],
        impulse_bar: Option<&[f64]>,
    ) -> Result<(), LcpDiffError> {
        let impulse_bar = |row: u32| impulse_bar.map_or(0.0, |bar| bar[row as usize]);
        self.solve_transpose(system, problem, velocity_bar, impulse_bar)?;
        let a_v = &self.reduced.velocities;
        let along = |row: u32| problem.row_velocity(row as usize, a_v) + impulse_bar(row);
        for fold in system.folds() {
            let normal = system.rows()[fold.column as usize] as usize;
            self.rows[fold.row as usize].bound =
                fold.coefficient.signum() * solution.impulses[normal] * along(fold.row);
        }
        for &(row, impulse) in system.saturated() {
            self.rows[row as usize].bound = impulse.signum() * along(row);
        }
        Ok(())
    }

    /// The same at a point of the central path: a bound h moves u by β.
    fn solve_softened(
        &mut self,
        central: &CentralPoint,
        problem: &Lcp,
        velocity_bar: &[Vector3<f64>],
        impulse_bar: Option<&[f64]>,
    ) -> Result<(), LcpDiffError> {
        let impulse_bar = |row: u32| impulse_bar.map_or(0.0, |bar| bar[row as usize]);
        self.solve_transpose(central.system(), central.soft(), velocity_bar, impulse_bar)?;
        for (row, it) in problem.rows.iter().enumerate() {
            let by_bound = self.rows[row].a_y * central.by_bound(row);
            self.rows[row].bound = match it.law {
                Law::Friction { normal, .. } => {
                    by_bound * central.solution.impulses[normal as usize]
                }
                Law::Bounded { .. } => by_bound,
                Law::Equality | Law::Unilateral => 0.0,
            };
        }
        Ok(())
    }

    /// a_v, and a_y row by row.
    fn solve_transpose(
        &mut self,
        system: &ActiveSystem,
        problem: &Lcp,
        velocity_bar: &[Vector3<f64>],
        impulse_bar: impl Fn(u32) -> f64,
    ) -> Result<(), LcpDiffError> {
        self.y_bar.clear();
        self.y_bar.extend(system.rows().iter().map(|row| impulse_bar(*row)));
        for fold in system.folds() {
            self.y_bar[fold.column as usize] += fold.coefficient * impulse_bar(fold.row);
        }
        let (y_bar, scratch, reduced) = (&mut self.y_bar, &mut self.scratch, &mut self.reduced);
        self.rank_defect = system.rank_defect();
        self.undetermined = false;
        if self.rank_defect > 0 && y_bar.iter().any(|bar| *bar != 0.0) {
            let dropped = system.determined(problem, y_bar, DETERMINED, scratch, reduced);
            self.undetermined = dropped;
        }
        system.solve_transpose_into(problem, velocity_bar, y_bar, scratch, reduced);
        check_finite(system, self.reduced.defect)?;
        self.rows.clear();
        self.rows.resize(problem.rows.len(), RowAdjoint::default());
        for (row, a_y) in system.rows().iter().zip(&self.reduced.impulses) {
            self.rows[*row as usize].a_y = *a_y;
        }
        Ok(())
    }
}
