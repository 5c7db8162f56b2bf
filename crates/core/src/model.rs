//! The parts of a scene as the engine computes with them: indices and numbers, no names to resolve.

use nalgebra::{Vector2, Vector3};

use crate::measure::Measure;
use crate::{BodyKind, Limits, Motor, Softness};

/// A body as the engine sees it.
#[derive(Clone, Debug)]
pub struct Body {
    /// Name.
    pub name: String,
    /// How it moves.
    pub kind: BodyKind,
    /// Diagonal of the mass matrix, (kg, kg, kg·m²); of dynamic bodies positive.
    pub mass: Vector3<f64>,
    /// Area of the shapes, m², where the mass came from a density or the inertia from the shapes.
    pub area: f64,
    /// Whether inertia follows from mass and shapes, so that it scales with the mass.
    pub inertia_follows_mass: bool,
    /// Friction coefficient.
    pub friction: f64,
    /// Restitution.
    pub restitution: f64,
    /// Factor on gravity.
    pub gravity_scale: f64,
    /// Tags.
    pub groups: Vec<String>,
    pub(crate) category: u32,
    pub(crate) mask: u32,
}

/// A scalar that a joint holds at a reference value, or leaves free.
#[derive(Clone, Copy, Debug)]
pub struct JointRow {
    /// Which scalar of the two poses.
    pub measure: Measure,
    /// The value that counts as zero, m or rad.
    pub reference: f64,
}

/// A joint as the engine sees it.
#[derive(Clone, Debug)]
pub struct Joint {
    /// Name.
    pub name: String,
    /// Bodies a and b; `None` is the world.
    pub bodies: [Option<usize>; 2],
    /// Anchors in the bodies' centre-of-mass frames (world coordinates for the world), m.
    pub anchors: [Vector2<f64>; 2],
    /// What it holds.
    pub held: Vec<JointRow>,
    /// What it leaves free, where limits, motors and joint forces act.
    pub free: Option<JointRow>,
    /// Limits of the free coordinate.
    pub limits: Limits,
    /// Motor on the free coordinate.
    pub motor: Option<Motor>,
    /// Stiffness and damping of the held rows; rigid if absent.
    pub softness: Option<Softness>,
    /// The bodies whose velocities are unknowns; [`NO_BODY`](tangency_lcp::NO_BODY) for the others.
    pub(crate) unknowns: [u32; 2],
    /// Whether a body moves it as it was told.
    pub(crate) driven: bool,
}

/// A wrench within a window of time.
#[derive(Clone, Copy, Debug)]
pub struct Force {
    /// The body.
    pub body: usize,
    /// (N, N, N·m).
    pub wrench: Vector3<f64>,
    /// From, s.
    pub start: f64,
    /// To, s.
    pub end: f64,
}

/// What a control channel drives, by index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// A component (0: N, 1: N, 2: N·m) of the wrench on a body.
    Wrench {
        /// The body.
        body: usize,
        /// The component.
        component: usize,
    },
    /// Adds to a motor's target speed.
    MotorSpeed {
        /// The joint.
        joint: usize,
    },
    /// Force or torque along a joint's free coordinate.
    JointForce {
        /// The joint.
        joint: usize,
    },
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    /// Lower index first.
    pub(crate) bodies: [usize; 2],
    pub(crate) collide: Option<bool>,
    pub(crate) friction: Option<f64>,
    pub(crate) restitution: Option<f64>,
}
