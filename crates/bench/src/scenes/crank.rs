//! Rods on hinges whose first reactions are known.

use tangency_core::{JointDef, JointKind, SceneDef, WORLD};

use super::bodies::{hinge, rod};

/// V13 (a): crank (0.3 m, 1 kg) at `angle`, turning at `rate`; rod (1 m, 2 kg); slider (3 kg) on
/// y = 0. All velocities fit the hinges.
#[must_use]
pub fn slider_crank(angle: f64, rate: f64) -> SceneDef {
    let (sin, cos) = angle.sin_cos();
    let pin = [0.3 * cos, 0.3 * sin];
    let turn = (-0.3 * sin).asin();
    let end = [pin[0] + turn.cos(), 0.0];
    let pin_velocity = [-pin[1] * rate, pin[0] * rate];
    let rod_rate = -pin_velocity[1] / turn.cos();
    let speed = pin_velocity[0] - turn.sin() * rod_rate;

    let mut crank = rod("crank", 0.3, 1.0, [pin[0] / 2.0, pin[1] / 2.0], angle);
    (crank.velocity, crank.angular_velocity) = (pin_velocity.map(|v| v / 2.0), rate);
    let mut link = rod("rod", 1.0, 2.0, [f64::midpoint(pin[0], end[0]), pin[1] / 2.0], turn);
    link.velocity = [f64::midpoint(pin_velocity[0], speed), pin_velocity[1] / 2.0];
    link.angular_velocity = rod_rate;
    let mut slider = rod("slider", 1.0, 3.0, end, 0.0);
    slider.velocity = [speed, 0.0];
    let joints = vec![
        hinge("axle", WORLD, "crank", [0.0; 2]),
        hinge("big end", "crank", "rod", pin),
        hinge("small end", "rod", "slider", end),
        guide("slider"),
    ];
    let bodies = vec![crank, link, slider];
    SceneDef { name: "slider-crank".into(), bodies, joints, ..SceneDef::default() }
}

/// Holds height and angle of a body.
fn guide(body: &str) -> JointDef {
    let kind = JointKind::Lock { x: false, y: true, rotation: true };
    let bodies = [WORLD.into(), body.into()];
    JointDef { name: "guide".into(), bodies, kind, collide: false, softness: None }
}

/// V13 (b): level slender rod (1 m, 3 kg) held at its left end, and at its right end if `both`.
#[must_use]
pub fn supported_rod(both: bool) -> SceneDef {
    let bodies = vec![rod("rod", 1.0, 3.0, [0.5, 0.0], 0.0)];
    let mut joints = vec![hinge("left", WORLD, "rod", [0.0; 2])];
    joints.extend(both.then(|| hinge("right", WORLD, "rod", [1.0, 0.0])));
    SceneDef { name: "supported rod".into(), dt: 1e-6, bodies, joints, ..SceneDef::default() }
}

/// V13 (c): two equal level rods (1 m, 1 kg), hinged to each other and the first to the wall.
#[must_use]
pub fn level_pair() -> SceneDef {
    let bodies =
        vec![rod("inner", 1.0, 1.0, [0.5, 0.0], 0.0), rod("outer", 1.0, 1.0, [1.5, 0.0], 0.0)];
    let joints =
        vec![hinge("wall", WORLD, "inner", [0.0; 2]), hinge("elbow", "inner", "outer", [1.0, 0.0])];
    SceneDef { name: "two level rods".into(), dt: 1e-6, bodies, joints, ..SceneDef::default() }
}

/// V26: level slender rod (1 m, 1 kg) pinned at its left end and a `distance` beside it.
#[must_use]
pub fn clamped_rod(distance: f64) -> SceneDef {
    let bodies = vec![rod("rod", 1.0, 1.0, [0.5, 0.0], 0.0)];
    let joints = vec![
        hinge("pin", WORLD, "rod", [0.0; 2]),
        hinge("second pin", WORLD, "rod", [distance, 0.0]),
    ];
    SceneDef { name: "clamped rod".into(), bodies, joints, ..SceneDef::default() }
}
