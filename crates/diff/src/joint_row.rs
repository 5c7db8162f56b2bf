//! Derivatives of the rows of joints: Jacobian and value by poses, anchors and reference.

use nalgebra::{Vector2, Vector4, Vector6};
use tangency_core::JointRow;
use tangency_core::measure::MeasureJet;
use tangency_core::row::RowContext;

use crate::vector::{Bars, Direction};

/// Pulls ∂L/∂J (6) and ∂L/∂φ back onto poses, anchors and reference.
pub(crate) fn geometry_vjp(
    context: &RowContext<'_>,
    joint: u32,
    row: JointRow,
    j_bar: &Vector6<f64>,
    value_bar: f64,
    bars: &mut Bars<'_>,
) {
    let jet = jet(context, joint, row);
    let q_bar = jet.hessian * j_bar + jet.jacobian * value_bar;
    let anchors_bar = jet.jacobian_anchors.tr_mul(j_bar) + jet.anchors * value_bar;
    for (side, body) in context.scene.joints()[joint as usize].bodies.iter().enumerate() {
        if let Some(body) = body {
            bars.state.q[*body] += q_bar.fixed_rows::<3>(3 * side);
        }
        bars.scene.joints[joint as usize].anchors[side] += anchors_bar.fixed_rows::<2>(2 * side);
    }
}

/// The change of J (6) and φ along a direction.
pub(crate) fn geometry_jvp(
    context: &RowContext<'_>,
    joint: u32,
    row: JointRow,
    along: &Direction<'_>,
) -> (Vector6<f64>, f64) {
    let jet = jet(context, joint, row);
    let mut dq = Vector6::zeros();
    for (side, body) in context.scene.joints()[joint as usize].bodies.iter().enumerate() {
        if let Some(body) = body {
            dq.fixed_rows_mut::<3>(3 * side).copy_from(&along.state.q[*body]);
        }
    }
    let [a, b]: [Vector2<f64>; 2] = along.scene.joints[joint as usize].anchors;
    let dl = Vector4::new(a.x, a.y, b.x, b.y);
    let dj = jet.hessian * dq + jet.jacobian_anchors * dl;
    (dj, jet.jacobian.dot(&dq) + jet.anchors.dot(&dl))
}

fn jet(context: &RowContext<'_>, joint: u32, row: JointRow) -> MeasureJet {
    let poses = context.scene.joint_poses(joint as usize, context.q);
    let anchors = &context.scene.joints()[joint as usize].anchors;
    row.measure.jet([&poses[0], &poses[1]], [&anchors[0], &anchors[1]])
}
