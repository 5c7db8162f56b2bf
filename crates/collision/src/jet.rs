//! The derivative of a contact, beside its value.

use nalgebra::{Matrix2x6, RowVector2, RowVector6, SMatrix, Vector2, Vector4};
use serde::{Deserialize, Serialize};

use crate::{
    Contact, ContactFeature, Feature, Pose,
    pose::{Frame, perp},
};

/// A contact with its first derivatives, features held fixed.
///
/// Rows are (point.x, point.y, ψ, gap), where the normal is (cos ψ, sin ψ): its derivative is
/// dn = (−n.y, n.x) dψ.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactJet {
    /// The value.
    pub contact: Contact,
    /// 4 × 6, with respect to the poses (x, y, θ) of a and then of b, (m, m, rad).
    pub pose: SMatrix<f64, 4, 6>,
    /// 4 × 2, with respect to the radii of a and of b, m.
    pub radii: SMatrix<f64, 4, 2>,
}

impl ContactFeature {
    /// The contact at the poses of bodies a and b, and its derivatives there.
    ///
    /// Every world point moves as dx = dp + perp(x − p) dθ. With t = perp(n):
    ///
    /// ```text
    /// Points   dgap = n·dr − dr_a − dr_b              dψ = t·dr / d
    /// LineA    dgap = n·dw + t·w dψ − dr_a − dr_b     dψ = dθ_a      w = x_b − x_l
    /// LineB    the same                               dψ = dθ_b      w = x_l − x_a
    ///
    /// dpoint = dx_a + t (r_a + gap/2) dψ + n (dr_a + dgap/2)         Points, LineB
    ///          dx_b − t (r_b + gap/2) dψ − n (dr_b + dgap/2)         LineA
    /// ```
    ///
    /// The term t·w dψ is zero for `Points`, where w = r is along n, so one formula serves all.
    #[must_use]
    pub fn jet(&self, a: &Pose, b: &Pose) -> ContactJet {
        let (a, b) = (Frame::new(a), Frame::new(b));
        let contact = self.evaluate_in(&a, &b);
        let n = contact.normal;
        let t = perp(&n);
        // The two points whose difference w the gap measures.
        let (l_a, l_b) = match &self.feature {
            Feature::Points { a, b } => (a, b),
            Feature::LineA { point, b, .. } => (point, b),
            Feature::LineB { a, point, .. } => (a, point),
        };
        let (x_a, x_b) = (a.point(l_a), b.point(l_b));
        let (w, dx_a, dx_b) =
            (x_b - x_a, motion(0, &(x_a - a.origin())), motion(3, &(x_b - b.origin())));
        let dw = dx_b - dx_a;
        let dpsi = match &self.feature {
            Feature::Points { .. } => t.transpose() * dw / w.norm(),
            Feature::LineA { .. } => unit(2),
            Feature::LineB { .. } => unit(5),
        };
        let dgap = n.transpose() * dw + t.dot(&w) * dpsi;
        // The point rides on the side that has a point: s = +1 on a, −1 on b.
        let (s, dx, own) = match &self.feature {
            Feature::LineA { .. } => (-1.0, dx_b, 1),
            Feature::Points { .. } | Feature::LineB { .. } => (1.0, dx_a, 0),
        };
        let arm = self.radii[own] + contact.gap / 2.0;
        let dpoint = dx + s * (t * arm * dpsi + n * dgap / 2.0);
        ContactJet { contact, pose: stack(&dpoint, &dpsi, &dgap), radii: radii(&(n * s), own) }
    }
}

impl ContactFeature {
    /// The change of (point.x, point.y, ψ, gap) when the two points between which the gap is measured move
    /// by `moved` in the frames of a and b, m, and the line turns by `turned` in that of its body, rad. Of
    /// the formulas of [`jet`](Self::jet) with these dx and dψ.
    #[must_use]
    pub fn reshaped(
        &self,
        a: &Pose,
        b: &Pose,
        moved: &[Vector2<f64>; 2],
        turned: f64,
    ) -> Vector4<f64> {
        let (a, b) = (Frame::new(a), Frame::new(b));
        let contact = self.evaluate_in(&a, &b);
        let (n, t) = (contact.normal, perp(&contact.normal));
        let (l_a, l_b) = match &self.feature {
            Feature::Points { a, b } => (a, b),
            Feature::LineA { point, b, .. } => (point, b),
            Feature::LineB { a, point, .. } => (a, point),
        };
        let w = b.point(l_b) - a.point(l_a);
        let dx = [a.direction(&moved[0]), b.direction(&moved[1])];
        let dw = dx[1] - dx[0];
        let (s, own, dpsi) = match &self.feature {
            Feature::Points { .. } => (1.0, 0, t.dot(&dw) / w.norm()),
            Feature::LineA { .. } => (-1.0, 1, turned),
            Feature::LineB { .. } => (1.0, 0, turned),
        };
        let dgap = n.dot(&dw) + t.dot(&w) * dpsi;
        let arm = self.radii[own] + contact.gap / 2.0;
        let dpoint = dx[own] + s * (t * arm * dpsi + n * dgap / 2.0);
        Vector4::new(dpoint.x, dpoint.y, dpsi, dgap)
    }
}

/// dx over both poses, 2 × 6, of a point at `arm` from the origin of the body at column `first`.
fn motion(first: usize, arm: &Vector2<f64>) -> Matrix2x6<f64> {
    let mut dx = Matrix2x6::zeros();
    dx[(0, first)] = 1.0;
    dx[(1, first + 1)] = 1.0;
    dx.set_column(first + 2, &perp(arm));
    dx
}

fn unit(column: usize) -> RowVector6<f64> {
    let mut row = RowVector6::zeros();
    row[column] = 1.0;
    row
}

fn stack(
    dpoint: &Matrix2x6<f64>,
    dpsi: &RowVector6<f64>,
    dgap: &RowVector6<f64>,
) -> SMatrix<f64, 4, 6> {
    let mut all = SMatrix::<f64, 4, 6>::zeros();
    all.fixed_rows_mut::<2>(0).copy_from(dpoint);
    all.set_row(2, dpsi);
    all.set_row(3, dgap);
    all
}

/// Derivatives by the radii: dgap = −1 for both, and half the normal, out for the own one.
///
/// ```text
/// dpoint = ±n (dr_own + dgap/2),   dgap = −dr_a − dr_b
/// ```
fn radii(outward: &Vector2<f64>, own: usize) -> SMatrix<f64, 4, 2> {
    let mut all = SMatrix::<f64, 4, 2>::zeros();
    for side in 0..2 {
        let half = if side == own { 0.5 } else { -0.5 };
        all.fixed_view_mut::<2, 1>(0, side).copy_from(&(outward * half));
    }
    all.set_row(3, &RowVector2::new(-1.0, -1.0));
    all
}
