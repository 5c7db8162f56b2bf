//! Derivatives of the rows of joints: Jacobian and value by poses and anchors.
//!
//! ```text
//!  r = p_b + ρ_b − p_a − ρ_a      φ = u·r      J = [−u, −u·⊥ρ_a (+ ⊥u·r) | u, u·⊥ρ_b]
//!
//!  e = J̄_b − J̄_a − J̄_aθ ⊥ρ_a + J̄_bθ ⊥ρ_b      J̄·J + φ̄ φ = u·(e + φ̄ r) (+ J̄_aθ ⊥u·r)
//!
//!  r̄ = φ̄ u (+ J̄_aθ ⊥u) (+ (⊥u·e) ⊥u/|r|)      p̄_a = −r̄      p̄_b = r̄
//!  ρ̄_a = J̄_aθ ⊥u − r̄      ρ̄_b = r̄ − J̄_bθ ⊥u      l̄ = Rᵀ ρ̄
//!  θ̄_a = ⊥ρ_a·ρ̄_a (+ ⊥u·(e + φ̄ r) − J̄_aθ u·r)      θ̄_b = ⊥ρ_b·ρ̄_b
//! ```
//!
//! In brackets with J̄_aθ: what is added where u turns with a; with e: where u = r/|r|.

use nalgebra::{UnitComplex, Vector2, Vector3, Vector4, Vector6};
use tangency_collision::pose::perp;
use tangency_core::JointRow;
use tangency_core::measure::{Measure, MeasureJet};
use tangency_core::row::{RowContext, RowGeometry};

use crate::rotations::Rotations;
use crate::vector::{Bars, Direction};

/// A joint at the poses of a step: what all its rows are made of.
pub(crate) struct JointPlace {
    joint: usize,
    bodies: [Option<usize>; 2],
    rotation: [UnitComplex<f64>; 2],
    /// ρ, m.
    arms: [Vector2<f64>; 2],
    /// r, m.
    offset: Vector2<f64>,
    /// θ_b − θ_a, rad.
    angle: f64,
}

impl JointPlace {
    /// The joint at the context's poses.
    pub(crate) fn new(context: &RowContext<'_>, joint: u32, rotations: &mut Rotations) -> Self {
        let joint = joint as usize;
        let it = &context.scene.joints()[joint];
        let pose = |side: usize| it.bodies[side].map_or_else(Vector3::zeros, |b| context.q[b]);
        let (a, b) = (pose(0), pose(1));
        let mut turn = |side: usize, pose: &Vector3<f64>| {
            it.bodies[side].map_or_else(UnitComplex::identity, |body| rotations.of(body, pose))
        };
        let rotation = [turn(0, &a), turn(1, &b)];
        let arms = [rotation[0] * it.anchors[0], rotation[1] * it.anchors[1]];
        let offset = b.xy() + arms[1] - a.xy() - arms[0];
        Self { joint, bodies: it.bodies, rotation, arms, offset, angle: b.z - a.z }
    }

    /// Value (less the reference) and gradient of a row.
    pub(crate) fn geometry(&self, row: JointRow) -> RowGeometry {
        let [arm_a, arm_b] = &self.arms;
        let (mut jacobian, mut value) = ([-Vector3::z(), Vector3::z()], self.angle);
        if let Some(u) = self.direction(row.measure) {
            let turning = if turns(row.measure) { perp(&u).dot(&self.offset) } else { 0.0 };
            jacobian[0] = Vector3::new(-u.x, -u.y, turning - u.dot(&perp(arm_a)));
            jacobian[1] = Vector3::new(u.x, u.y, u.dot(&perp(arm_b)));
            value = u.dot(&self.offset);
        }
        RowGeometry { bodies: self.bodies, value: value - row.reference, jacobian }
    }

    /// u; an angle has none.
    fn direction(&self, measure: Measure) -> Option<Vector2<f64>> {
        match measure {
            Measure::World { axis } => Some(axis),
            Measure::OnA { axis_local } => Some(self.rotation[0] * axis_local),
            Measure::Length => Some(self.offset / self.offset.norm()),
            Measure::Angle => None,
        }
    }

    /// Pulls ∂L/∂J (1 × 3 per side) and ∂L/∂φ of a row back onto poses and anchors.
    pub(crate) fn pull_row(
        &self,
        measure: Measure,
        [a_bar, b_bar]: &[Vector3<f64>; 2],
        value_bar: f64,
        bars: &mut Bars<'_>,
    ) {
        let Some(u) = self.direction(measure) else {
            return self.add_poses(&[-Vector3::z() * value_bar, Vector3::z() * value_bar], bars);
        };
        let ([arm_a, arm_b], r, across) = (&self.arms, &self.offset, perp(&u));
        let e = b_bar.xy() - a_bar.xy() - perp(arm_a) * a_bar.z + perp(arm_b) * b_bar.z;
        let (mut r_bar, mut turn_bar) = (u * value_bar, 0.0);
        if turns(measure) {
            r_bar += across * a_bar.z;
            turn_bar = across.dot(&(e + r * value_bar)) - a_bar.z * u.dot(r);
        } else if measure == Measure::Length {
            r_bar += across * (across.dot(&e) / r.norm());
        }
        let arms_bar = [across * a_bar.z - r_bar, r_bar - across * b_bar.z];
        let angle_a = perp(arm_a).dot(&arms_bar[0]) + turn_bar;
        let angle_b = perp(arm_b).dot(&arms_bar[1]);
        let a = Vector3::new(-r_bar.x, -r_bar.y, angle_a);
        let b = Vector3::new(r_bar.x, r_bar.y, angle_b);
        self.add_poses(&[a, b], bars);
        let anchors = &mut bars.scene.joints[self.joint].anchors;
        for ((anchor, rotation), arm) in anchors.iter_mut().zip(&self.rotation).zip(&arms_bar) {
            *anchor += rotation.inverse_transform_vector(arm);
        }
    }

    fn add_poses(&self, by: &[Vector3<f64>; 2], bars: &mut Bars<'_>) {
        for (body, by) in self.bodies.iter().zip(by) {
            if let Some(body) = body {
                bars.state.q[*body] += by;
            }
        }
    }
}

fn turns(measure: Measure) -> bool {
    matches!(measure, Measure::OnA { .. })
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
