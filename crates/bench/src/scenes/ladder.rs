//! A rod that slides down between wall and floor.

use tangency_core::{BodyDef, SceneDef, Shape};

use super::bodies::{material, plane, rod};

/// Half the ladder's length, m.
const HALF: f64 = 1.0;
/// Radius of the discs at the ladder's ends, m.
const END: f64 = 0.05;

/// V11: slender ladder (2 m, 1 kg) at `angle` to the floor, against a wall, without friction, at
/// rest.
///
/// Its ends are the centres of small discs, and floor and wall lie back by their radius, so that
/// the centres keep to y ≥ 0 and x ≥ 0 exactly. Without friction the discs change nothing else.
#[must_use]
pub fn ladder(angle: f64) -> SceneDef {
    let (sin, cos) = angle.sin_cos();
    // Along its own x axis from the upper end at the wall to the lower one.
    let body = rod("ladder", 2.0 * HALF, 1.0, [HALF * cos, HALF * sin], -angle);
    let end = |x: f64| Shape::Circle { radius: END, center: [x, 0.0] };
    let body = BodyDef { shapes: vec![end(-HALF), end(HALF)], ..body };
    let bodies = vec![plane("floor", [0.0, 1.0], -END), plane("wall", [1.0, 0.0], -END), body];
    let def = SceneDef { name: "sliding ladder".into(), bodies, ..SceneDef::default() };
    material(def, 0.0, 0.0)
}
