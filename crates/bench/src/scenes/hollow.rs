//! Discs between two slopes.

use std::f64::consts::FRAC_1_SQRT_2;

use tangency_core::{BodyDef, SceneDef};

use super::bodies::{disc, material, plane};

/// V18: disc (0.2 m, 1 kg) that spins at 20 rad/s in a groove of 90 degrees.
#[must_use]
pub fn groove(friction: f64) -> SceneDef {
    let spinner = BodyDef {
        mass: Some(1.0),
        angular_velocity: 20.0,
        ..disc("disc", 0.2, [0.0, 0.2 / FRAC_1_SQRT_2])
    };
    between(FRAC_1_SQRT_2, FRAC_1_SQRT_2, spinner, friction)
}

/// V26: disc (0.2 m, 1 kg) at rest between slopes of ±`slope` rad, without friction.
#[must_use]
pub fn shallow_hollow(slope: f64) -> SceneDef {
    let (sin, cos) = slope.sin_cos();
    let resting = BodyDef { mass: Some(1.0), ..disc("disc", 0.2, [0.0, 0.2 / cos]) };
    between(sin, cos, resting, 0.0)
}

/// Slopes through the origin with normals (±sin, cos).
fn between(sin: f64, cos: f64, body: BodyDef, friction: f64) -> SceneDef {
    let bodies = vec![plane("left", [sin, cos], 0.0), plane("right", [-sin, cos], 0.0), body];
    let def = SceneDef { name: "disc between slopes".into(), bodies, ..SceneDef::default() };
    material(def, friction, 0.0)
}
