//! Impacts whose time depends on what the motion is differentiated by.

use tangency_core::{BodyDef, ControlDef, ControlInput, ForceDef, SceneDef};

use super::bodies::{disc, fixed_block, floor, material, plane, unit_scene};

/// V34 (a), (b): disc of radius 0.1 and 1 kg at height 1, thrown down at 2 m/s. A force of zero acts
/// on it upwards during the first 1/480 s.
#[must_use]
pub fn thrown_down(gravity: f64, restitution: f64) -> SceneDef {
    let ball = BodyDef { mass: Some(1.0), velocity: [0.0, -2.0], ..disc("ball", 0.1, [0.0, 1.0]) };
    let bodies = vec![floor(), ball];
    let (name, gravity) = ("thrown down".into(), [0.0, -gravity]);
    let push = ForceDef { body: "ball".into(), end: Some(1.0 / 480.0), ..ForceDef::default() };
    let def = SceneDef { name, gravity, bodies, forces: vec![push], ..SceneDef::default() };
    material(def, 0.0, restitution)
}

/// V34 (c), (d): two discs on the x axis, (x, v, m, r) each.
#[must_use]
pub fn pursuit(discs: [[f64; 4]; 2], restitution: f64) -> SceneDef {
    let bodies = discs.iter().enumerate().map(|(i, &[x, v, mass, radius])| BodyDef {
        mass: Some(mass),
        velocity: [v, 0.0],
        ..disc(&format!("disc{i}"), radius, [x, 0.0])
    });
    material(unit_scene("pursuit", bodies.collect()), 0.0, restitution)
}

/// V36 (a): disc of radius 0.1 thrown at (5, −5) onto the floor and from there against a wall.
#[must_use]
pub fn bank_shot() -> SceneDef {
    let ball = BodyDef { mass: Some(1.0), velocity: [5.0, -5.0], ..disc("ball", 0.1, [-0.5, 1.0]) };
    let bodies = vec![floor(), plane("wall", [-1.0, 0.0], -1.75), ball];
    let (name, gravity) = ("bank shot".into(), [0.0, -9.8]);
    material(SceneDef { name, gravity, bodies, ..SceneDef::default() }, 0.0, 0.92)
}

/// V36 (b), (c): the first of two discs of radius 0.2 is pushed at the second, by two controls of
/// 1/480 s each.
#[must_use]
pub fn pushed_pair(first: [f64; 2]) -> SceneDef {
    let disc = |name, at| BodyDef { mass: Some(1.0), ..disc(name, 0.2, at) };
    let control = |name: &str, input| ControlDef { name: name.into(), input };
    let controls = vec![
        control("x", ControlInput::ForceX { body: "first".into() }),
        control("y", ControlInput::ForceY { body: "first".into() }),
    ];
    let def = unit_scene("pushed pair", vec![disc("first", first), disc("second", [-1.0; 2])]);
    material(SceneDef { dt: 1.0 / 480.0, controls, ..def }, 0.0, 1.0)
}

/// V37 (a): disc of radius 0.2 between fixed discs of radius 0.8, on their axis at 1 m/s.
#[must_use]
pub fn between_discs() -> SceneDef {
    let fixed = |name, x| BodyDef {
        shapes: disc(name, 0.8, [0.0; 2]).shapes,
        ..fixed_block(name, [1.0; 2], [x, 0.0])
    };
    let ball = BodyDef { mass: Some(1.0), velocity: [1.0, 0.0], ..disc("ball", 0.2, [0.0; 2]) };
    let bodies = vec![fixed("left", -2.0), fixed("right", 2.0), ball];
    material(unit_scene("between discs", bodies), 0.0, 1.0)
}
