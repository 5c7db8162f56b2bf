//! Rods that are hinged to each other.

use std::f64::consts::FRAC_PI_2;

use tangency_core::{BodyDef, SceneDef, WORLD};

use super::bodies::{hinge, rod};

/// Distance of neighbouring pins of [`parallelogram`], m.
const PITCH: f64 = 0.5;

/// A slender rod (1 m, 1 kg) that hangs from `pin`, turned by `angle` from hanging.
fn hanging_rod(name: &str, [x, y]: [f64; 2], angle: f64) -> BodyDef {
    let (sin, cos) = angle.sin_cos();
    rod(name, 1.0, 1.0, [x + 0.5 * sin, y - 0.5 * cos], angle - FRAC_PI_2)
}

/// V03: two slender rods (1 m, 1 kg), the upper one hinged to the origin, the lower one to its end;
/// both at `angles` from hanging, at rest.
#[must_use]
pub fn double_pendulum(angles: [f64; 2]) -> SceneDef {
    let (sin, cos) = angles[0].sin_cos();
    let elbow = [sin, -cos];
    let bodies =
        vec![hanging_rod("upper", [0.0; 2], angles[0]), hanging_rod("lower", elbow, angles[1])];
    let joints =
        vec![hinge("pin", WORLD, "upper", [0.0; 2]), hinge("elbow", "upper", "lower", elbow)];
    SceneDef { name: "double pendulum".into(), bodies, joints, ..SceneDef::default() }
}

/// V12: `n` ≥ 2 slender cranks (1 m, 1 kg) pinned side by side, their lower ends on one coupler
/// (1 kg), `angle` from hanging, at rest. The coupler is the last body.
///
/// ```text
///   o───o───o      pins of the world
///    \   \   \     cranks
///     o═══o═══o    coupler, which only translates
/// ```
#[must_use]
pub fn parallelogram(n: usize, angle: f64) -> SceneDef {
    let (sin, cos) = angle.sin_cos();
    let crank = |i: usize| format!("crank{i}");
    let pin = |i: usize| [i as f64 * PITCH, 0.0];
    let width = (n - 1) as f64 * PITCH;
    let coupler = rod("coupler", width, 1.0, [0.5 * width + sin, -cos], 0.0);
    let cranks = (0..n).map(|i| hanging_rod(&crank(i), pin(i), angle));
    let joints = (0..n).flat_map(|i| {
        let end = [pin(i)[0] + sin, -cos];
        let upper = hinge(&format!("pin{i}"), WORLD, &crank(i), pin(i));
        [upper, hinge(&format!("end{i}"), &crank(i), "coupler", end)]
    });
    SceneDef {
        name: "parallelogram".into(),
        bodies: cranks.chain([coupler]).collect(),
        joints: joints.collect(),
        ..SceneDef::default()
    }
}
