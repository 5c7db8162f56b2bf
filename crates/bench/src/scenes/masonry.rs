//! Blocks that stand by their weight and friction.

use std::f64::consts::PI;

use tangency_core::{BodyDef, SceneDef, Shape};

use super::bodies::{block, floor, hinge, material};

/// V20: pyramid of unit boxes of 1 kg with `base` boxes in the lowest row, a tenth of a metre
/// between neighbours; μ = 0.5. Rows from below, each from the left.
#[must_use]
pub fn pyramid(base: usize) -> SceneDef {
    let mut bodies = vec![floor()];
    for row in 0..base {
        let count = base - row;
        for i in 0..count {
            let x = 1.1 * (i as f64 - (count - 1) as f64 / 2.0);
            let name = format!("box{row}_{i}");
            bodies
                .push(BodyDef { mass: Some(1.0), ..block(&name, [1.0; 2], [x, 0.5 + row as f64]) });
        }
    }
    let def = SceneDef { name: "pyramid of unit boxes".into(), bodies, ..SceneDef::default() };
    material(def, 0.5, 0.0)
}

/// V21 (a): two boxes 1 × 0.05 lean against each other, hinged at the middle of their top faces,
/// their axes 30 degrees to either side of the vertical, on their inner lower corners.
#[must_use]
pub fn gable(friction: f64) -> SceneDef {
    let (sin, cos) = (PI / 6.0).sin_cos();
    let height = cos + 0.025 * sin;
    let leg = |name: &str, side: f64| BodyDef {
        angle: side * PI / 6.0,
        mass: Some(1.0),
        ..block(name, [0.05, 1.0], [side * 0.5 * sin, height - 0.5 * cos])
    };
    let bodies = vec![floor(), leg("left", -1.0), leg("right", 1.0)];
    let joints = vec![hinge("ridge", "left", "right", [0.0, height])];
    material(
        SceneDef { name: "gable".into(), bodies, joints, ..SceneDef::default() },
        friction,
        0.0,
    )
}

/// V21 (b): half a ring of seven equal quadrilateral blocks of density 1 on the floor. Their corners
/// lie on the joints' rays at 1 ± `thickness`/2 from the origin.
#[must_use]
pub fn arch(thickness: f64, friction: f64) -> SceneDef {
    let at = |joint: u32, r: f64| {
        let angle = PI * f64::from(joint) / 7.0;
        // The springings lie on the floor to the last bit.
        let height = if joint.is_multiple_of(7) { 0.0 } else { r * angle.sin() };
        [r * angle.cos(), height]
    };
    let (inner, outer) = (1.0 - thickness / 2.0, 1.0 + thickness / 2.0);
    let voussoir = |i: u32| BodyDef {
        name: format!("block{i}"),
        density: Some(1.0),
        shapes: vec![Shape::Polygon {
            points: vec![at(i, inner), at(i, outer), at(i + 1, outer), at(i + 1, inner)],
        }],
        ..BodyDef::default()
    };
    let bodies = std::iter::once(floor()).chain((0..7).map(voussoir)).collect();
    material(SceneDef { name: "arch".into(), bodies, ..SceneDef::default() }, friction, 0.0)
}
