//! Scenes on which engines are timed against each other: small, and described in a line each.

use tangency_core::{
    BodyDef, ControlDef, ControlInput, JointDef, JointKind, Limits, SceneDef, WORLD,
};

use super::bodies::{block, disc, floor, hinge, material, rod};

/// Time step of the scenes, s.
const DT: f64 = 0.005;

/// The four scenes of the race: a bouncing disc, ten boxes, ten rods, a pole on a cart.
#[must_use]
pub fn race_scenes() -> [SceneDef; 4] {
    [race_bounce(), race_stack(10), race_chain(10), race_cartpole()]
}

/// A disc (0.1 m, 1 kg) 1 m above a floor flies at 1 m/s and bounces with e = 0.5, without friction.
#[must_use]
pub fn race_bounce() -> SceneDef {
    let ball = disc("ball", 0.1, [0.0, 1.0]);
    let ball = BodyDef { mass: Some(1.0), velocity: [1.0, 0.0], ..ball };
    let def = SceneDef { name: "bounce".into(), bodies: vec![floor(), ball], ..settings() };
    material(def, 0.0, 0.5)
}

/// `n` boxes (0.5 m, 1 kg) upon each other, μ = 0.2; the top one starts at 0.5 m/s.
#[must_use]
pub fn race_stack(n: usize) -> SceneDef {
    let layer = |i: usize| BodyDef {
        mass: Some(1.0),
        velocity: [if i + 1 == n { 0.5 } else { 0.0 }, 0.0],
        ..block(&format!("box{i}"), [0.5; 2], [0.0, 0.25 + 0.5 * i as f64])
    };
    let bodies = std::iter::once(floor()).chain((0..n).map(layer)).collect();
    material(SceneDef { name: format!("stack of {n}"), bodies, ..settings() }, 0.2, 0.0)
}

/// `n` slender rods (0.5 m, 1 kg), pinned to the origin and let go straight and level.
#[must_use]
pub fn race_chain(n: usize) -> SceneDef {
    let link = |i: usize| rod(&format!("link{i}"), 0.5, 1.0, [0.5 * (i as f64 + 0.5), 0.0], 0.0);
    let joint = |i: usize| {
        let before = if i == 0 { WORLD.into() } else { format!("link{}", i - 1) };
        hinge(&format!("pin{i}"), &before, &format!("link{i}"), [0.5 * i as f64, 0.0])
    };
    let (bodies, joints) = ((0..n).map(link).collect(), (0..n).map(joint).collect());
    SceneDef { name: format!("chain of {n}"), bodies, joints, ..settings() }
}

/// A pole (1 m, 0.1 kg), 0.1 rad from upright, on a cart (1 kg) that a control channel pushes.
#[must_use]
pub fn race_cartpole() -> SceneDef {
    let angle: f64 = 0.1;
    let (sin, cos) = angle.sin_cos();
    // Without a shape; its inertia never shows.
    let cart =
        BodyDef { name: "cart".into(), mass: Some(1.0), inertia: Some(1.0), ..BodyDef::default() };
    let turn = angle + std::f64::consts::FRAC_PI_2;
    let pole = rod("pole", 1.0, 0.1, [-0.5 * sin, 0.5 * cos], turn);
    let (limits, motor) = (Limits::default(), None);
    let kind = JointKind::Prismatic { anchor: [0.0; 2], axis: [1.0, 0.0], limits, motor };
    let bodies = [WORLD.into(), "cart".into()];
    let rail = JointDef { name: "rail".into(), bodies, kind, collide: false, softness: None };
    let joints = vec![rail, hinge("hinge", "cart", "pole", [0.0; 2])];
    let input = ControlInput::JointForce { joint: "rail".into() };
    let controls = vec![ControlDef { name: "push".into(), input }];
    let name = "cartpole".into();
    SceneDef { name, bodies: vec![cart, pole], joints, controls, ..settings() }
}

fn settings() -> SceneDef {
    SceneDef { dt: DT, ..SceneDef::default() }
}
