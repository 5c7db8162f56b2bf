//! Bodies that move far within one step.

use tangency_core::{BodyDef, SceneDef};

use super::bodies::{disc, fixed_block, floor, material};

/// V28: disc of radius 0.01 at 1000 m/s, 5 m before the face of a wall 0.01 m thick; e = 0.5.
#[must_use]
pub fn bullet() -> SceneDef {
    let wall = fixed_block("wall", [0.01, 2.0], [5.005, 0.0]);
    let bullet =
        BodyDef { mass: Some(1.0), velocity: [1000.0, 0.0], ..disc("bullet", 0.01, [0.0; 2]) };
    let bodies = vec![wall, bullet];
    let def = SceneDef { name: "bullet".into(), dt: 1.0 / 60.0, bodies, ..SceneDef::default() };
    material(def, 0.0, 0.5)
}

/// V28: disc of radius 0.1 set down without speed at 10⁴ rad/s, μ = 0.5; it drives off to the right.
#[must_use]
pub fn spin_up() -> SceneDef {
    let spinner =
        BodyDef { mass: Some(1.0), angular_velocity: -1e4, ..disc("disc", 0.1, [0.0, 0.1]) };
    let bodies = vec![floor(), spinner];
    let def = SceneDef { name: "spinning disc set down".into(), bodies, ..SceneDef::default() };
    material(def, 0.5, 0.0)
}
