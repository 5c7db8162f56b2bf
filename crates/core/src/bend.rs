//! How rows bend along the motion: what is left of the second derivative of a row's measure where
//! nothing accelerates.
//!
//! ```text
//!  γ = d/ds [J(q + s v) v]          J a = −γ  keeps J v as it is
//!
//!  r  = p_b + ρ_b − p_a − ρ_a       r' = v_b + ω_b ⊥ρ_b − v_a − ω_a ⊥ρ_a       r" = ω_a² ρ_a − ω_b² ρ_b
//!
//!  φ = u·r       γ = u·r"                                  u fixed in the world
//!                  + 2 ω ⊥u·r' − ω² u·r                    u turns at ω with a or with b
//!  φ = |r|       γ = u·r" + (⊥u·r')²/|r|                   u = r/|r|
//!  φ = θ_b − θ_a  γ = 0
//! ```
//!
//! Gaps are such scalars: of points |r|, of a line on a or b the offset along its normal n. Friction
//! rows are no derivative of anything. With t = ⊥n, ψ' the rate at which n turns, ġ that of the gap, W = ω_b −
//! ω_a, and o the side that the point c of the contact rides on (s = 1 for a, −1 for b, x the other one):
//!
//! ```text
//!  J v = t·(v_b + ω_b ⊥(c − p_b) − v_a − ω_a ⊥(c − p_a))        n·c' = n·v_o + ω_o n·⊥ρ_o + s ġ/2
//!
//!  γ = −ψ' ġ + ω_x n·(v_a − v_b) + W (ω_o n·⊥ρ_o + s ġ/2)
//!
//!  points   ψ' = t·r'/|r|   ġ = n·r'            line   ψ' = ω_l   ġ = n·r' + ω_l t·r
//! ```
//!
//! Derivatives are collected backwards: x̄ is ∂γ/∂x.

use nalgebra::{Vector2, Vector3, Vector4, Vector6};
use tangency_collision::{ContactFeature, Feature, Frame, pose::perp};

use crate::measure::Measure;
use crate::row::{RowContext, RowSource};

/// γ of a row, m/s² or rad/s², with its derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bend {
    /// γ.
    pub value: f64,
    /// ∂γ/∂(q_a, q_b).
    pub by_pose: Vector6<f64>,
    /// ∂γ/∂(v_a, v_b).
    pub by_velocity: Vector6<f64>,
    /// ∂γ/∂(l_a, l_b), the anchors of a joint, or points of a contact's features, in their bodies' frames.
    pub by_anchors: Vector4<f64>,
    /// By the angle of a contact's line within its body, 1/s² times the measure's unit.
    pub by_turn: f64,
}

/// What a direction u turns with.
#[derive(Clone, Copy, PartialEq)]
enum Turns {
    /// Nothing.
    Not,
    /// The body of this side.
    With(usize),
    /// The offset r itself.
    Along,
}

impl RowContext<'_> {
    /// How a row bends at the context's poses and velocities.
    #[must_use]
    pub fn bend(&self, source: RowSource) -> Bend {
        let (joint, row) = match source {
            RowSource::Normal { contact } | RowSource::Tangent { contact } => {
                let feature = &self.contacts[contact as usize].feature;
                let bodies = feature.id.bodies.map(|body| body as usize);
                let frames = bodies.map(|body| Frame::new(&self.q[body]));
                let v = bodies.map(|body| self.v[body]);
                let normal = matches!(source, RowSource::Normal { .. });
                return of_contact(feature, [&frames[0], &frames[1]], v, normal);
            }
            RowSource::Held { joint, row } => (joint, self.joint(joint).held[row as usize]),
            RowSource::Lower { joint }
            | RowSource::Upper { joint }
            | RowSource::Motor { joint } => (joint, self.free(joint)),
        };
        let frames = self.scene.joint_poses(joint as usize, self.q).map(|pose| Frame::new(&pose));
        let it = self.joint(joint);
        let v = it.bodies.map(|body| body.map_or_else(Vector3::zeros, |body| self.v[body]));
        let anchors = [&it.anchors[0], &it.anchors[1]];
        let bend = row.measure.bend([&frames[0], &frames[1]], anchors, v);
        if matches!(source, RowSource::Upper { .. }) { bend.turned() } else { bend }
    }
}

