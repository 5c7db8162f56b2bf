//! Scenes of bodies that fly, slide, roll, stand and collide.

use tangency_core::{BodyDef, SceneDef, Shape};

use super::bodies::{block, disc, floor, material, plane, slender_inertia, unit_scene};

/// V01: a block in free flight with spin.
#[must_use]
pub fn free_flight() -> SceneDef {
    let flyer = BodyDef {
        mass: Some(2.0),
        angle: 0.2,
        velocity: [3.0, 4.0],
        angular_velocity: -7.0,
        ..block("flyer", [0.4, 0.2], [0.0, 1.0])
    };
    SceneDef { name: "free flight".into(), bodies: vec![flyer], ..SceneDef::default() }
}

/// V05: block 0.4 × 0.2 flat on a slope through the origin, at `speed` up the slope.
#[must_use]
pub fn incline_block(angle: f64, friction: f64, speed: f64) -> SceneDef {
    let (sin, cos) = angle.sin_cos();
    let slider = BodyDef {
        angle,
        mass: Some(1.0),
        velocity: [speed * cos, speed * sin],
        ..block("block", [0.4, 0.2], [-0.1 * sin, 0.1 * cos])
    };
    let bodies = vec![plane("slope", [-sin, cos], 0.0), slider];
    let def = SceneDef { name: "block on a slope".into(), bodies, ..SceneDef::default() };
    material(def, friction, 0.0)
}

/// V06: disc of radius 0.25 on a slope of 20 degrees, at rest.
#[must_use]
pub fn incline_disc(friction: f64) -> SceneDef {
    let (sin, cos) = 20.0_f64.to_radians().sin_cos();
    let roller = BodyDef { mass: Some(1.0), ..disc("disc", 0.25, [-0.25 * sin, 0.25 * cos]) };
    let bodies = vec![plane("slope", [-sin, cos], 0.0), roller];
    let def = SceneDef { name: "disc on a slope".into(), bodies, ..SceneDef::default() };
    material(def, friction, 0.0)
}

/// V07: disc of radius 0.25 set down at 4 m/s without spin, μ = 0.25.
#[must_use]
pub fn sliding_disc() -> SceneDef {
    let slider =
        BodyDef { mass: Some(1.0), velocity: [4.0, 0.0], ..disc("disc", 0.25, [0.0, 0.25]) };
    let bodies = vec![floor(), slider];
    let def = SceneDef { name: "sliding to rolling".into(), bodies, ..SceneDef::default() };
    material(def, 0.25, 0.0)
}

/// V35: block 0.4 × 0.2 of a mass on the floor, at a speed along it.
#[must_use]
pub fn sliding_box(mass: f64, friction: f64, speed: f64) -> SceneDef {
    let slider = BodyDef {
        mass: Some(mass),
        velocity: [speed, 0.0],
        ..block("block", [0.4, 0.2], [0.0, 0.1])
    };
    let bodies = vec![floor(), slider];
    let def = SceneDef { name: "sliding block".into(), bodies, ..SceneDef::default() };
    material(def, friction, 0.0)
}

/// V04: disc of radius 0.1 that falls from `height` above the floor and bounces with e.
#[must_use]
pub fn falling_disc(height: f64, restitution: f64) -> SceneDef {
    let ball = BodyDef { mass: Some(1.0), ..disc("ball", 0.1, [0.0, 0.1 + height]) };
    let bodies = vec![floor(), ball];
    let def = SceneDef { name: "falling disc".into(), bodies, ..SceneDef::default() };
    material(def, 0.0, restitution)
}

/// V09 (a): masses 2 and 3 touch on a line at 4 and −1 m/s, e = 1/2.
#[must_use]
pub fn line_collision() -> SceneDef {
    let first =
        BodyDef { mass: Some(2.0), velocity: [4.0, 0.0], ..disc("first", 0.5, [-0.5, 0.0]) };
    let second =
        BodyDef { mass: Some(3.0), velocity: [-1.0, 0.0], ..disc("second", 0.5, [0.5, 0.0]) };
    material(unit_scene("collision on a line", vec![first, second]), 0.0, 0.5)
}

/// V09 (b), V24: equal discs of radius 0.1, one passes the other's centre at `offset`, e = 1.
/// `start` is the first one's x.
#[must_use]
pub fn oblique_collision(start: f64, other: [f64; 2]) -> SceneDef {
    let first =
        BodyDef { mass: Some(1.0), velocity: [2.0, 0.0], ..disc("first", 0.1, [start, 0.0]) };
    let second = BodyDef { mass: Some(1.0), ..disc("other", 0.1, other) };
    material(unit_scene("oblique collision", vec![first, second]), 0.0, 1.0)
}

