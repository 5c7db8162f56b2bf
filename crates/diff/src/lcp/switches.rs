//! Which rows are at a switch.
//!
//! ```text
//!  margin = |ŷ − û|/s*,  or  ||û| − (ĥ − |ŷ|)|/s*  with ŷ = λ √(W/μ), û = u/√(μ W), ĥ = h √(W/μ)
//!  margin ≤ m   ⇔   (W λ − u)² ≤ m² W σ,  or  (|u| − W (h − |λ|))² ≤ m² W σ
//!  σ = μ s*² = max( max_k p²_k/M_kk, max_i b²_i/Wᵢᵢ )
//! ```
//!
//! Rows are seldom at a switch: squares, which need no root and no memory, tell so beforehand.

#![expect(non_snake_case, reason = "matrices carry their names from the paper")]

use tangency_lcp::{Law, Lcp, LcpSolution, Mode, WeakRow};

use super::WEAK_MARGIN;

/// Wider than [`WEAK_MARGIN`] by more than rounding.
const NEAR: f64 = 1.001 * WEAK_MARGIN;

/// The rows within [`WEAK_MARGIN`] of a switch; `weights` is memory for Wᵢᵢ.
pub(super) fn weak_rows(
    problem: &Lcp,
    solution: &LcpSolution,
    weights: &mut Vec<f64>,
) -> Vec<WeakRow> {
    if problem.is_linear() {
        return Vec::new();
    }
    weights.clear();
    weights.extend((0..problem.rows.len()).map(|row| problem.row_weight(row)));
    let bound = NEAR * NEAR * scale_squared(problem, weights);
    let near = |(row, W): (usize, &f64)| {
        defect(problem, solution, row, *W).is_some_and(|defect| {
            let far = defect * defect > bound * W;
            !far
        })
    };
    if weights.iter().enumerate().any(near) {
        problem.weak_rows(solution, WEAK_MARGIN)
    } else {
        Vec::new()
    }
}

/// The bracket that is squared; `None` for rows without a switch.
fn defect(problem: &Lcp, solution: &LcpSolution, row: usize, W: f64) -> Option<f64> {
    let (impulse, slack) = (solution.impulses[row], solution.slacks[row]);
    let limit = match problem.rows[row].law {
        Law::Equality => return None,
        Law::Unilateral => return Some(W * impulse - slack),
        Law::Friction { normal, .. } if solution.modes[normal as usize] == Mode::Open => {
            return None;
        }
        Law::Friction { normal, mu } => mu * solution.impulses[normal as usize].max(0.0),
        Law::Bounded { max } => max,
    };
    Some(slack.abs() - W * (limit - impulse.abs()))
}

/// σ.
fn scale_squared(problem: &Lcp, weights: &[f64]) -> f64 {
    let of_body = problem.momentum.iter().zip(&problem.mass);
    let energies = of_body.map(|(p, m)| p.component_mul(p).component_div(m).max());
    let of_row = problem.rows.iter().zip(weights);
    let rates = of_row.map(|(row, W)| row.rhs * row.rhs / W);
    energies.chain(rates).fold(0.0, f64::max)
}