impl Bend {
    fn turned(self) -> Self {
        Self {
            value: -self.value,
            by_pose: -self.by_pose,
            by_velocity: -self.by_velocity,
            by_anchors: -self.by_anchors,
            by_turn: -self.by_turn,
        }
    }
}

impl Measure {
    /// How the scalar bends for anchors in their bodies' frames and velocities (m/s, m/s, rad/s).
    #[must_use]
    pub fn bend(
        &self,
        frames: [&Frame; 2],
        anchors: [&Vector2<f64>; 2],
        v: [Vector3<f64>; 2],
    ) -> Bend {
        let offset = Offset::new(frames, anchors, v);
        match self {
            Self::World { axis } => scalar(&offset, *axis, Turns::Not),
            Self::OnA { axis_local } => {
                scalar(&offset, frames[0].direction(axis_local), Turns::With(0))
            }
            Self::Length => scalar(&offset, offset.r / offset.r.norm(), Turns::Along),
            Self::Angle => Bend::default(),
        }
    }
}

/// How the gap of a contact bends, or its friction row.
fn of_contact(
    feature: &ContactFeature,
    frames: [&Frame; 2],
    v: [Vector3<f64>; 2],
    normal: bool,
) -> Bend {
    let (anchors, turns) = match &feature.feature {
        Feature::Points { a, b } => ([a, b], Turns::Along),
        Feature::LineA { point, b, .. } => ([point, b], Turns::With(0)),
        Feature::LineB { a, point, .. } => ([a, point], Turns::With(1)),
    };
    let offset = Offset::new(frames, anchors, v);
    let n = match &feature.feature {
        Feature::Points { .. } => offset.r / offset.r.norm(),
        Feature::LineA { normal, .. } => frames[0].direction(normal),
        Feature::LineB { normal, .. } => -frames[1].direction(normal),
    };
    if normal { scalar(&offset, n, turns) } else { friction(&offset, n, turns) }
}

/// Two points of two bodies that move on at constant velocities.
struct Offset {
    frames: [(f64, f64); 2],
    rho: [Vector2<f64>; 2],
    v: [Vector2<f64>; 2],
    omega: [f64; 2],
    /// r and its first two derivatives.
    r: Vector2<f64>,
    r1: Vector2<f64>,
    r2: Vector2<f64>,
}

/// Derivatives by what an [`Offset`] has.
#[derive(Default)]
struct Bars {
    rho: [Vector2<f64>; 2],
    v: [Vector2<f64>; 2],
    omega: [f64; 2],
    /// By the angles, where a direction turns with them.
    theta: [f64; 2],
    r: Vector2<f64>,
    r1: Vector2<f64>,
    r2: Vector2<f64>,
    /// By the direction.
    u: Vector2<f64>,
}

impl Offset {
    fn new(frames: [&Frame; 2], anchors: [&Vector2<f64>; 2], v: [Vector3<f64>; 2]) -> Self {
        let rho = [frames[0].direction(anchors[0]), frames[1].direction(anchors[1])];
        let (omega, v) = (v.map(|v| v.z), v.map(|v| v.xy()));
        let r = frames[1].origin() + rho[1] - frames[0].origin() - rho[0];
        let r1 = v[1] + omega[1] * perp(&rho[1]) - v[0] - omega[0] * perp(&rho[0]);
        let r2 = omega[0] * omega[0] * rho[0] - omega[1] * omega[1] * rho[1];
        Self { frames: frames.map(|f| (f.cos(), f.sin())), rho, v, omega, r, r1, r2 }
    }