/// V09 (c): spinning disc strikes the floor at v = (3, −4), w = 10, e = 0.6.
#[must_use]
pub fn spinning_disc(friction: f64) -> SceneDef {
    let ball = BodyDef {
        mass: Some(1.0),
        velocity: [3.0, -4.0],
        angular_velocity: 10.0,
        ..disc("disc", 0.1, [0.0, 0.1])
    };
    material(unit_scene("spinning disc on the floor", vec![floor(), ball]), friction, 0.6)
}

/// V09 (d): slender rod (1 m, 2 kg) struck at right angles, 0.4 m from its centre, e = 0.7.
#[must_use]
pub fn rod_hit() -> SceneDef {
    let rod = BodyDef {
        mass: Some(2.0),
        inertia: Some(slender_inertia(2.0, 1.0)),
        ..block("rod", [1.0, 0.01], [0.0; 2])
    };
    let ball =
        BodyDef { mass: Some(0.5), velocity: [0.0, -3.0], ..disc("disc", 0.1, [0.4, 0.105]) };
    material(unit_scene("rod struck by a disc", vec![rod, ball]), 0.0, 0.7)
}

/// V09 (e): spinning disc strikes one at rest head-on, e = 0.5. The line of centres is upright.
#[must_use]
pub fn head_on(friction: f64) -> SceneDef {
    let first = BodyDef {
        mass: Some(1.0),
        velocity: [2.0, 0.0],
        angular_velocity: 30.0,
        ..disc("first", 0.1, [-0.1, 0.0])
    };
    let second = BodyDef { mass: Some(2.0), ..disc("second", 0.15, [0.15, 0.0]) };
    material(unit_scene("spinning discs head-on", vec![first, second]), friction, 0.5)
}

/// V14: box 0.2 × 0.5 at rest on a slope of `degrees`: the floor stays level and gravity leans, so
/// that the gaps are zero to the last bit and one step of 1e-6 s tells the acceleration.
#[must_use]
pub fn tipping_box(degrees: f64, friction: f64) -> SceneDef {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let standing = BodyDef { mass: Some(1.0), ..block("box", [0.2, 0.5], [0.0, 0.25]) };
    let bodies = vec![floor(), standing];
    let gravity = [9.81 * sin, -9.81 * cos];
    let name = "tip or slide".into();
    material(SceneDef { name, gravity, dt: 1e-6, bodies, ..SceneDef::default() }, friction, 0.0)
}

/// V19: unit boxes of these masses upon each other, the first on the floor; μ = 0.5.
#[must_use]
pub fn stack(masses: &[f64]) -> SceneDef {
    let layer = |(i, mass): (usize, &f64)| BodyDef {
        mass: Some(*mass),
        ..block(&format!("box{i}"), [1.0, 1.0], [0.0, 0.5 + i as f64])
    };
    let bodies = std::iter::once(floor()).chain(masses.iter().enumerate().map(layer)).collect();
    let def = SceneDef { name: "stack".into(), bodies, ..SceneDef::default() };
    material(def, 0.5, 0.0)
}

/// V22 (a): unit box of 1 kg slides at 3 m/s, μ = 0.3, on `k` ≥ 2 collinear contact points: its two
/// corners and studs flush with its underside (and with its top, so that the centre of mass stays).
#[must_use]
pub fn redundant_floor(k: usize) -> SceneDef {
    let studs = k - 2;
    let radius = 0.125_f64.min(0.25 / k as f64);
    let mut shapes =
        vec![Shape::Rectangle { width: 1.0, height: 1.0, center: [0.0; 2], angle: 0.0 }];
    for i in 1..=studs {
        let x = i as f64 / (studs + 1) as f64 - 0.5;
        shapes.push(Shape::Circle { radius, center: [x, radius - 0.5] });
        shapes.push(Shape::Circle { radius, center: [x, 0.5 - radius] });
    }
    let slider = BodyDef {
        name: "box".into(),
        position: [0.0, 0.5],
        velocity: [3.0, 0.0],
        mass: Some(1.0),
        inertia: Some(1.0 / 6.0),
        shapes,
        ..BodyDef::default()
    };
    let bodies = vec![floor(), slider];
    let def = SceneDef { name: "box on many points".into(), bodies, ..SceneDef::default() };
    material(def, 0.3, 0.0)
}

/// V08: `n` discs of radius 0.1 in a row, `gap` apart; the first arrives at 1 m/s from `start` away.
#[must_use]
pub fn cradle(n: usize, gap: f64, start: f64, restitution: f64) -> SceneDef {
    let ball = |i: usize| BodyDef {
        mass: Some(1.0),
        velocity: [if i == 0 { 1.0 } else { 0.0 }, 0.0],
        ..disc(
            &format!("ball{i}"),
            0.1,
            [if i == 0 { -start } else { (i - 1) as f64 * (0.2 + gap) + 0.2 }, 0.0],
        )
    };
    material(unit_scene("cradle", (0..n).map(ball).collect()), 0.0, restitution)
}
