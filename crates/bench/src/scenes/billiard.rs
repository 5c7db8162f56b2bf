//! A disc between four walls.

use tangency_core::{BodyDef, SceneDef};

use super::bodies::{disc, material, plane, unit_scene};

/// V10: disc of radius 0.05 and 1 kg in the box 0 … 2 × 0 … 1, without gravity or friction, e = 1.
/// The disc is the last body; left and right wall come before floor and ceiling.
#[must_use]
pub fn billiard(position: [f64; 2], velocity: [f64; 2]) -> SceneDef {
    let ball = BodyDef { mass: Some(1.0), velocity, ..disc("ball", 0.05, position) };
    let bodies = vec![
        plane("left", [1.0, 0.0], 0.0),
        plane("right", [-1.0, 0.0], -2.0),
        plane("bottom", [0.0, 1.0], 0.0),
        plane("top", [0.0, -1.0], -1.0),
        ball,
    ];
    material(unit_scene("billiard", bodies), 0.0, 1.0)
}
