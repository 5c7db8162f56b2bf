//! Bodies and joints in one line each.

use tangency_core::{BodyDef, BodyKind, JointDef, JointKind, Limits, SceneDef, Shape};

/// A disc with the scene's frame, of density 1 unless its mass is set.
#[must_use]
pub fn disc(name: &str, radius: f64, position: [f64; 2]) -> BodyDef {
    let shapes = vec![Shape::Circle { radius, center: [0.0; 2] }];
    BodyDef { name: name.into(), position, shapes, ..BodyDef::default() }
}

/// A block of width × height, m.
#[must_use]
pub fn block(name: &str, [width, height]: [f64; 2], position: [f64; 2]) -> BodyDef {
    let shapes = vec![Shape::Rectangle { width, height, center: [0.0; 2], angle: 0.0 }];
    BodyDef { name: name.into(), position, shapes, ..BodyDef::default() }
}

/// A block that never moves.
#[must_use]
pub fn fixed_block(name: &str, size: [f64; 2], position: [f64; 2]) -> BodyDef {
    BodyDef { kind: BodyKind::Static, ..block(name, size, position) }
}

/// A slender rod without a shape, its centre at `center`, along its own x axis.
#[must_use]
pub fn rod(name: &str, length: f64, mass: f64, center: [f64; 2], angle: f64) -> BodyDef {
    BodyDef {
        name: name.into(),
        position: center,
        angle,
        mass: Some(mass),
        inertia: Some(slender_inertia(mass, length)),
        ..BodyDef::default()
    }
}

/// m L²/12, kg·m².
#[must_use]
pub fn slender_inertia(mass: f64, length: f64) -> f64 {
    mass * length * length / 12.0
}

/// The half plane y ≤ 0.
#[must_use]
pub fn floor() -> BodyDef {
    plane("floor", [0.0, 1.0], 0.0)
}

/// The half plane n·x ≤ offset.
#[must_use]
pub fn plane(name: &str, normal: [f64; 2], offset: f64) -> BodyDef {
    let shapes = vec![Shape::HalfPlane { normal, offset }];
    BodyDef { name: name.into(), kind: BodyKind::Static, shapes, ..BodyDef::default() }
}

/// A hinge at a point of the world; `a` may be [`tangency_core::WORLD`].
#[must_use]
pub fn hinge(name: &str, a: &str, b: &str, anchor: [f64; 2]) -> JointDef {
    let (limits, motor) = (Limits::default(), None);
    let kind = JointKind::Revolute { anchor, anchor_b: None, limits, motor };
    let bodies = [a.into(), b.into()];
    JointDef { name: name.into(), bodies, kind, collide: false, softness: None }
}

/// A scene of these bodies without gravity.
#[must_use]
pub fn unit_scene(name: &str, bodies: Vec<BodyDef>) -> SceneDef {
    SceneDef { name: name.into(), gravity: [0.0; 2], bodies, ..SceneDef::default() }
}

/// Gives every body the same friction and restitution, so that no mixing rule matters.
#[must_use]
pub fn material(mut def: SceneDef, friction: f64, restitution: f64) -> SceneDef {
    for body in &mut def.bodies {
        (body.friction, body.restitution) = (friction, restitution);
    }
    def
}

/// What a scene's bodies stand on, its first one, and so many copies of all others, `apart` metres from each
/// other along x.
#[must_use]
pub fn copies(def: &SceneDef, count: usize, apart: f64) -> SceneDef {
    let mut all = SceneDef { bodies: def.bodies[..1].to_vec(), ..def.clone() };
    for k in 0..count {
        all.bodies.extend(def.bodies[1..].iter().map(|body| BodyDef {
            name: format!("{} {k}", body.name),
            position: [body.position[0] + apart * k as f64, body.position[1]],
            ..body.clone()
        }));
    }
    all
}
