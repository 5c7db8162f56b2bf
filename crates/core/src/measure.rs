//! Scalars of two poses that joints hold at a value: a coordinate of the offset between two
//! anchors, their distance, the relative angle.
//!
//! ```text
//!  ρ_a = R(θ_a) l_a     x_a = p_a + ρ_a     r = x_b − x_a     ⊥(x, y) = (−y, x)
//!
//!  World  φ = u · r, u fixed in the world
//!  OnA    φ = u · r, u = R(θ_a) û
//!  Length φ = |r|
//!  Angle  φ = θ_b − θ_a
//!
//!  D = ∂r/∂(q_a, q_b) = [−1, −⊥ρ_a | 1, ⊥ρ_b]          ∂²r/∂θ_a² = ρ_a,  ∂²r/∂θ_b² = −ρ_b
//! ```
//!
//! With `u` as above (for Length `u = r/|r|`), every one of the first three has the gradient
//! `J = Dᵀu` and the same Hessian, but for what the turning of `u` adds:
//!
//! ```text
//!  OnA     J += e₂ (⊥u·r)         H += e₂ (Dᵀ⊥u)ᵀ + (Dᵀ⊥u) e₂ᵀ − e₂e₂ᵀ (u·r)
//!  Length                         H += (Dᵀ⊥u)(Dᵀ⊥u)ᵀ / |r|
//! ```

use nalgebra::{Matrix6, SMatrix, Vector2, Vector3, Vector4, Vector6};
use tangency_collision::{Frame, Pose, pose};

/// Which scalar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// Offset of the anchors along a direction of the world.
    World {
        /// Unit vector.
        axis: Vector2<f64>,
    },
    /// Offset of the anchors along a direction fixed in a.
    OnA {
        /// Unit vector in a's frame.
        axis_local: Vector2<f64>,
    },
    /// Distance of the anchors.
    Length,
    /// Angle of b less that of a.
    Angle,
}

/// Value and gradient of a [`Measure`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasureValue {
    /// φ, m or rad.
    pub value: f64,
    /// ∂φ/∂q for bodies a and b, 1 × 3 each.
    pub jacobian: [Vector3<f64>; 2],
}

/// First and second derivatives of a [`Measure`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasureJet {
    /// φ, m or rad.
    pub value: f64,
    /// J = ∂φ/∂(q_a, q_b).
    pub jacobian: Vector6<f64>,
    /// ∂J/∂(q_a, q_b), 6 × 6, symmetric.
    pub hessian: Matrix6<f64>,
    /// ∂φ/∂(l_a, l_b) with the anchors in their bodies' frames.
    pub anchors: Vector4<f64>,
    /// ∂J/∂(l_a, l_b), 6 × 4.
    pub jacobian_anchors: SMatrix<f64, 6, 4>,
}

impl Measure {
    /// Value and gradient at two poses, for anchors in their bodies' frames.
    #[must_use]
    pub fn evaluate(&self, poses: [&Pose; 2], anchors: [&Vector2<f64>; 2]) -> MeasureValue {
        let frames = poses.map(Frame::new);
        self.evaluate_in([&frames[0], &frames[1]], anchors)
    }

    /// The same where sines and cosines are at hand.
    #[must_use]
    pub fn evaluate_in(&self, frames: [&Frame; 2], anchors: [&Vector2<f64>; 2]) -> MeasureValue {
        self.evaluate_on(&Arms::new(frames, anchors), frames)
    }

    /// The same where the offset of the anchors is at hand.
    #[inline]
    pub(crate) fn evaluate_on(&self, arm: &Arms, frames: [&Frame; 2]) -> MeasureValue {
        if *self == Self::Angle {
            let jacobian = [-Vector3::z(), Vector3::z()];
            return MeasureValue { value: frames[1].pose().z - frames[0].pose().z, jacobian };
        }
        let (u, value) = self.direction(arm, frames[0]);
        let turning = if self.turns_with_a() { pose::perp(&u).dot(&arm.r) } else { 0.0 };
        let a = Vector3::new(-u.x, -u.y, -u.dot(&pose::perp(&arm.rho[0])) + turning);
        let b = Vector3::new(u.x, u.y, u.dot(&pose::perp(&arm.rho[1])));
        MeasureValue { value, jacobian: [a, b] }
    }

    /// Value with first and second derivatives.
    #[must_use]
    pub fn jet(&self, poses: [&Pose; 2], anchors: [&Vector2<f64>; 2]) -> MeasureJet {
        let MeasureValue { value, jacobian: [ja, jb] } = self.evaluate(poses, anchors);
        let mut jet = MeasureJet {
            value,
            jacobian: Vector6::new(ja.x, ja.y, ja.z, jb.x, jb.y, jb.z),
            hessian: Matrix6::zeros(),
            anchors: Vector4::zeros(),
            jacobian_anchors: SMatrix::zeros(),
        };
        if *self != Self::Angle {
            let frames = poses.map(Frame::new);
            let arm = Arms::new([&frames[0], &frames[1]], anchors);
            let (u, _) = self.direction(&arm, &frames[0]);
            arm.add_fixed_direction(&u, &mut jet);
            self.add_turning_direction(&arm, &u, &mut jet);
        }
        jet
    }

    fn turns_with_a(&self) -> bool {
        matches!(self, Self::OnA { .. })
    }

