//! What one row of an island is by the poses and velocities of its two bodies, once for all directions.
//!
//! ```text
//!  b = rhs(φ, s) − Σ_driven J·v,   s = J·v⁻,   H = ∂J/∂q
//!
//!  ∂b/∂q = (∂b/∂φ) ∂φ/∂q + (∂b/∂s) Hᵀ v⁻ − Hᵀ v_driven        ∂b/∂v = (∂b/∂s) J
//! ```

use nalgebra::{Matrix6, SMatrix, Vector2, Vector3, Vector6};
use tangency_collision::pose::perp;
use tangency_core::row::{RowContext, RowSource};

use super::joint_row_of;

/// The derivatives of a row by (q_a, q_b) and (v_a, v_b), 6 numbers each.
#[derive(Clone, Debug)]
pub(crate) struct Slope {
    /// H, 6 × 6.
    jacobian: Matrix6<f64>,
    /// ∂b/∂q.
    rhs_pose: Vector6<f64>,
    /// ∂b/∂v.
    rhs_velocity: Vector6<f64>,
}

impl Slope {
    /// Of a row at the context's poses.
    pub(crate) fn new(context: &RowContext<'_>, source: RowSource) -> Self {
        let geometry = context.geometry(source);
        let rhs = context.rhs(source, geometry.value, context.speed(&geometry));
        let (jacobian, value) = geometry_slope(context, source);
        let (mut v, mut driven) = (Vector6::zeros(), Vector6::zeros());
        for (side, body) in geometry.bodies.iter().enumerate() {
            let Some(body) = *body else { continue };
            v.fixed_rows_mut::<3>(3 * side).copy_from(&context.v[body]);
            if context.stage.is_velocity() && !context.scene.is_dynamic(body) {
                driven.fixed_rows_mut::<3>(3 * side).copy_from(&context.v[body]);
            }
        }
        let rhs_pose = value * rhs.d_position + jacobian.tr_mul(&(v * rhs.d_speed - driven));
        Self { jacobian, rhs_pose, rhs_velocity: stack(&geometry.jacobian) * rhs.d_speed }
    }

    /// Gradients by (q_a, q_b) and (v_a, v_b) from those by J and b.
    #[inline]
    pub(crate) fn pull(&self, jacobian: &[Vector3<f64>; 2], rhs: f64) -> [Vector6<f64>; 2] {
        let by_pose = self.jacobian.tr_mul(&stack(jacobian)) + self.rhs_pose * rhs;
        [by_pose, self.rhs_velocity * rhs]
    }
}

fn stack([a, b]: &[Vector3<f64>; 2]) -> Vector6<f64> {
    Vector6::new(a.x, a.y, a.z, b.x, b.y, b.z)
}

/// H and ∂φ/∂q of any row.
fn geometry_slope(context: &RowContext<'_>, source: RowSource) -> (Matrix6<f64>, Vector6<f64>) {
    match source {
        RowSource::Normal { contact } => {
            let normal = context.contacts[contact as usize].normal;
            let (hessian, jet) = contact_slope(context, contact, &normal);
            (hessian, jet.row(3).transpose())
        }
        RowSource::Tangent { contact } => {
            let tangent = perp(&context.contacts[contact as usize].normal);
            (contact_slope(context, contact, &tangent).0, Vector6::zeros())
        }
        _ => {
            let (joint, row, sign) = joint_row_of(context.scene, source);
            let poses = context.scene.joint_poses(joint as usize, context.q);
            let anchors = &context.scene.joints()[joint as usize].anchors;
            let jet = row.measure.jet([&poses[0], &poses[1]], [&anchors[0], &anchors[1]]);
            (jet.hessian * sign, jet.jacobian * sign)
        }
    }
}

/// H of the row of a contact along d, which turns with the normal, and the contact's own derivative.
///
/// ```text
///  J = [−d, −d·⊥ρ_a | d, d·⊥ρ_b]      dd = ⊥d dψ      dρ = dc − dp
/// ```
fn contact_slope(
    context: &RowContext<'_>,
    contact: u32,
    d: &Vector2<f64>,
) -> (Matrix6<f64>, SMatrix<f64, 4, 6>) {
    let bodies = context.contact_bodies(contact);
    let contact = &context.contacts[contact as usize];
    let jet = contact.feature.jet(&context.q[bodies[0]], &context.q[bodies[1]]).pose;
    let arms = bodies.map(|body| perp(&(contact.point - context.q[body].xy())));
    let mut hessian = Matrix6::zeros();
    for (k, mut column) in hessian.column_iter_mut().enumerate() {
        let (dc, dd) = (Vector2::new(jet[(0, k)], jet[(1, k)]), perp(d) * jet[(2, k)]);
        let turn = |side: usize| {
            let mut d_arm = dc;
            if let Some(axis) = k.checked_sub(3 * side).filter(|axis| *axis < 2) {
                d_arm[axis] -= 1.0;
            }
            dd.dot(&arms[side]) + d.dot(&perp(&d_arm))
        };
        column.copy_from(&Vector6::new(-dd.x, -dd.y, -turn(0), dd.x, dd.y, turn(1)));
    }
    (hessian, jet)
}
