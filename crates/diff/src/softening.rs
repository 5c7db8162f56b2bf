//! Derivatives of the compliance of rows that give way, κᵢ = [`softness`].
//!
//! ```text
//!  cᵢ = κᵢ Σ_k J²ᵢₖ/M_k         ∂c/∂Jₖ = 2 κᵢ Jₖ/M_k         ∂c/∂M_k = −κᵢ J²ₖ/M²_k
//! ```

use tangency_core::lcp::{Lcp, NO_BODY, Row};
use tangency_core::row::softness;

use crate::lcp::LcpVector;

/// Moves the gradient by c onto those by J and M.
pub(crate) fn vjp(problem: &Lcp, bar: &mut LcpVector) {
    for (row, row_bar) in problem.rows.iter().zip(&mut bar.rows) {
        let c_bar = share(row) * std::mem::take(&mut row_bar.compliance);
        for (side, (body, block)) in sides(row) {
            let per_mass = block.component_div(&problem.mass[body]);
            row_bar.jacobian[side] += 2.0 * c_bar * per_mass;
            bar.mass[body] -= c_bar * per_mass.component_mul(&per_mass);
        }
    }
}

/// Adds the change of c that those of J and M make.
pub(crate) fn jvp(problem: &Lcp, change: &mut LcpVector) {
    for (row, d_row) in problem.rows.iter().zip(&mut change.rows) {
        for (side, (body, block)) in sides(row) {
            let per_mass = block.component_div(&problem.mass[body]);
            let by_mass = per_mass.component_mul(&per_mass).dot(&change.mass[body]);
            d_row.compliance += share(row) * (2.0 * per_mass.dot(&d_row.jacobian[side]) - by_mass);
        }
    }
}

/// κ of a row; 0 where it does not give way.
fn share(row: &Row) -> f64 {
    if row.compliance > 0.0 { softness(row.law) } else { 0.0 }
}

/// The sides of a row that have a body, with the body and the block.
fn sides(row: &Row) -> impl Iterator<Item = (usize, (usize, &nalgebra::Vector3<f64>))> {
    let with_body = |side: usize| {
        let body = row.bodies[side];
        (body != NO_BODY).then_some((side, (body as usize, &row.jacobian[side])))
    };
    (0..2).filter_map(with_body)
}
