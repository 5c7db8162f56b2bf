//! Scenes in which what should be contradicts itself, though a motion exists.

use tangency_core::{BodyDef, JointDef, JointKind, Limits, SceneDef, WORLD};

use super::bodies::{block, disc, hinge, material, plane, rod, slender_inertia, unit_scene};

/// A box 1 m wide between walls 0.8 m apart, `offset` from the middle; penetrations may go at any
/// speed.
#[must_use]
pub fn wedged_box(offset: f64) -> SceneDef {
    let walls = [plane("left", [1.0, 0.0], -0.4), plane("right", [-1.0, 0.0], -0.4)];
    let wedged = BodyDef { mass: Some(2.0), ..block("box", [1.0; 2], [offset, 0.0]) };
    let bodies = walls.into_iter().chain([wedged]).collect();
    let def = SceneDef { recovery_speed: 1e6, ..unit_scene("wedged box", bodies) };
    material(def, 0.0, 0.0)
}

/// A disc of radius 0.1 with 2 mm to either wall of its slot, at 1 m/s towards one wall.
#[must_use]
pub fn narrow_slot(restitution: f64) -> SceneDef {
    let walls = [plane("left", [1.0, 0.0], -0.102), plane("right", [-1.0, 0.0], -0.102)];
    let ball = BodyDef { velocity: [1.0, 0.0], ..disc("ball", 0.1, [0.0; 2]) };
    let bodies = walls.into_iter().chain([ball]).collect();
    material(unit_scene("ball in a narrow slot", bodies), 0.0, restitution)
}

/// A seesaw (slender, 1 kg, 7 m) that a heavy disc strikes 1 m from its pivot, with a light one lying 6 m
/// beyond: a lever that makes things fast.
#[must_use]
pub fn seesaw(restitution: f64) -> SceneDef {
    let plank = BodyDef {
        mass: Some(1.0),
        inertia: Some(slender_inertia(1.0, 7.0)),
        ..block("plank", [7.0, 0.1], [2.5, 0.0])
    };
    let heavy =
        BodyDef { mass: Some(1e4), velocity: [0.0, -1.0], ..disc("heavy", 0.2, [-1.0, 0.25]) };
    let light = BodyDef { mass: Some(1e-3), ..disc("light", 0.05, [6.0, 0.1]) };
    let joints = vec![hinge("pivot", WORLD, "plank", [0.0; 2])];
    let def = SceneDef { joints, ..unit_scene("seesaw", vec![plank, heavy, light]) };
    material(def, 0.0, restitution)
}

/// Slender rod of 1 m and 1 kg, hinged to the world at both ends, the far hinge `error` too far away.
#[must_use]
pub fn misfit_hinges(error: f64) -> SceneDef {
    let kind = JointKind::Revolute {
        anchor: [1.0 + error, 0.0],
        anchor_b: Some([1.0, 0.0]),
        limits: Limits::default(),
        motor: None,
    };
    let far = JointDef { kind, ..hinge("far", WORLD, "rod", [0.0; 2]) };
    let bodies = vec![rod("rod", 1.0, 1.0, [0.5, 0.0], 0.0)];
    let joints = vec![hinge("near", WORLD, "rod", [0.0; 2]), far];
    SceneDef { name: "misfit hinges".into(), bodies, joints, ..SceneDef::default() }
}
