//! Derivatives of the assembly of an island: from the problem's entries to what they came from.
//!
//! ```text
//!  s = J·v⁻,  b = rhs(φ, s, …) − Σ_driven J·v          driven: sides without unknowns
//!  s̄ = b̄ ∂b/∂s,   φ̄ = b̄ ∂b/∂φ,   J̄ += s̄ v (− b̄ v on driven sides),   v̄ += s̄ J (− b̄ J)
//! ```

mod pull;
mod push;
mod response;
mod slope;

use tangency_core::row::RowSource;
use tangency_core::{Control, JointRow, Scene};

pub(crate) use pull::{gap_vjp, speed_vjp, vjp};
pub(crate) use push::{gap_jvp, jvp, speed_jvp};
pub(crate) use response::Response;

/// The joint row behind a source, and the sign with which it enters.
#[inline]
fn joint_row_of(scene: &Scene, source: RowSource) -> (u32, &JointRow, f64) {
    let of = |joint: u32| &scene.joints()[joint as usize];
    let free = |joint: u32| of(joint).free.as_ref().expect("limits need one");
    match source {
        RowSource::Held { joint, row } => (joint, &of(joint).held[row as usize], 1.0),
        RowSource::Lower { joint } | RowSource::Motor { joint } => (joint, free(joint), 1.0),
        RowSource::Upper { joint } => (joint, free(joint), -1.0),
        RowSource::Normal { .. } | RowSource::Tangent { .. } => {
            unreachable!("contact rows have no joint")
        }
    }
}

/// Control channels that drive a joint's motor.
fn motor_channels(scene: &Scene, joint: u32) -> impl Iterator<Item = usize> {
    let drives = Control::MotorSpeed { joint: joint as usize };
    scene.controls().iter().enumerate().filter(move |(_, c)| **c == drives).map(|(i, _)| i)
}
