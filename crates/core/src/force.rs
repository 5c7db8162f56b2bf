//! Forces in time, and controls.

use serde::{Deserialize, Serialize};

/// A constant wrench on a body, possibly within a window of time.
///
/// A step that lies partly in the window feels the force for that part: the impulse is exact.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ForceDef {
    /// The body it acts on.
    pub body: String,
    /// Force at the centre of mass, N, in the world's frame.
    pub force: [f64; 2],
    /// Torque, N·m.
    pub torque: f64,
    /// Begins at this time, s; from the start if not given.
    pub start: Option<f64>,
    /// Ends at this time, s; never if not given.
    pub end: Option<f64>,
}

/// One scalar input per step: a channel of the control array.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControlDef {
    /// Unique name.
    pub name: String,
    /// What the number does.
    pub input: ControlInput,
}

/// What a control channel drives.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ControlInput {
    /// Force along x at the body's centre of mass, N.
    ForceX {
        /// The body.
        body: String,
    },
    /// Force along y at the body's centre of mass, N.
    ForceY {
        /// The body.
        body: String,
    },
    /// Torque on the body, N·m.
    Torque {
        /// The body.
        body: String,
    },
    /// Adds to the motor's target speed, rad/s or m/s.
    MotorSpeed {
        /// The joint; it must have a motor.
        joint: String,
    },
    /// Force (N) or torque (N·m) along the joint's free coordinate, on b against a.
    JointForce {
        /// The joint; it must have a free coordinate.
        joint: String,
    },
}
