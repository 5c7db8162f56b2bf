//! The rows of a step: where each comes from, and its geometry.
//!
//! ```text
//!  contact at c, normal n from a to b, tangent t = ⊥n, arms ρ = c − p:
//!    Jₙ = [−n, −n·⊥ρ_a | n, n·⊥ρ_b]        Jₜ = [−t, −t·⊥ρ_a | t, t·⊥ρ_b]
//!  limit of a joint's free coordinate φ:   gap = φ − lower   or   upper − φ
//! ```

use nalgebra::{Vector2, Vector3};
use serde::{Deserialize, Serialize};
use tangency_collision::{Contact, Pose, pose};

use crate::State;
use crate::frames::Frames;
use crate::model::{Joint, JointRow};
use crate::motion::Motion;
use crate::scene::Scene;
pub use crate::stage::Stage;

/// Where a row comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum RowSource {
    /// A coordinate that a joint holds.
    Held {
        /// The joint.
        joint: u32,
        /// Which of its held rows.
        row: u32,
    },
    /// Lower limit of a joint's free coordinate.
    Lower {
        /// The joint.
        joint: u32,
    },
    /// Upper limit of a joint's free coordinate.
    Upper {
        /// The joint.
        joint: u32,
    },
    /// Motor of a joint.
    Motor {
        /// The joint.
        joint: u32,
    },
    /// A contact's normal row.
    Normal {
        /// Index into the step's contacts.
        contact: u32,
    },
    /// A contact's friction row.
    Tangent {
        /// Index into the step's contacts.
        contact: u32,
    },
}

/// Value and gradient of a row, before its right-hand side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowGeometry {
    /// Bodies a and b; `None` is the world.
    pub bodies: [Option<usize>; 2],
    /// Position error or gap, m or rad; 0 for friction and motors.
    pub value: f64,
    /// Jacobian blocks, 1 × 3 each.
    pub jacobian: [Vector3<f64>; 2],
}

/// A row that a displacement moves at a bounded speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SlowRow {
    /// The row.
    pub source: RowSource,
    /// Greatest speed, m/s or rad/s: the recovery speed in a step's first displacement, and then 0.
    pub speed: f64,
}

/// What rows are evaluated from.
#[derive(Clone, Copy, Debug)]
pub struct RowContext<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Which problem.
    pub stage: Stage,
    /// How bodies move in this part of the step.
    pub motion: Motion,
    /// How long this part of the step lasts, s; 0 for impacts.
    pub dt: f64,
    /// Poses that the rows are evaluated at.
    pub q: &'a [Pose],
    /// Velocities before the step.
    pub v: &'a [Vector3<f64>],
    /// Control of the step.
    pub control: &'a [f64],
    /// Contacts, evaluated at `q`.
    pub contacts: &'a [Contact],
    /// Bodies whose position errors stayed in the step ([`Stage::drifts`]), so that the displacement
    /// after the move removes them; empty if there are none.
    pub loose: &'a [bool],
    /// Rows whose errors a displacement removes in part only, by source; all others at once.
    pub slow: &'a [SlowRow],
    /// Of an impact the contacts that bounce; of a displacement after a flow those that pressed and
    /// stay closed. Empty if there are none.
    pub marked: &'a [bool],
}

impl<'a> RowContext<'a> {
    /// The velocities of a step of length `dt` from a state, without contacts.
    pub(crate) fn of(scene: &'a Scene, state: &'a State, control: &'a [f64], dt: f64) -> Self {
        Self {
            scene,
            stage: Stage::Velocity,
            motion: Motion::Fixed,
            dt,
            q: &state.q,
            v: &state.v,
            control,
            contacts: &[],
            loose: &[],
            slow: &[],
            marked: &[],
        }
    }
}