    /// Derivatives by poses, velocities and anchors, given those by the parts.
    fn pull(&self, value: f64, mut bars: Bars, turns: Turns, u: &Vector2<f64>) -> Bend {
        let across = perp(u);
        match turns {
            Turns::Not => {}
            Turns::With(side) => bars.theta[side] += across.dot(&bars.u),
            Turns::Along => bars.r += across * (across.dot(&bars.u) / self.r.norm()),
        }
        let by_turn = match turns {
            Turns::With(_) => across.dot(&bars.u),
            Turns::Not | Turns::Along => 0.0,
        };
        let mut bend = Bend { value, by_turn, ..Bend::default() };
        for (side, sign) in [(0, -1.0), (1, 1.0)] {
            let (rho, omega, (c, s)) = (&self.rho[side], self.omega[side], self.frames[side]);
            let (r1, r2) = (sign * bars.r1, sign * bars.r2);
            let arm = bars.rho[side] + sign * bars.r - omega * perp(&r1) - omega * omega * r2;
            let turn = bars.omega[side] + perp(rho).dot(&r1) - 2.0 * omega * rho.dot(&r2);
            let (p, v) = (sign * bars.r, bars.v[side] + r1);
            let angle = bars.theta[side] + perp(rho).dot(&arm);
            bend.by_pose.fixed_rows_mut::<3>(3 * side).copy_from(&Vector3::new(p.x, p.y, angle));
            bend.by_velocity.fixed_rows_mut::<3>(3 * side).copy_from(&Vector3::new(v.x, v.y, turn));
            bend.by_anchors[2 * side] = c * arm.x + s * arm.y;
            bend.by_anchors[2 * side + 1] = c * arm.y - s * arm.x;
        }
        bend
    }
}

/// γ of u·r.
fn scalar(offset: &Offset, u: Vector2<f64>, turns: Turns) -> Bend {
    let Offset { r, r1, r2, .. } = offset;
    let (across, mut value) = (perp(&u), u.dot(r2));
    let mut bars = Bars { r2: u, u: *r2, ..Bars::default() };
    match turns {
        Turns::Not => {}
        Turns::With(side) => {
            let omega = offset.omega[side];
            value += 2.0 * omega * across.dot(r1) - omega * omega * u.dot(r);
            bars.r1 += 2.0 * omega * across;
            bars.r -= omega * omega * u;
            bars.u -= 2.0 * omega * perp(r1) + omega * omega * r;
            bars.omega[side] += 2.0 * (across.dot(r1) - omega * u.dot(r));
        }
        Turns::Along => {
            let (slide, length) = (across.dot(r1), r.norm());
            value += slide * slide / length;
            bars.r1 += across * (2.0 * slide / length);
            bars.u -= perp(r1) * (2.0 * slide / length);
            bars.r -= u * (slide * slide / (length * length));
        }
    }
    offset.pull(value, bars, turns, &u)
}

