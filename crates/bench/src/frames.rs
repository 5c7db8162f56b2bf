//! The same scene seen from another frame, or listed in another order.

use nalgebra::{Rotation2, Vector2, Vector3};
use tangency_core::{JointKind, SceneDef, State};

/// Another frame: what was at x is at R(angle) x + offset.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Frame {
    /// rad, about the origin.
    pub angle: f64,
    /// m, after the turn.
    pub offset: [f64; 2],
}

impl Frame {
    /// A definition in the new frame.
    ///
    /// # Panics
    /// If the frame turns and a joint locks x or y, which no other frame can say.
    #[must_use]
    pub fn scene(&self, def: &SceneDef) -> SceneDef {
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

    /// A state of the new scene in the old frame.
    #[must_use]
    pub fn old_state(&self, state: &State) -> State {
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

    fn joint(&self, kind: &mut JointKind) {
        match kind {
            JointKind::Revolute { anchor, anchor_b, .. } => {
                self.place(anchor);
                anchor_b.iter_mut().for_each(|anchor| self.place(anchor));
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

    fn turn(&self, x: &mut [f64; 2]) {
        *x = (Rotation2::new(self.angle) * Vector2::from(*x)).into();
    }

    fn place(&self, x: &mut [f64; 2]) {
        self.turn(x);
        *x = [x[0] + self.offset[0], x[1] + self.offset[1]];
    }
}

/// The definition with its bodies, their shapes, joints and forces listed backwards: body i becomes
/// body n − 1 − i.
#[must_use]
pub fn reversed(def: &SceneDef) -> SceneDef {
    let mut def = def.clone();
    def.bodies.reverse();
    def.bodies.iter_mut().for_each(|body| body.shapes.reverse());
    def.joints.reverse();
    def.forces.reverse();
    def.pairs.reverse();
    def
}

/// A state of the [`reversed`] scene in the old order.
#[must_use]
pub fn old_order(state: &State) -> State {
    let mut state = state.clone();
    state.q.reverse();
    state.v.reverse();
    state
}
