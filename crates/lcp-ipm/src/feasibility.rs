//! Telling problems that nothing can satisfy from problems that are hard.
//!
//! Both tests soften every constraint by ε and look at what remains violated. A feasible problem's
//! violation falls in proportion to ε; an infeasible one's stays. The softened problems are
//! monotone, so that the interior point does not fail on them. Rows that depend on each other up to a
//! singular value of 3·10⁻⁶ and ask for different things count as contradicting each other.

#![expect(non_snake_case, reason = "matrices carry their names from the literature")]

use nalgebra::{DMatrix, DVector};
use tangency_lcp::{Law, Lcp, LcpSolver, Metric, RawLcp, Scratch};

use crate::InteriorPoint;
use crate::raw::solve_raw;

const SOFT: f64 = 1e-5;
const HARD: f64 = 1e-9;
/// A violation that falls by less than this factor from `SOFT` to `HARD` does not vanish.
const STAYS: f64 = 0.99;
const LEAST: f64 = 1e-4;

/// The violation of conflicting rows, free of units; `None` if the rows do not conflict, or if that
/// could not be found out.
pub(crate) fn conflict(problem: &Lcp, settings: &InteriorPoint) -> Option<f64> {
    let soft = violation(problem, settings, SOFT)?;
    let hard = violation(problem, settings, HARD)?;
    (hard > LEAST && hard > STAYS * soft).then_some(hard)
}

/// Greatest violation of the equality and unilateral rows, without friction and motors, when each
/// gives way by ε Wᵢᵢ per impulse.
fn violation(problem: &Lcp, settings: &InteriorPoint, softness: f64) -> Option<f64> {
    let mut softened = problem.clone();
    softened.soften(|_| softness);
    softened.rows.retain(|row| matches!(row.law, Law::Equality | Law::Unilateral));
    // Impulses grow like 1/ε, and rounding with them.
    let settings =
        InteriorPoint { tolerance: 1e-9, acceptance: 1e-6, tell_infeasible: false, ..*settings };
    let solution = settings.solve(&softened, None, &mut Scratch::default()).ok()?;
    let metric = Metric::new(&softened);
    let violation = solution
        .impulses
        .iter()
        .enumerate()
        .fold(0.0_f64, |worst, (row, y)| worst.max(softness * metric.impulse(row, *y).abs()));
    Some(violation / metric.scale)
}

/// The least violation of M z + q ≥ 0, z ≥ 0 in the norm of the raw residual; `None` if it is zero
/// to rounding or could not be found out.
///
/// ```text
///  min ½ |M z + q − w|²   over   z_P ≥ 0,  w_P ≥ 0,  w_F = 0
/// ```
pub(crate) fn least_violation(problem: &RawLcp, settings: &InteriorPoint) -> Option<f64> {
    let (n, free) = (problem.q.len(), problem.free);
    if free == n || n > 400 {
        return None;
    }
    let M = &problem.matrix;
    let paired = n - free;
    let mut normal = DMatrix::zeros(n + paired, n + paired);
    normal.view_mut((0, 0), (n, n)).copy_from(&M.tr_mul(M));
    let lower = M.rows(free, paired);
    normal.view_mut((0, n), (n, paired)).copy_from(&-lower.transpose());
    normal.view_mut((n, 0), (paired, n)).copy_from(&-lower);
    normal.view_mut((n, n), (paired, paired)).fill_with_identity();
    let mut q = DVector::zeros(n + paired);
    q.rows_mut(0, n).copy_from(&M.tr_mul(&problem.q));
    q.rows_mut(n, paired).copy_from(&-problem.q.rows(free, paired));
    let fit = RawLcp { free, matrix: normal, q };
    let solution = solve_raw(&fit, &InteriorPoint { tell_infeasible: false, ..*settings }).ok()?;
    let mut defect = M * solution.z.rows(0, n) + &problem.q;
    let mut below = defect.rows_mut(free, paired);
    below -= solution.z.rows(n, paired);
    let violation = defect.amax() / (1.0 + problem.q.amax());
    (violation > 1e-6).then_some(violation)
}
