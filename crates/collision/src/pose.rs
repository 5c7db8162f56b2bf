//! Poses in the plane: a position and an angle.

use nalgebra::{Vector2, Vector3};

/// Position of a body's origin and its angle, (x, y, θ) in (m, m, rad).
pub type Pose = Vector3<f64>;

/// A pose with its sine and cosine, which cost more than all else that is done with them.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    pose: Pose,
    sin: f64,
    cos: f64,
}

impl Frame {
    /// The frame at a pose.
    #[inline]
    #[must_use]
    pub fn new(pose: &Pose) -> Self {
        let (sin, cos) = pose.z.sin_cos();
        Self { pose: *pose, sin, cos }
    }

    /// The frame at a pose, which is this one if the pose is the same to the last bit.
    #[inline]
    #[must_use]
    pub fn moved(&self, pose: &Pose) -> Self {
        if self.is_at(pose) { *self } else { Self::new(pose) }
    }

    /// Whether it is at this pose, to the last bit.
    #[inline]
    #[must_use]
    pub fn is_at(&self, pose: &Pose) -> bool {
        let same = |k: usize| self.pose[k].to_bits() == pose[k].to_bits();
        same(0) & same(1) & same(2)
    }

    /// The pose, (x, y, θ) in (m, m, rad).
    #[inline]
    #[must_use]
    pub fn pose(&self) -> &Pose {
        &self.pose
    }

    /// Position of the origin, m.
    #[inline]
    #[must_use]
    pub fn origin(&self) -> Vector2<f64> {
        self.pose.xy()
    }

    /// sin θ.
    #[inline]
    #[must_use]
    pub fn sin(&self) -> f64 {
        self.sin
    }

    /// cos θ.
    #[inline]
    #[must_use]
    pub fn cos(&self) -> f64 {
        self.cos
    }

    /// World position of a point of the body, p + R(θ) l, m.
    #[inline]
    #[must_use]
    pub fn point(&self, local: &Vector2<f64>) -> Vector2<f64> {
        self.origin() + self.direction(local)
    }

    /// World components of a vector of the body, R(θ) l.
    #[inline]
    #[must_use]
    pub fn direction(&self, local: &Vector2<f64>) -> Vector2<f64> {
        let (s, c) = (self.sin, self.cos);
        Vector2::new(c * local.x - s * local.y, s * local.x + c * local.y)
    }

    /// R(θ)ᵀ x.
    fn local_direction(&self, world: &Vector2<f64>) -> Vector2<f64> {
        Self { sin: -self.sin, ..*self }.direction(world)
    }
}

/// World position of a point of the body, x = p + R(θ) l, m.
#[must_use]
pub fn point(pose: &Pose, local: &Vector2<f64>) -> Vector2<f64> {
    Frame::new(pose).point(local)
}

/// World components of a vector of the body, R(θ) l.
#[must_use]
pub fn direction(pose: &Pose, local: &Vector2<f64>) -> Vector2<f64> {
    Frame::new(pose).direction(local)
}

/// Position in the body's frame of a point of the world, l = R(θ)ᵀ (x − p), m.
#[must_use]
pub fn local_point(pose: &Pose, world: &Vector2<f64>) -> Vector2<f64> {
    local_direction(pose, &(world - pose.xy()))
}

/// Components in the body's frame of a vector of the world, R(θ)ᵀ x.
#[must_use]
pub fn local_direction(pose: &Pose, world: &Vector2<f64>) -> Vector2<f64> {
    Frame::new(pose).local_direction(world)
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
