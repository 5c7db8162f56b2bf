//! The rows of a step with their geometry, in the order in which they enter its problems.

use nalgebra::Vector3;

use crate::detect::Reach;
use crate::frames::Frames;
use crate::row::{RowContext, RowGeometry, RowSource};

/// Where each row comes from, and its value and gradient.
#[derive(Debug, Default)]
pub(crate) struct Rows {
    pub(crate) sources: Vec<RowSource>,
    pub(crate) geometry: Vec<RowGeometry>,
}

impl Rows {
    /// All rows of the step, joints first, each friction row behind its normal row. `frames` are those
    /// of the context's poses.
    pub(crate) fn list(&mut self, context: &RowContext<'_>, frames: &Frames, reach: Reach) {
        self.sources.clear();
        self.geometry.clear();
        let post = !context.stage.is_velocity();
        for (index, joint) in (0_u32..).zip(&context.scene.joints) {
            if post && joint.softness.is_some() {
                continue;
            }
            for row in 0..u32::try_from(joint.held.len()).expect("few rows") {
                self.push(context, frames, RowSource::Held { joint: index, row });
            }
            if joint.limits.lower.is_some() {
                self.push_limit(context, frames, RowSource::Lower { joint: index }, reach);
            }
            if joint.limits.upper.is_some() {
                self.push_limit(context, frames, RowSource::Upper { joint: index }, reach);
            }
            if joint.motor.is_some() && !post {
                self.push(context, frames, RowSource::Motor { joint: index });
            }
        }
        self.list_contacts(context, frames);
    }

    fn list_contacts(&mut self, context: &RowContext<'_>, frames: &Frames) {
        for (index, contact) in (0_u32..).zip(context.contacts) {
            if !contact.normal.x.is_finite() {
                continue; // moved until two points coincide: nothing to mend, and no direction
            }
            self.push(context, frames, RowSource::Normal { contact: index });
            let [a, b] = context.contact_bodies(index);
            if context.stage.is_velocity() && context.scene.pair_friction(a, b).value > 0.0 {
                self.push(context, frames, RowSource::Tangent { contact: index });
            }
        }
    }

    fn push(&mut self, context: &RowContext<'_>, frames: &Frames, source: RowSource) {
        self.sources.push(source);
        self.geometry.push(context.geometry_in(source, frames));
    }

    /// The row of a limit if the free coordinate can get there within the step.
    fn push_limit(
        &mut self,
        context: &RowContext<'_>,
        frames: &Frames,
        source: RowSource,
        reach: Reach,
    ) {
        let geometry = context.geometry_in(source, frames);
        let travel = |j: &Vector3<f64>| j.xy().norm() * reach.linear + j.z.abs() * reach.angular;
        let bound: f64 = geometry.jacobian.iter().map(travel).sum();
        if geometry.value <= bound {
            self.sources.push(source);
            self.geometry.push(geometry);
        }
    }
}
