//! Points of the central path: known ones, and what all of them obey.

use tangency_lcp::{CentralPoint, Law, Lcp, LcpError, LcpSolution, Metric, Polish, Scratch};

use crate::problems::{body, chain, disc, near, row, solve, stack, supported};

/// The point near the solution, without its modes.
fn central(problem: &Lcp, near: &LcpSolution, energy: f64) -> Result<CentralPoint, LcpError> {
    CentralPoint::new(problem, near, energy, &mut Scratch::default())
}

/// V35 (d): 0 ≤ z ⟂ z + q ≥ 0 becomes z (z + q) = τ, z = (√(q² + 4τ) − q)/2.
#[test]
fn one_row_has_a_closed_form() {
    for q in [-3.0, -0.2, 0.0, 0.2, 3.0] {
        for tau in [1e-8_f64, 1e-4, 0.3] {
            let problem =
                body([1.0; 3], [q, 0.0, 0.0], vec![row([1.0, 0.0, 0.0], 0.0, Law::Unilateral)]);
            let found = central(&problem, &solve(&problem), tau).expect("a point").solution;
            let root = (q * q + 4.0 * tau).sqrt();
            near(&found.impulses, &[(root - q) / 2.0], 1e-14);
            near(&found.slacks, &[(root + q) / 2.0], 1e-14);
        }
    }
}
