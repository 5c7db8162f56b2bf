//! Bodies that strike or pass the floor.

use tangency_core::{BodyDef, SceneDef};

use super::bodies::{block, disc, floor, material, unit_scene};

/// V23: discs of radius 0.25 and 1 kg at these places, all moving down at 1 m/s; no friction.
#[must_use]
pub fn falling_discs(places: impl IntoIterator<Item = [f64; 2]>, restitution: f64) -> SceneDef {
    let ball = |(i, place): (usize, [f64; 2])| BodyDef {
        mass: Some(1.0),
        velocity: [0.0, -1.0],
        ..disc(&format!("disc{i}"), 0.25, place)
    };
    let balls = places.into_iter().enumerate().map(ball);
    let bodies = std::iter::once(floor()).chain(balls).collect();
    material(unit_scene("many impacts", bodies), 0.0, restitution)
}

/// V24: disc that passes over the floor at 5 m/s with a gap; μ = 0.5, e = 1.
#[must_use]
pub fn grazing_disc(gap: f64) -> SceneDef {
    let passing = BodyDef { velocity: [5.0, 0.0], ..disc("disc", 0.1, [0.0, 0.1 + gap]) };
    material(unit_scene("grazing", vec![floor(), passing]), 0.5, 1.0)
}

/// V24: unit box of 1 kg that slides at `speed`, μ = 0.5; a step takes 1/10 m/s of fall.
#[must_use]
pub fn unit_slider(speed: f64) -> SceneDef {
    let slider =
        BodyDef { mass: Some(1.0), velocity: [speed, 0.0], ..block("box", [1.0; 2], [0.0, 0.5]) };
    let (bodies, gravity) = (vec![floor(), slider], [0.0, -10.0]);
    let def = SceneDef { name: "unit slider".into(), gravity, bodies, ..SceneDef::default() };
    material(def, 0.5, 0.0)
}

/// V25 (b): box 1 × 0.1 of 1 kg at 40 degrees strikes the floor with its lowest corner; μ = 1.2,
/// e = 1.
#[must_use]
pub fn corner_landing() -> SceneDef {
    let angle = 40.0_f64.to_radians();
    let (sin, cos) = angle.sin_cos();
    let falling = BodyDef {
        angle,
        mass: Some(1.0),
        velocity: [-0.4, -2.3],
        angular_velocity: 10.0,
        ..block("box", [1.0, 0.1], [0.0, 0.5 * sin + 0.05 * cos])
    };
    material(unit_scene("corner landing", vec![floor(), falling]), 1.2, 1.0)
}
