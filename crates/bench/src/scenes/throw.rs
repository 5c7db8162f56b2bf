//! Throws over a wall.

use tangency_core::{BodyDef, JointDef, JointKind, SceneDef, Stepping, WORLD};

use super::bodies::{block, disc, fixed_block, floor, material, plane};

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

/// A ball is to fly over a wall and push a plate, which slides on a level rail behind it, half a metre
/// further within 1.2 s. As it is thrown it comes down between the two and misses the plate by 0.15 m.
#[must_use]
pub fn hidden_plate() -> SceneDef {
    let ball = BodyDef { mass: Some(1.0), velocity: [1.8, 4.5], ..disc("ball", 0.1, [0.0; 2]) };
    let plate = BodyDef { mass: Some(1.0), ..block("plate", [0.2, 0.4], [2.0, 0.0]) };
    let bodies = vec![fixed_block("wall", [0.1, 2.0], [1.0, -0.5]), ball, plate];
    let kind = JointKind::Lock { x: false, y: true, rotation: true };
    let ends = [WORLD.into(), "plate".into()];
    let rail = JointDef { name: "rail".into(), bodies: ends, kind, collide: true, softness: None };
    let (name, dt, joints) = ("hidden plate".into(), 5e-3, vec![rail]);
    let def = SceneDef { name, dt, contact_reach: 1.0, bodies, joints, ..SceneDef::default() };
    material(def, 0.0, 0.0)
}
