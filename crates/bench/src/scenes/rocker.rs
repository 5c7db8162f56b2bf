//! Bodies that roll and rock.

use tangency_core::{BodyDef, ForceDef, SceneDef};

use super::bodies::{block, disc, fixed_block, floor, material};

/// V15 (a): spool of radius 0.3 (1 kg, 0.03 kg·m²) whose string, wound under a drum of 0.1, pulls
/// with 2 N at `angle` above the x axis; μ = 0.5.
#[must_use]
pub fn spool(angle: f64) -> SceneDef {
    let (sin, cos) = angle.sin_cos();
    let roller = BodyDef { mass: Some(1.0), inertia: Some(0.03), ..disc("spool", 0.3, [0.0, 0.3]) };
    let force = [2.0 * cos, 2.0 * sin];
    let pull = ForceDef { body: "spool".into(), force, torque: 0.2, ..ForceDef::default() };
    let (bodies, forces) = (vec![floor(), roller], vec![pull]);
    material(SceneDef { name: "spool".into(), bodies, forces, ..SceneDef::default() }, 0.5, 0.0)
}

/// V17 (a): box 0.2 × 0.6 of 1 kg, tilted by `tilt` about its lower left corner at the origin;
/// μ = 2.
#[must_use]
pub fn rocking_box(tilt: f64) -> SceneDef {
    let (sin, cos) = tilt.sin_cos();
    let center = [0.1 * cos - 0.3 * sin, 0.1 * sin + 0.3 * cos];
    let rocker = BodyDef { angle: tilt, mass: Some(1.0), ..block("box", [0.2, 0.6], center) };
    let bodies = vec![floor(), rocker];
    material(SceneDef { name: "rocking box".into(), bodies, ..SceneDef::default() }, 2.0, 0.0)
}

/// V17 (b): disc of radius 0.2 rolls at 1.5 m/s into a step of 0.05, 0.3 m ahead; μ = 2.
#[must_use]
pub fn curb() -> SceneDef {
    // It touches the corner when its centre is √(0.2² − 0.15²) before it.
    let before = (0.2_f64.powi(2) - 0.15_f64.powi(2)).sqrt();
    let roller = BodyDef {
        mass: Some(1.0),
        velocity: [1.5, 0.0],
        angular_velocity: -7.5,
        ..disc("disc", 0.2, [-before - 0.3, 0.2])
    };
    let bodies = vec![floor(), fixed_block("step", [4.0, 0.1], [2.0, 0.0]), roller];
    material(SceneDef { name: "disc at a step".into(), bodies, ..SceneDef::default() }, 2.0, 0.0)
}
