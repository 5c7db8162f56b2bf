//! Another frame.

use nalgebra::{Rotation2, Vector2, Vector3};
use tangency_core::{JointKind, Param, Scene, SceneDef, State};

use super::{Number, Retelling};

/// Another frame: what was at x is at R(angle) x + offset.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Frame {
    /// rad, about the origin.
    pub angle: f64,
    /// m, after the turn.
    pub offset: [f64; 2],
}

impl Frame {
    fn joint(&self, kind: &mut JointKind) {
        match kind {
            JointKind::Revolute { anchor, anchor_b, .. } => {
                self.place(anchor);
                if let Some(anchor) = anchor_b {
                    self.place(anchor);
                }
            }
            JointKind::Weld { anchor } => self.place(anchor),
            JointKind::Prismatic { anchor, axis, .. } | JointKind::Slot { anchor, axis, .. } => {
                self.place(anchor);
                self.turn(axis);
            }
            JointKind::Distance { anchor_a, anchor_b, .. }
            | JointKind::Spring { anchor_a, anchor_b, .. } => {
                self.place(anchor_a);
                self.place(anchor_b);
            }
            JointKind::Lock { x, y, .. } => {
                assert!(self.angle == 0.0 || !(*x || *y), "a lock of x or y has its own frame");
            }
        }
    }

    /// An old axis in the new frame; the third is the angle.
    fn along<T>(&self, axis: usize, on: impl Fn(usize) -> T) -> Vec<(T, f64)> {
        let (sin, cos) = self.angle.sin_cos();
        match axis {
            0 => vec![(on(0), cos), (on(1), sin)],
            1 => vec![(on(0), -sin), (on(1), cos)],
            _ => vec![(on(axis), 1.0)],
        }
    }

    fn turn(&self, x: &mut [f64; 2]) {
        *x = (Rotation2::new(self.angle) * Vector2::from(*x)).into();
    }

    fn place(&self, x: &mut [f64; 2]) {
        self.turn(x);
        *x = [x[0] + self.offset[0], x[1] + self.offset[1]];
    }
}

impl Retelling for Frame {
    /// # Panics
    /// If the frame turns and a joint locks x or y, which no other frame can say.
    fn scene(&self, def: &SceneDef) -> SceneDef {
        let mut def = def.clone();
        self.turn(&mut def.gravity);
        for body in &mut def.bodies {
            self.place(&mut body.position);
            self.turn(&mut body.velocity);
            body.angle += self.angle;
        }
        def.joints.iter_mut().for_each(|joint| self.joint(&mut joint.kind));
        def.forces.iter_mut().for_each(|force| self.turn(&mut force.force));
        def
    }

    fn told_back(&self, state: &State) -> State {
        let back = |x: Vector2<f64>, z: f64| {
            let x = Rotation2::new(-self.angle) * x;
            Vector3::new(x.x, x.y, z)
        };
        let offset = Vector2::from(self.offset);
        let pose = |q: &Vector3<f64>| back(q.xy() - offset, q.z - self.angle);
        State {
            time: state.time,
            q: state.q.iter().map(pose).collect(),
            v: state.v.iter().map(|v| back(v.xy(), v.z)).collect(),
        }
    }

    fn number(&self, _bodies: usize, number: Number) -> Vec<(Number, f64)> {
        match number {
            Number::Pose(i, axis) => self.along(axis, |axis| Number::Pose(i, axis)),
            Number::Velocity(i, axis) => self.along(axis, |axis| Number::Velocity(i, axis)),
        }
    }

    fn param(&self, scene: &Scene, param: Param) -> Vec<(Param, f64)> {
        let in_world = |j: usize, side: usize| scene.joints()[j].bodies[side].is_none();
        match param {
            Param::Position(i, axis) => self.along(axis, |axis| Param::Position(i, axis)),
            Param::Velocity(i, axis) => self.along(axis, |axis| Param::Velocity(i, axis)),
            Param::Force(f, axis) => self.along(axis, |axis| Param::Force(f, axis)),
            Param::Gravity(axis) => self.along(axis, Param::Gravity),
            Param::AnchorA(j, axis) if in_world(j, 0) => {
                self.along(axis, |axis| Param::AnchorA(j, axis))
            }
            Param::AnchorB(j, axis) if in_world(j, 1) => {
                self.along(axis, |axis| Param::AnchorB(j, axis))
            }
            _ => vec![(param, 1.0)],
        }
    }
}
