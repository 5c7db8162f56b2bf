//! Another order.

use tangency_core::{Param, Scene, SceneDef, State};

use super::{Number, Retelling};

/// Bodies, their shapes, joints, forces and pairs listed backwards.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reversed;

impl Retelling for Reversed {
    fn scene(&self, def: &SceneDef) -> SceneDef {
        let mut def = def.clone();
        def.bodies.reverse();
        def.bodies.iter_mut().for_each(|body| body.shapes.reverse());
        def.joints.reverse();
        def.forces.reverse();
        def.pairs.reverse();
        def
    }

    fn told_back(&self, state: &State) -> State {
        let mut state = state.clone();
        state.q.reverse();
        state.v.reverse();
        state
    }

    fn number(&self, bodies: usize, number: Number) -> Vec<(Number, f64)> {
        let number = match number {
            Number::Pose(i, axis) => Number::Pose(bodies - 1 - i, axis),
            Number::Velocity(i, axis) => Number::Velocity(bodies - 1 - i, axis),
        };
        vec![(number, 1.0)]
    }

    fn param(&self, scene: &Scene, param: Param) -> Vec<(Param, f64)> {
        let body = |i: usize| scene.bodies().len() - 1 - i;
        let joint = |j: usize| scene.joints().len() - 1 - j;
        let shape = |i: usize, k: usize| scene.colliders()[i].shapes().len() - 1 - k;
        let param = match param {
            Param::Mass(i) => Param::Mass(body(i)),
            Param::Density(i) => Param::Density(body(i)),
            Param::Inertia(i) => Param::Inertia(body(i)),
            Param::Friction(i) => Param::Friction(body(i)),
            Param::Restitution(i) => Param::Restitution(body(i)),
            Param::Radius(i, k) => Param::Radius(body(i), shape(i, k)),
            Param::Shape(i, k, number) => Param::Shape(body(i), shape(i, k), number),
            Param::Position(i, axis) => Param::Position(body(i), axis),
            Param::Velocity(i, axis) => Param::Velocity(body(i), axis),
            Param::Gravity(_) | Param::Dt => param,
            Param::AnchorA(j, axis) => Param::AnchorA(joint(j), axis),
            Param::AnchorB(j, axis) => Param::AnchorB(joint(j), axis),
            Param::Length(j) => Param::Length(joint(j)),
            Param::MotorSpeed(j) => Param::MotorSpeed(joint(j)),
            Param::MotorMax(j) => Param::MotorMax(joint(j)),
            Param::Stiffness(j) => Param::Stiffness(joint(j)),
            Param::Damping(j) => Param::Damping(joint(j)),
            Param::Lower(j) => Param::Lower(joint(j)),
            Param::Upper(j) => Param::Upper(joint(j)),
            Param::Force(f, axis) => Param::Force(scene.forces().len() - 1 - f, axis),
        };
        vec![(param, 1.0)]
    }
}
