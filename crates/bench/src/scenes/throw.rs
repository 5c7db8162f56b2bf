//! A throw over a wall.

use tangency_core::{BodyDef, SceneDef, Stepping};

use super::bodies::{disc, fixed_block, floor, material, plane};

/// A ball of radius 0.12 m at (0, 1.8), a wall of 2 m at x = 3.3 and a board at x = 4; between them a
/// basket, its bottom at 0.6 m. Restitution 0.8, no friction.
#[must_use]
pub fn basket() -> SceneDef {
    let ball = BodyDef { mass: Some(0.6), velocity: [3.6, 5.6], ..disc("ball", 0.12, [0.0, 1.8]) };
    let bodies = vec![
        floor(),
        plane("board", [-1.0, 0.0], -4.0),
        fixed_block("wall", [0.04, 2.0], [3.3, 1.0]),
        fixed_block("bottom", [0.64, 0.1], [3.66, 0.55]),
        ball,
    ];
    let stepping = Stepping::ImpactResolved { max_impacts: 8 };
    let (name, dt) = ("basket".into(), 0.01);
    material(SceneDef { name, dt, stepping, bodies, ..SceneDef::default() }, 0.0, 0.8)
}
