//! Derivatives of the rows of joints: Jacobian and value by poses and anchors.
//!
//! ```text
//!  r = p_b + ρ_b − p_a − ρ_a      φ = u·r      J = [−u, −u·⊥ρ_a (+ ⊥u·r) | u, u·⊥ρ_b]
//!
//!  e = J̄_b − J̄_a − J̄_aθ ⊥ρ_a + J̄_bθ ⊥ρ_b      J̄·J + φ̄ φ = u·(e + φ̄ r) (+ J̄_aθ ⊥u·r)
//!
//!  each row     r̄ += φ̄ u (+ J̄_aθ ⊥u)  [+ (⊥u·e) ⊥u/|r|]      ρ̄_a += J̄_aθ ⊥u      ρ̄_b −= J̄_bθ ⊥u
//!               (θ̄_a += ⊥u·(e + φ̄ r) − J̄_aθ u·r)
//!  then         p̄_a −= r̄      p̄_b += r̄      ρ̄_a −= r̄      ρ̄_b += r̄      θ̄ += ⊥ρ·ρ̄      l̄ += Rᵀ ρ̄
//! ```
//!
//! In round brackets what is added where u turns with a, in square ones where u = r/|r|.

use nalgebra::{UnitComplex, Vector2, Vector3, Vector4, Vector6};
use tangency_collision::pose::perp;
use tangency_core::measure::{Measure, MeasureJet};
use tangency_core::row::RowContext;
use tangency_core::{Joint, JointRow};

use crate::rotations::Rotations;
use crate::shape::Shape;
use crate::vector::{Bars, Direction};

/// A joint at the poses of a step, and what is collected over its rows.
pub(crate) struct JointPlace {
    joint: usize,
    bodies: [Option<usize>; 2],
    rotations: [UnitComplex<f64>; 2],
    /// ρ, m.
    arms: [Vector2<f64>; 2],
    /// r, m.
    offset: Vector2<f64>,
    /// θ_b − θ_a, rad.
    angle: f64,
    /// ρ̄ without r̄, r̄ and θ̄ per side.
    arms_bar: [Vector2<f64>; 2],
    offset_bar: Vector2<f64>,
    angles_bar: [f64; 2],
}

impl JointPlace {
    /// The joint at the context's poses.
    pub(crate) fn new(context: &RowContext<'_>, joint: u32, rotations: &mut Rotations) -> Self {
        let joint = joint as usize;
        let Joint { bodies, anchors, .. } = &context.scene.joints()[joint];
        let poses = bodies.map(|body| body.map_or_else(Vector3::zeros, |body| context.q[body]));
        let mut turn = |side: usize| {
            let of = |body| rotations.of(body, &poses[side]);
            bodies[side].map_or_else(UnitComplex::identity, of)
        };
        let rotations = [turn(0), turn(1)];
        let arms = [rotations[0] * anchors[0], rotations[1] * anchors[1]];
        Self {
            joint,
            bodies: *bodies,
            rotations,
            arms,
            offset: poses[1].xy() + arms[1] - poses[0].xy() - arms[0],
            angle: poses[1].z - poses[0].z,
            arms_bar: [Vector2::zeros(); 2],
            offset_bar: Vector2::zeros(),
            angles_bar: [0.0; 2],
        }
    }

    /// Bodies a and b; `None` is the world.
    pub(crate) fn bodies(&self) -> &[Option<usize>; 2] {
        &self.bodies
    }

    /// Value (less the reference) and gradient of a row.
    #[inline]
    pub(crate) fn shape(&self, row: &JointRow) -> Shape {
        let [arm_a, arm_b] = &self.arms;
        let (mut jacobian, mut value) = ([-Vector3::z(), Vector3::z()], self.angle);
        if let Some(u) = self.direction(&row.measure) {
            let turning = if turns(&row.measure) { perp(&u).dot(&self.offset) } else { 0.0 };
            jacobian[0] = Vector3::new(-u.x, -u.y, turning - u.dot(&perp(arm_a)));
            jacobian[1] = Vector3::new(u.x, u.y, u.dot(&perp(arm_b)));
            value = u.dot(&self.offset);
        }
        Shape { value: value - row.reference, jacobian }
    }

    /// u; an angle has none.
    #[inline]
    fn direction(&self, measure: &Measure) -> Option<Vector2<f64>> {
        match measure {
            Measure::World { axis } => Some(*axis),
            Measure::OnA { axis_local } => Some(self.rotations[0] * axis_local),
            Measure::Length => Some(self.offset / self.offset.norm()),
            Measure::Angle => None,
        }
    }

    /// Collects ∂L/∂J (1 × 3 per side) and ∂L/∂φ of a row.
    #[inline]
    pub(crate) fn add_row(&mut self, measure: &Measure, bar: &[Vector3<f64>; 2], value_bar: f64) {
        let Some(u) = self.direction(measure) else {
            self.angles_bar[0] -= value_bar;
            self.angles_bar[1] += value_bar;
            return;
        };
        let ([a, b], [arm_a, arm_b], r, across) = (bar, &self.arms, &self.offset, perp(&u));
        let e = b.xy() - a.xy() - perp(arm_a) * a.z + perp(arm_b) * b.z;
        self.offset_bar += u * value_bar;
        if turns(measure) {
            self.offset_bar += across * a.z;
            self.angles_bar[0] += across.dot(&(e + r * value_bar)) - a.z * u.dot(r);
        } else if *measure == Measure::Length {
            self.offset_bar += across * (across.dot(&e) / r.norm());
        }
        self.arms_bar[0] += across * a.z;
        self.arms_bar[1] -= across * b.z;
    }

    /// Pulls what was collected onto poses and anchors.
    pub(crate) fn pull_back(&self, bars: &mut Bars<'_>) {
        let r_bar = self.offset_bar;
        let offsets_bar = [-r_bar, r_bar];
        let by = &mut bars.scene.joints[self.joint].anchors;
        for side in 0..2 {
            let (p_bar, arm) = (offsets_bar[side], &self.arms[side]);
            let arm_bar = self.arms_bar[side] + p_bar;
            by[side] += self.rotations[side].inverse_transform_vector(&arm_bar);
            if let Some(body) = self.bodies[side] {
                let angle_bar = self.angles_bar[side] + perp(arm).dot(&arm_bar);
                bars.state.q[body] += Vector3::new(p_bar.x, p_bar.y, angle_bar);
            }
        }
    }
}

fn turns(measure: &Measure) -> bool {
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
