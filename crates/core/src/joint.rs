//! Joints, motors, limits and springs as a person describes them.

use serde::{Deserialize, Serialize};

/// Names the immovable world in [`JointDef::bodies`].
pub const WORLD: &str = "world";

/// A joint between two bodies, or a body and the world.
///
/// Anchors are points of the world at the scene's initial poses; each body keeps its own copy in
/// its own frame, so that drift is seen. Bodies that share a joint do not collide unless
/// `collide` says so.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointDef {
    /// Unique name.
    pub name: String,
    /// Bodies a and b; `"world"` stands for the immovable world.
    pub bodies: [String; 2],
    /// What it holds.
    pub kind: JointKind,
    /// Whether its two bodies may touch each other.
    #[serde(default)]
    pub collide: bool,
    /// Makes the joint's rows springs and dampers instead of rigid.
    #[serde(default)]
    pub softness: Option<Softness>,
}

/// What a joint holds, and along which coordinate it is free.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum JointKind {
    /// Two points coincide; free: the relative angle θ_b − θ_a, counted from the start.
    Revolute {
        /// World point at the start, m.
        anchor: [f64; 2],
        /// World point on b at the start, m, where it differs from `anchor`.
        #[serde(default)]
        anchor_b: Option<[f64; 2]>,
        /// Limits of the free angle, rad.
        #[serde(default)]
        limits: Limits,
        /// Motor on the free angle: rad/s, N·m.
        #[serde(default)]
        motor: Option<Motor>,
    },
    /// Two frames coincide: nothing is free.
    Weld {
        /// World point at the start, m.
        anchor: [f64; 2],
    },
    /// b slides along an axis of a without turning; free: the travel from the start, m.
    Prismatic {
        /// World point at the start, m.
        anchor: [f64; 2],
        /// World direction at the start, any length; fixed in a.
        axis: [f64; 2],
        /// Limits of the travel, m.
        #[serde(default)]
        limits: Limits,
        /// Motor on the travel: m/s, N.
        #[serde(default)]
        motor: Option<Motor>,
    },
    /// Two points keep their distance (a massless rod).
    Distance {
        /// World point on a at the start, m.
        anchor_a: [f64; 2],
        /// World point on b at the start, m.
        anchor_b: [f64; 2],
        /// Length, m; the distance at the start if not given.
        #[serde(default)]
        length: Option<f64>,
    },
    /// A point of b slides along an axis of a and may turn; free: the travel from the start, m.
    Slot {
        /// World point at the start, m.
        anchor: [f64; 2],
        /// World direction at the start, any length; fixed in a.
        axis: [f64; 2],
        /// Limits of the travel, m.
        #[serde(default)]
        limits: Limits,
        /// Motor on the travel: m/s, N.
        #[serde(default)]
        motor: Option<Motor>,
    },
    /// Coordinates of b's centre of mass relative to the world stay as at the start.
    Lock {
        /// Holds x.
        #[serde(default)]
        x: bool,
        /// Holds y.
        #[serde(default)]
        y: bool,
        /// Holds the angle.
        #[serde(default)]
        rotation: bool,
    },
    /// A spring and damper between two points, integrated implicitly.
    Spring {
        /// World point on a at the start, m.
        anchor_a: [f64; 2],
        /// World point on b at the start, m.
        anchor_b: [f64; 2],
        /// Length without force, m; the distance at the start if not given.
        #[serde(default)]
        length: Option<f64>,
        /// Stiffness, N/m.
        stiffness: f64,
        /// Damping, N·s/m.
        #[serde(default)]
        damping: f64,
    },
}

/// Limits of a joint's free coordinate, rad or m from its value at the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Limits {
    /// Least value.
    pub lower: Option<f64>,
    /// Greatest value.
    pub upper: Option<f64>,
}

/// A motor drives a joint's free coordinate at a speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Motor {
    /// Target speed, rad/s or m/s.
    pub speed: f64,
    /// Greatest torque (N·m) or force (N); without bound if not given.
    #[serde(default)]
    pub max: Option<f64>,
}

/// Stiffness and damping of a soft joint (compliance is 1/stiffness).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Softness {
    /// Stiffness, N/m for rows that hold points, N·m/rad for rows that hold angles.
    pub stiffness: f64,
    /// Damping, N·s/m or N·m·s/rad.
    #[serde(default)]
    pub damping: f64,
}
