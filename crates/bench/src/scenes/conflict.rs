//! Scenes that no motion satisfies, or that begin where none should.

use tangency_core::{BodyDef, BodyKind, SceneDef};

use super::bodies::{block, disc, floor, plane, unit_scene};
use super::tight::misfit_hinges;

/// V30: rod of 1 m, pinned at its ends to two points 1.5 m apart.
#[must_use]
pub fn overstretched_rod() -> SceneDef {
    SceneDef { name: "overstretched rod".into(), ..misfit_hinges(0.5) }
}

/// V30: a piston presses a unit box into a wall at 1 m/s.
#[must_use]
pub fn press() -> SceneDef {
    let piston = BodyDef {
        kind: BodyKind::Kinematic,
        velocity: [1.0, 0.0],
        ..block("piston", [0.5, 0.5], [-0.75, 0.5])
    };
    let bodies =
        vec![floor(), plane("wall", [-1.0, 0.0], -0.5), block("box", [1.0; 2], [0.0, 0.5]), piston];
    SceneDef { name: "press".into(), bodies, ..SceneDef::default() }
}

/// V30: two unit boxes overlap by 0.1, without gravity.
#[must_use]
pub fn overlapping_boxes() -> SceneDef {
    let boxes = vec![block("left", [1.0; 2], [0.0; 2]), block("right", [1.0; 2], [0.9, 0.0])];
    unit_scene("overlapping boxes", boxes)
}

/// V30: two discs with one centre.
#[must_use]
pub fn coincident_discs() -> SceneDef {
    let discs = vec![disc("first", 0.2, [0.3, 0.4]), disc("second", 0.1, [0.3, 0.4])];
    unit_scene("coincident discs", discs)
}