/// γ of a friction row.
fn friction(offset: &Offset, n: Vector2<f64>, turns: Turns) -> Bend {
    let Offset { r, r1, rho, v, omega, .. } = offset;
    let (t, length) = (perp(&n), r.norm());
    let (own, s) = if turns == Turns::With(0) { (1, -1.0) } else { (0, 1.0) };
    let other = 1 - own;
    let (turn, closing) = match turns {
        Turns::With(side) => (omega[side], n.dot(r1) + omega[side] * t.dot(r)),
        _ => (t.dot(r1) / length, n.dot(r1)),
    };
    let (apart, lever) = (n.dot(&(v[0] - v[1])), n.dot(&perp(&rho[own])));
    let spin = omega[1] - omega[0];
    let ride = omega[own] * lever + 0.5 * s * closing;
    let value = -turn * closing + omega[other] * apart + spin * ride;

    let (turn_bar, closing_bar) = (-closing, 0.5 * s * spin - turn);
    let lever_bar = spin * omega[own];
    let mut bars = Bars::default();
    bars.omega[other] += apart;
    bars.omega[0] -= ride;
    bars.omega[1] += ride;
    bars.omega[own] += spin * lever;
    bars.v = [n * omega[other], -n * omega[other]];
    bars.rho[own] -= lever_bar * t;
    bars.r1 += closing_bar * n;
    bars.u += omega[other] * (v[0] - v[1]) + lever_bar * perp(&rho[own]) + closing_bar * r1;
    if let Turns::With(side) = turns {
        bars.omega[side] += turn_bar + closing_bar * t.dot(r);
        bars.r += closing_bar * omega[side] * t;
        bars.u -= closing_bar * omega[side] * perp(r);
    } else {
        bars.r1 += turn_bar / length * t;
        bars.u -= turn_bar / length * perp(r1);
        bars.r -= n * (turn_bar * turn / length);
    }
    offset.pull(value, bars, turns, &n)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use tangency_collision::{ContactId, Part, Pose};

    /// Poses and velocities of both bodies, and anchors.
    type Point = nalgebra::SVector<f64, 16>;

    fn point() -> Point {
        Point::from_row_slice(&[
            0.3, -0.2, 0.7, 1.4, 0.9, -0.4, 0.5, -1.1, 1.7, -0.6, 0.8, -2.3, 0.2, 0.5, -0.3, 0.1,
        ])
    }

    fn parts(x: &Point) -> ([Pose; 2], [Vector2<f64>; 2], [Vector3<f64>; 2]) {
        let three = |k: usize| Vector3::new(x[k], x[k + 1], x[k + 2]);
        let two = |k: usize| Vector2::new(x[k], x[k + 1]);
        ([three(0), three(3)], [two(12), two(14)], [three(6), three(9)])
    }

    /// The derivatives against central differences, and γ against that of J v along the motion.
    fn check(bend: impl Fn(&Point) -> Bend, rate: impl Fn(&Point) -> f64) {
        let (x, h) = (point(), 1e-6);
        let found = bend(&x);
        let mut later = Point::zeros();
        later.fixed_rows_mut::<6>(0).copy_from(&x.fixed_rows::<6>(6));
        let along = (rate(&(x + later * h)) - rate(&(x - later * h))) / (2.0 * h);
        assert_relative_eq!(found.value, along, epsilon = 1e-8);
        let all = found.by_pose.iter().chain(&found.by_velocity).chain(&found.by_anchors);
        for (k, slope) in all.enumerate() {
            let d = Point::ith(k, h);
            let difference = (bend(&(x + d)).value - bend(&(x - d)).value) / (2.0 * h);
            assert_relative_eq!(*slope, difference, epsilon = 1e-8);
        }
    }

    fn frames(q: &[Pose; 2]) -> [Frame; 2] {
        [Frame::new(&q[0]), Frame::new(&q[1])]
    }

    #[test]
    fn scalars_of_joints() {
        for measure in [
            Measure::World { axis: Vector2::new(0.6, 0.8) },
            Measure::OnA { axis_local: Vector2::new(0.6, -0.8) },
            Measure::Length,
            Measure::Angle,
        ] {
            let bend = |x: &Point| {
                let (q, l, v) = parts(x);
                let frames = frames(&q);
                measure.bend([&frames[0], &frames[1]], [&l[0], &l[1]], v)
            };
            let rate = |x: &Point| {
                let (q, l, v) = parts(x);
                let jacobian = measure.evaluate([&q[0], &q[1]], [&l[0], &l[1]]).jacobian;
                jacobian[0].dot(&v[0]) + jacobian[1].dot(&v[1])
            };
            check(bend, rate);
        }
    }

    #[test]
    fn rows_of_contacts() {
        let id = ContactId { bodies: [0, 1], shapes: [0, 0], parts: [Part::Vertex(0); 2] };
        let feature = |x: &Point, kind: usize| {
            let (_, [a, b], _) = parts(x);
            let normal = Vector2::new(0.28, 0.96);
            let feature = match kind {
                0 => Feature::Points { a, b },
                1 => Feature::LineA { point: a, normal, b },
                _ => Feature::LineB { a, point: b, normal },
            };
            ContactFeature { id, feature, radii: [0.3, 0.17] }
        };
        for kind in 0..3 {
            for normal in [true, false] {
                let bend = |x: &Point| {
                    let (q, _, v) = parts(x);
                    let frames = frames(&q);
                    of_contact(&feature(x, kind), [&frames[0], &frames[1]], v, normal)
                };
                let rate = |x: &Point| {
                    let (q, _, v) = parts(x);
                    let contact = feature(x, kind).evaluate(&q[0], &q[1]);
                    let d = if normal { contact.normal } else { perp(&contact.normal) };
                    let at = |i: usize| v[i].xy() + v[i].z * perp(&(contact.point - q[i].xy()));
                    d.dot(&(at(1) - at(0)))
                };
                check(bend, rate);
            }
        }
    }
}