    /// u and φ.
    #[inline]
    fn direction(&self, arm: &Arms, frame_a: &Frame) -> (Vector2<f64>, f64) {
        let u = match self {
            Self::World { axis } => *axis,
            Self::OnA { axis_local } => frame_a.direction(axis_local),
            Self::Length | Self::Angle => {
                let length = arm.r.norm();
                return (arm.r / length, length);
            }
        };
        (u, u.dot(&arm.r))
    }

    fn add_turning_direction(&self, arm: &Arms, u: &Vector2<f64>, jet: &mut MeasureJet) {
        let t = pose::perp(u);
        let dt = arm.gradient(&t); // Dᵀ⊥u
        let dl = arm.anchor_gradient(&t); // (∂r/∂l)ᵀ⊥u
        match self {
            Self::OnA { .. } => {
                for k in 0..6 {
                    jet.hessian[(2, k)] += dt[k];
                    jet.hessian[(k, 2)] += dt[k];
                }
                jet.hessian[(2, 2)] -= u.dot(&arm.r);
                for k in 0..4 {
                    jet.jacobian_anchors[(2, k)] += dl[k];
                }
            }
            Self::Length => {
                let length = arm.r.norm();
                jet.hessian += dt * dt.transpose() / length;
                jet.jacobian_anchors += dt * dl.transpose() / length;
            }
            Self::World { .. } | Self::Angle => {}
        }
    }
}

/// The offset of two anchors and what it is made of.
pub(crate) struct Arms {
    rotation: [[Vector2<f64>; 2]; 2],
    rho: [Vector2<f64>; 2],
    r: Vector2<f64>,
}

impl Arms {
    #[inline]
    pub(crate) fn new(frames: [&Frame; 2], anchors: [&Vector2<f64>; 2]) -> Self {
        let rotation = frames.map(|frame| {
            let e = Vector2::new(frame.cos(), frame.sin());
            [e, pose::perp(&e)]
        });
        let rho = [0, 1].map(|i| frames[i].direction(anchors[i]));
        let r = frames[1].origin() + rho[1] - frames[0].origin() - rho[0];
        Self { rotation, rho, r }
    }

    /// Dᵀu.
    fn gradient(&self, u: &Vector2<f64>) -> Vector6<f64> {
        let [a, b] = [0, 1].map(|i| u.dot(&pose::perp(&self.rho[i])));
        Vector6::new(-u.x, -u.y, -a, u.x, u.y, b)
    }

    /// (∂r/∂(l_a, l_b))ᵀ u with ∂r/∂l_a = −R_a, ∂r/∂l_b = R_b.
    fn anchor_gradient(&self, u: &Vector2<f64>) -> Vector4<f64> {
        let [a, b] = &self.rotation;
        Vector4::new(-u.dot(&a[0]), -u.dot(&a[1]), u.dot(&b[0]), u.dot(&b[1]))
    }

    /// The derivatives that a direction fixed in the world has.
    fn add_fixed_direction(&self, u: &Vector2<f64>, jet: &mut MeasureJet) {
        jet.hessian[(2, 2)] += u.dot(&self.rho[0]);
        jet.hessian[(5, 5)] -= u.dot(&self.rho[1]);
        jet.anchors += self.anchor_gradient(u);
        for k in 0..2 {
            jet.jacobian_anchors[(2, k)] -= u.dot(&pose::perp(&self.rotation[0][k]));
            jet.jacobian_anchors[(5, 2 + k)] += u.dot(&pose::perp(&self.rotation[1][k]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn check(measure: Measure) {
        let q = Vector6::new(0.3, -0.2, 0.7, 1.4, 0.9, -0.4);
        let l = Vector4::new(0.2, 0.5, -0.3, 0.1);
        let at = |q: &Vector6<f64>, l: &Vector4<f64>| {
            let (a, b) = (Pose::new(q[0], q[1], q[2]), Pose::new(q[3], q[4], q[5]));
            measure.jet([&a, &b], [&Vector2::new(l[0], l[1]), &Vector2::new(l[2], l[3])])
        };
        let (jet, h) = (at(&q, &l), 1e-6);
        for k in 0..6 {
            let d = Vector6::ith(k, h);
            let (p, m) = (at(&(q + d), &l), at(&(q - d), &l));
            assert_relative_eq!(jet.jacobian[k], (p.value - m.value) / (2.0 * h), epsilon = 1e-8);
            let dj = (p.jacobian - m.jacobian) / (2.0 * h);
            assert_relative_eq!(jet.hessian.column(k).into_owned(), dj, epsilon = 1e-8);
        }
        for k in 0..4 {
            let d = Vector4::ith(k, h);
            let (p, m) = (at(&q, &(l + d)), at(&q, &(l - d)));
            assert_relative_eq!(jet.anchors[k], (p.value - m.value) / (2.0 * h), epsilon = 1e-8);
            let dj = (p.jacobian - m.jacobian) / (2.0 * h);
            assert_relative_eq!(jet.jacobian_anchors.column(k).into_owned(), dj, epsilon = 1e-8);
        }
    }

    #[test]
    fn derivatives_match_central_differences() {
        check(Measure::World { axis: Vector2::new(0.6, 0.8) });
        check(Measure::OnA { axis_local: Vector2::new(0.6, -0.8) });
        check(Measure::Length);
        check(Measure::Angle);
    }
}
