//! Scenes that something is to be done in, through their control channels.

use tangency_core::{
    BodyDef, ControlDef, ControlInput, JointDef, JointKind, Limits, SceneDef, WORLD,
};

use super::bodies::{block, floor, material};
use super::joints::pendulum;
use super::race::race_cartpole;

/// Time step of the tasks, s.
const DT: f64 = 0.02;

/// A hanging rod (1 m, 1 kg) with a torque at its pin: 4.905 N·m would hold it level.
#[must_use]
pub fn driven_pendulum() -> SceneDef {
    let input = ControlInput::JointForce { joint: "pin0".into() };
    let controls = vec![ControlDef { name: "torque".into(), input }];
    SceneDef { name: "driven pendulum".into(), dt: DT, controls, ..pendulum(0.0) }
}

/// The cart and pole of the races (1 kg; 0.1 kg, 1 m), the pole hanging at rest.
#[must_use]
pub fn hanging_cartpole() -> SceneDef {
    let mut def = race_cartpole();
    let pole = &mut def.bodies[1];
    (pole.position, pole.angle) = ([0.0, -0.5], -std::f64::consts::FRAC_PI_2);
    SceneDef { name: "hanging cartpole".into(), dt: DT, ..def }
}

/// A box (0.4 m, 1 kg) on a floor with μ = 0.3, and a smooth hand (0.5 kg) on a rail that touches it from
/// behind: the hand can push, not pull. (A rough hand on a rail could carry any part of the box's weight,
/// and so would leave its friction undetermined.)
#[must_use]
pub fn pushed_box() -> SceneDef {
    let cube = BodyDef { mass: Some(1.0), ..block("box", [0.4, 0.4], [0.0, 0.2]) };
    let hand = BodyDef { mass: Some(0.5), ..block("hand", [0.1, 0.1], [-0.25, 0.2]) };
    let (limits, motor) = (Limits::default(), None);
    let kind = JointKind::Prismatic { anchor: [-0.25, 0.2], axis: [1.0, 0.0], limits, motor };
    let bodies = [WORLD.into(), "hand".into()];
    let rail = JointDef { name: "rail".into(), bodies, kind, collide: false, softness: None };
    let input = ControlInput::JointForce { joint: "rail".into() };
    let mut def = SceneDef {
        name: "pushed box".into(),
        dt: DT,
        bodies: vec![floor(), cube, hand],
        joints: vec![rail],
        controls: vec![ControlDef { name: "push".into(), input }],
        ..SceneDef::default()
    };
    def = material(def, 0.3, 0.0);
    def.bodies[2].friction = 0.0;
    def
}
