//! Position errors that are rounding.

use crate::measure::Measure;
use crate::row::{RowContext, RowSource};
use crate::scene::Scene;
use crate::{BodyKind, JointRow};

/// Errors below this part of a body's size are rounding.
const SLOP: f64 = 1e-9;

impl RowContext<'_> {
    /// Penetrations of this contact below this are rounding, m.
    #[must_use]
    pub fn contact_slop(&self, contact: u32) -> f64 {
        let [a, b] = self.contact_bodies(contact);
        SLOP * self.scene.size(a).min(self.scene.size(b))
    }

    /// Violations of this joint's limits below this are rounding, m or rad.
    #[must_use]
    pub fn limit_slop(&self, joint: u32) -> f64 {
        SLOP * self.joint_size(joint, self.free(joint))
    }

    /// Errors of a row below this are rounding, m or rad.
    pub(crate) fn slop(&self, source: RowSource) -> f64 {
        match source {
            RowSource::Normal { contact } | RowSource::Tangent { contact } => {
                self.contact_slop(contact)
            }
            RowSource::Held { joint, row } => {
                SLOP * self.joint_size(joint, self.joint(joint).held[row as usize])
            }
            RowSource::Lower { joint }
            | RowSource::Upper { joint }
            | RowSource::Motor { joint } => self.limit_slop(joint),
        }
    }

    /// A length that stands for a joint's size, m: that of its smaller body; 1 rad for an angle.
    pub(crate) fn joint_size(&self, joint: u32, row: JointRow) -> f64 {
        let turns = row.measure == Measure::Angle;
        let sizes = self.joint(joint).bodies.iter().flatten().map(|b| self.scene.size(*b));
        if turns { 1.0 } else { sizes.fold(f64::INFINITY, f64::min) }
    }
}

impl Scene {
    /// A length that stands for a body's size, m: the radius of its shapes, or of gyration.
    #[must_use]
    pub fn size(&self, body: usize) -> f64 {
        let radius = self.colliders[body].radius();
        if radius > 0.0 {
            return radius;
        }
        let mass = self.bodies[body].mass;
        if self.bodies[body].kind == BodyKind::Dynamic {
            (mass.z / mass.x).sqrt()
        } else {
            f64::INFINITY
        }
    }
}
