//! Derivatives of the compliance that rows of a stage give way by, with κᵢ their softness.
//!
//! ```text
//!  cᵢ += κᵢ Σ_k J²ᵢₖ/M_k         ∂c/∂Jₖ = 2 κᵢ Jₖ/M_k         ∂c/∂M_k = −κᵢ J²ₖ/M²_k
//! ```

use nalgebra::Vector3;
use tangency_core::IslandRecord;
use tangency_core::lcp::{NO_BODY, Row};
use tangency_core::row::RowContext;

use crate::lcp::{LcpVector, RowVector};
use crate::vector::SceneVector;

/// Adds what the gradient by a row's c is by its J and by M.
pub(crate) fn vjp(
    context: &RowContext<'_>,
    island: &IslandRecord,
    row: usize,
    bar: &mut RowVector,
    scene: &mut SceneVector,
) {
    let problem = &island.problem;
    let c_bar = context.softness(island.sources[row]) * bar.compliance;
    for (side, body, block) in sides(&problem.rows[row]) {
        let per_mass = block.component_div(&problem.mass[body]);
        bar.jacobian[side] += 2.0 * c_bar * per_mass;
        let by_mass = c_bar * per_mass.component_mul(&per_mass);
        scene.bodies[island.bodies[body] as usize].mass -= by_mass;
    }
}

/// Adds the change of c that those of J and M make.
pub(crate) fn jvp(context: &RowContext<'_>, island: &IslandRecord, change: &mut LcpVector) {
    let problem = &island.problem;
    for ((source, row), d_row) in island.sources.iter().zip(&problem.rows).zip(&mut change.rows) {
        for (side, body, block) in sides(row) {
            let per_mass = block.component_div(&problem.mass[body]);
            let by_mass = per_mass.component_mul(&per_mass).dot(&change.mass[body]);
            let by_block = 2.0 * per_mass.dot(&d_row.jacobian[side]);
            d_row.compliance += context.softness(*source) * (by_block - by_mass);
        }
    }
}

/// The sides of a row that have a body: side, body, block.
fn sides(row: &Row) -> impl Iterator<Item = (usize, usize, &Vector3<f64>)> {
    let with_body = |side: usize| {
        let body = row.bodies[side];
        (body != NO_BODY).then_some((side, body as usize, &row.jacobian[side]))
    };
    (0..2).filter_map(with_body)
}
