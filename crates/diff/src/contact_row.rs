//! Derivatives of the rows of contacts.
//!
//! ```text
//!  d = n or t,  ρ = c − p,  J = [−d, −d·⊥ρ_a | d, d·⊥ρ_b],  ∂d/∂ψ = ⊥d
//!  d̄ = −J̄_a + J̄_b − J̄_aθ ⊥ρ_a + J̄_bθ ⊥ρ_b       ψ̄ = d̄·⊥d
//!  ρ̄_a = J̄_aθ ⊥d     ρ̄_b = −J̄_bθ ⊥d              c̄ = ρ̄_a + ρ̄_b     p̄ = −ρ̄
//! ```
//!
//! Point c, angle ψ of the normal, and gap then go through the contact's own derivative.

use nalgebra::{Vector2, Vector3, Vector4, Vector6};
use tangency_collision::{Contact, pose};
use tangency_core::row::RowContext;

use crate::vector::{Bars, Direction};

/// ∂L/∂(c_x, c_y, ψ, gap) of every contact, collected over its rows.
pub(crate) struct ContactBars(Vec<Vector4<f64>>);

impl ContactBars {
    pub(crate) fn new(contacts: usize) -> Self {
        Self(vec![Vector4::zeros(); contacts])
    }

    /// Pulls ∂L/∂J (6) of one row onto the contact and the bodies' positions.
    pub(crate) fn add_row(
        &mut self,
        context: &RowContext<'_>,
        contact: u32,
        d: &Vector2<f64>,
        j_bar: &Vector6<f64>,
        bars: &mut Bars<'_>,
    ) {
        let [a, b] = context.contact_bodies(contact);
        let point = context.contacts[contact as usize].point;
        let (rho_a, rho_b) = (point - context.q[a].xy(), point - context.q[b].xy());
        let turned = pose::perp(d);
        let d_bar = Vector2::new(j_bar[3] - j_bar[0], j_bar[4] - j_bar[1])
            - j_bar[2] * pose::perp(&rho_a)
            + j_bar[5] * pose::perp(&rho_b);
        let (rho_a_bar, rho_b_bar) = (turned * j_bar[2], -turned * j_bar[5]);
        let c_bar = rho_a_bar + rho_b_bar;
        self.0[contact as usize] += Vector4::new(c_bar.x, c_bar.y, d_bar.dot(&turned), 0.0);
        bars.state.q[a] -= Vector3::new(rho_a_bar.x, rho_a_bar.y, 0.0);
        bars.state.q[b] -= Vector3::new(rho_b_bar.x, rho_b_bar.y, 0.0);
    }

    pub(crate) fn add_gap(&mut self, contact: u32, gap_bar: f64) {
        self.0[contact as usize].w += gap_bar;
    }

    /// Pulls what was collected onto poses and radii.
    pub(crate) fn pull_back(self, context: &RowContext<'_>, bars: &mut Bars<'_>) {
        for (contact, bar) in context.contacts.iter().zip(self.0) {
            if bar == Vector4::zeros() {
                continue;
            }
            let [a, b] = contact.feature.id.bodies.map(|i| i as usize);
            let jet = contact.feature.jet(&context.q[a], &context.q[b]);
            let q_bar = jet.pose.tr_mul(&bar);
            let radii_bar = jet.radii.tr_mul(&bar);
            for (side, body) in [a, b].into_iter().enumerate() {
                bars.state.q[body] += q_bar.fixed_rows::<3>(3 * side);
                let shape = contact.feature.id.shapes[side] as usize;
                if contact.feature.radii[side] > 0.0 {
                    bars.scene.bodies[body].radii[shape] += radii_bar[side];
                }
            }
        }
    }
}

/// The change of (c_x, c_y, ψ, gap) of one contact along a direction.
pub(crate) fn contact_jvp(
    context: &RowContext<'_>,
    contact: &Contact,
    along: &Direction<'_>,
) -> Vector4<f64> {
    let bodies = contact.feature.id.bodies.map(|i| i as usize);
    let jet = contact.feature.jet(&context.q[bodies[0]], &context.q[bodies[1]]);
    let mut change = Vector4::zeros();
    for (side, body) in bodies.into_iter().enumerate() {
        change += jet.pose.fixed_columns::<3>(3 * side) * along.state.q[body];
        if contact.feature.radii[side] > 0.0 {
            let shape = contact.feature.id.shapes[side] as usize;
            change += jet.radii.column(side) * along.scene.bodies[body].radii[shape];
        }
    }
    change
}

/// The change of J (6) of one row, given that of its contact.
pub(crate) fn row_jvp(
    context: &RowContext<'_>,
    contact: u32,
    d: &Vector2<f64>,
    change: &Vector4<f64>,
    along: &Direction<'_>,
) -> Vector6<f64> {
    let bodies = context.contact_bodies(contact);
    let point = context.contacts[contact as usize].point;
    let dd = pose::perp(d) * change.z;
    let turn = |body: usize| {
        let rho = point - context.q[body].xy();
        let d_rho = change.xy() - along.state.q[body].xy();
        dd.dot(&pose::perp(&rho)) + d.dot(&pose::perp(&d_rho))
    };
    Vector6::new(-dd.x, -dd.y, -turn(bodies[0]), dd.x, dd.y, turn(bodies[1]))
}