impl RowContext<'_> {
    /// Value and gradient of a row.
    ///
    /// # Panics
    /// If the scene has no such row.
    #[must_use]
    pub fn geometry(&self, source: RowSource) -> RowGeometry {
        match self.joint_row(source) {
            Some((joint, row)) => self.turned(source, self.joint_geometry(joint, row)),
            None => self.contact_row_geometry(source),
        }
    }

    /// The same where the frames of the context's poses are at hand.
    pub(crate) fn geometry_in(&self, source: RowSource, frames: &Frames) -> RowGeometry {
        match self.joint_row(source) {
            Some((joint, row)) => self.turned(source, self.joint_geometry_in(joint, row, frames)),
            None => self.contact_row_geometry(source),
        }
    }

    /// The scalar of a joint that a row is about; `None` for contacts.
    fn joint_row(&self, source: RowSource) -> Option<(u32, JointRow)> {
        match source {
            RowSource::Held { joint, row } => Some((joint, self.joint(joint).held[row as usize])),
            RowSource::Lower { joint }
            | RowSource::Upper { joint }
            | RowSource::Motor { joint } => Some((joint, self.free(joint))),
            RowSource::Normal { .. } | RowSource::Tangent { .. } => None,
        }
    }

    /// A joint's scalar as the row sees it.
    fn turned(&self, source: RowSource, g: RowGeometry) -> RowGeometry {
        match source {
            RowSource::Lower { joint } => {
                let lower = self.joint(joint).limits.lower;
                let value = g.value - lower.expect("a lower row has a lower limit");
                RowGeometry { value, ..g }
            }
            RowSource::Upper { joint } => {
                let upper = self.joint(joint).limits.upper;
                let value = upper.expect("an upper row has an upper limit") - g.value;
                RowGeometry { value, jacobian: g.jacobian.map(|j| -j), ..g }
            }
            RowSource::Motor { .. } => RowGeometry { value: 0.0, ..g },
            _ => g,
        }
    }

    fn contact_row_geometry(&self, source: RowSource) -> RowGeometry {
        let of = |contact: u32| self.contact_geometries(&self.contacts[contact as usize]);
        match source {
            RowSource::Normal { contact } => of(contact)[0],
            RowSource::Tangent { contact } => of(contact)[1],
            _ => unreachable!("rows of joints have a joint"),
        }
    }

    /// Value and gradient of a contact's normal row and of its friction row.
    pub(crate) fn contact_geometries(&self, contact: &Contact) -> [RowGeometry; 2] {
        let bodies = contact.feature.id.bodies.map(|b| b as usize);
        let turned = bodies.map(|body| pose::perp(&(contact.point - self.q[body].xy())));
        let bodies = bodies.map(Some);
        let along = |d: &Vector2<f64>, value: f64| {
            let [a, b] = [d.dot(&turned[0]), d.dot(&turned[1])];
            let jacobian = [Vector3::new(-d.x, -d.y, -a), Vector3::new(d.x, d.y, b)];
            RowGeometry { bodies, value, jacobian }
        };
        [along(&contact.normal, contact.gap), along(&pose::perp(&contact.normal), 0.0)]
    }

    /// J v⁻ of a row over both its sides, m/s or rad/s.
    #[must_use]
    pub fn speed(&self, geometry: &RowGeometry) -> f64 {
        let sides = geometry.bodies.iter().zip(&geometry.jacobian);
        sides.filter_map(|(body, j)| body.map(|b| j.dot(&self.v[b]))).sum()
    }

    /// Bodies of a contact.
    #[must_use]
    pub fn contact_bodies(&self, contact: u32) -> [usize; 2] {
        self.contacts[contact as usize].feature.id.bodies.map(|b| b as usize)
    }

    /// A scalar of a joint at the context's poses.
    #[must_use]
    pub fn joint_geometry(&self, joint: u32, row: JointRow) -> RowGeometry {
        let Joint { bodies, anchors, .. } = self.joint(joint);
        let poses = self.scene.joint_poses(joint as usize, self.q);
        let m = row.measure.evaluate([&poses[0], &poses[1]], [&anchors[0], &anchors[1]]);
        RowGeometry { bodies: *bodies, value: m.value - row.reference, jacobian: m.jacobian }
    }

    pub(crate) fn joint_geometry_in(
        &self,
        joint: u32,
        row: JointRow,
        frames: &Frames,
    ) -> RowGeometry {
        let Joint { bodies, anchors, .. } = self.joint(joint);
        let sides = bodies.map(|body| frames.side(body));
        let m = row.measure.evaluate_in(sides, [&anchors[0], &anchors[1]]);
        RowGeometry { bodies: *bodies, value: m.value - row.reference, jacobian: m.jacobian }
    }

    pub(crate) fn joint(&self, joint: u32) -> &Joint {
        &self.scene.joints[joint as usize]
    }

    pub(crate) fn free(&self, joint: u32) -> JointRow {
        self.joint(joint).free.expect("only joints with a free coordinate have limits and motors")
    }
}
