//! Poses in the plane: a position and an angle.

use nalgebra::{Vector2, Vector3};

/// Position of a body's origin and its angle, (x, y, θ) in (m, m, rad).
pub type Pose = Vector3<f64>;

/// World position of a point of the body, x = p + R(θ) l, m.
#[must_use]
pub fn point(pose: &Pose, local: &Vector2<f64>) -> Vector2<f64> {
    pose.xy() + direction(pose, local)
}

/// World components of a vector of the body, R(θ) l.
#[must_use]
pub fn direction(pose: &Pose, local: &Vector2<f64>) -> Vector2<f64> {
    rotate(pose.z, local)
}

/// Position in the body's frame of a point of the world, l = R(θ)ᵀ (x − p), m.
#[must_use]
pub fn local_point(pose: &Pose, world: &Vector2<f64>) -> Vector2<f64> {
    local_direction(pose, &(world - pose.xy()))
}

/// Components in the body's frame of a vector of the world, R(θ)ᵀ x.
#[must_use]
pub fn local_direction(pose: &Pose, world: &Vector2<f64>) -> Vector2<f64> {
    rotate(-pose.z, world)
}

/// The vector turned by a quarter counter-clockwise, (−y, x).
///
/// It is also the derivative of R(θ) l with respect to θ, given R(θ) l.
#[must_use]
pub fn perp(v: &Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-v.y, v.x)
}

/// The pose of something whose pose relative to `parent` is `child`.
#[must_use]
pub fn compose(parent: &Pose, child: &Pose) -> Pose {
    let p = point(parent, &child.xy());
    Pose::new(p.x, p.y, parent.z + child.z)
}

fn rotate(angle: f64, v: &Vector2<f64>) -> Vector2<f64> {
    let (s, c) = angle.sin_cos();
    Vector2::new(c * v.x - s * v.y, s * v.x + c * v.y)
}
