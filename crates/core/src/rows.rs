//! The rows of a step, in the order in which they enter its problems.

use nalgebra::Vector3;
use tangency_lcp::{Law, NO_BODY, Row};

use crate::frames::Frames;
use crate::measure::{Arms, MeasureValue};
use crate::model::JointRow;
use crate::motion::Motion;
use crate::reach::Groups;
use crate::rhs::Rhs;
use crate::row::{RowContext, RowGeometry, RowSource};

/// Where each row comes from, and the row itself over the scene's own indices of bodies.
#[derive(Debug, Default)]
pub(crate) struct Rows {
    pub(crate) sources: Vec<RowSource>,
    pub(crate) list: Vec<Row>,
    /// Of flows and impacts the limits that are reached; others have no row.
    pub(crate) reached: Vec<RowSource>,
}

impl Rows {
    /// All rows of the step, joints first, each friction row behind its normal row. `frames` are those
    /// of the context's poses.
    pub(crate) fn fill(&mut self, context: &RowContext<'_>, frames: &Frames, groups: &Groups) {
        self.sources.clear();
        self.list.clear();
        // The lists may end in a record: they take no more than they need.
        let held: usize = context.scene.joints.iter().map(|joint| joint.held.len()).sum();
        self.sources.reserve_exact(held + 2 * context.contacts.len());
        self.list.reserve_exact(held + 2 * context.contacts.len());
        let soft = context.stage.is_velocity() && context.motion.has_springs(context.dt);
        for (index, joint) in (0_u32..).zip(&context.scene.joints) {
            if joint.softness.is_some() && !soft {
                continue;
            }
            self.list_held(context, frames, index);
            if joint.free.is_some() {
                self.list_free(context, frames, index, groups);
            }
        }
        self.list_contacts(context);
    }

    /// What a joint holds.
    fn list_held(&mut self, context: &RowContext<'_>, frames: &Frames, index: u32) {
        let joint = &context.scene.joints[index as usize];
        let sides = joint.bodies.map(|body| frames.side(body));
        let arms = Arms::new(sides, [&joint.anchors[0], &joint.anchors[1]]);
        let smooth = context.bends();
        let driven = joint.driven && context.stage.is_velocity() && !smooth;
        let [a, b] = joint.unknowns.map(|body| if body == NO_BODY { 0.0 } else { 1.0 });
        let common = context.common_rhs(index);
        let source = |(row, _)| RowSource::Held { joint: index, row: number(row) };
        let held = |(row, held): (usize, &JointRow)| {
            let MeasureValue { value, jacobian } = held.measure.evaluate_on(&arms, sides);
            let value = value - held.reference;
            let (mut rhs, compliance) = if let Some(common) = common {
                (common.d_position * value, common.compliance)
            } else if smooth {
                let source = RowSource::Held { joint: index, row: number(row) };
                (-context.bend(source).value, 0.0)
            } else {
                let geometry = RowGeometry { bodies: joint.bodies, value, jacobian };
                let speed = context.speed(&geometry);
                let own = context.held_rhs(index, number(row), value, speed);
                (own.value, own.compliance)
            };
            if driven {
                rhs -=
                    driven_speed(context, &RowGeometry { bodies: joint.bodies, value, jacobian });
            }
            let jacobian = [jacobian[0] * a, jacobian[1] * b];
            Row { bodies: joint.unknowns, jacobian, rhs, compliance, law: Law::Equality }
        };
        self.sources.extend(joint.held.iter().enumerate().map(source));
        self.list.extend(joint.held.iter().enumerate().map(held));
    }

    /// Limits in reach, and the motor.
    fn list_free(
        &mut self,
        context: &RowContext<'_>,
        frames: &Frames,
        index: u32,
        groups: &Groups,
    ) {
        let joint = &context.scene.joints[index as usize];
        if joint.limits.lower.is_some() {
            self.push_limit(context, frames, RowSource::Lower { joint: index }, groups);
        }
        if joint.limits.upper.is_some() {
            self.push_limit(context, frames, RowSource::Upper { joint: index }, groups);
        }
        let weak = joint.motor.is_some_and(|motor| motor.max.is_some());
        let drives = context.stage.is_velocity() && !(weak && context.motion == Motion::Impact);
        if joint.motor.is_some() && drives {
            let source = RowSource::Motor { joint: index };
            let law = context.motor_law(index);
            self.push(context, source, &context.geometry_in(source, frames), law);
        }
    }

    fn list_contacts(&mut self, context: &RowContext<'_>) {
        for (index, contact) in (0_u32..).zip(context.contacts) {
            if !contact.normal.x.is_finite() {
                continue; // moved until two points coincide: nothing to mend, and no direction
            }
            let [normal, tangent] = context.contact_geometries(contact);
            let closed = context.stays_closed(index);
            let law = if closed { Law::Equality } else { Law::Unilateral };
            self.push(context, RowSource::Normal { contact: index }, &normal, law);
            if !context.stage.is_velocity() {
                continue;
            }
            let [a, b] = context.contact_bodies(index);
            let mu = context.scene.pair_friction(a, b).value;
            if mu > 0.0 {
                let law = Law::Friction { normal: number(self.list.len() - 1), mu };
                self.push(context, RowSource::Tangent { contact: index }, &tangent, law);
            }
        }
    }

    /// The row of a limit if the free coordinate can get there within the step.
    fn push_limit(
        &mut self,
        context: &RowContext<'_>,
        frames: &Frames,
        source: RowSource,
        groups: &Groups,
    ) {
        let geometry = context.geometry_in(source, frames);
        if context.motion != Motion::Fixed {
            if self.reached.contains(&source) {
                self.push(context, source, &geometry, Law::Unilateral);
            }
            return;
        }
        let reach = groups.of_joint(geometry.bodies);
        let travel = |j: &Vector3<f64>| j.xy().norm() * reach.linear + j.z.abs() * reach.angular;
        let bound: f64 = geometry.jacobian.iter().map(travel).sum();
        if geometry.value <= bound {
            self.push(context, source, &geometry, Law::Unilateral);
        }
    }

    fn push(
        &mut self,
        context: &RowContext<'_>,
        source: RowSource,
        geometry: &RowGeometry,
        law: Law,
    ) {
        let mut row = Row {
            bodies: [NO_BODY; 2],
            jacobian: [Vector3::zeros(); 2],
            rhs: 0.0,
            compliance: 0.0,
            law,
        };
        for side in 0..2 {
            if let Some(body) = geometry.bodies[side]
                && context.scene.is_dynamic(body)
            {
                row.bodies[side] = number(body);
                row.jacobian[side] = geometry.jacobian[side];
            }
        }
        set_right_side(context, source, geometry, &mut row);
        self.sources.push(source);
        self.list.push(row);
    }
}

/// b and c of a row; sides that are driven take their known velocity off b.
pub(crate) fn set_right_side(
    context: &RowContext<'_>,
    source: RowSource,
    geometry: &RowGeometry,
    row: &mut Row,
) {
    if context.bends() {
        (row.rhs, row.compliance) = (-context.bend(source).value, 0.0);
        return;
    }
    let rhs = match source {
        RowSource::Tangent { .. } => Rhs::default(),
        RowSource::Normal { .. } => context.rhs(source, geometry.value, context.speed(geometry)),
        RowSource::Held { .. } if context.motion == Motion::Flow => {
            context.rhs(source, geometry.value, context.speed(geometry))
        }
        _ => context.rhs(source, geometry.value, 0.0),
    };
    (row.rhs, row.compliance) = (rhs.value, rhs.compliance);
    if context.stage.is_velocity() && row.bodies.contains(&NO_BODY) {
        row.rhs -= driven_speed(context, geometry);
    }
}

/// What the velocities of bodies without unknowns contribute to J v.
fn driven_speed(context: &RowContext<'_>, geometry: &RowGeometry) -> f64 {
    let driven = |(body, j): (&Option<usize>, &Vector3<f64>)| {
        body.filter(|b| !context.scene.is_dynamic(*b)).map(|b| j.dot(&context.v[b]))
    };
    geometry.bodies.iter().zip(&geometry.jacobian).filter_map(driven).sum()
}

fn number(index: usize) -> u32 {
    u32::try_from(index).expect("fewer bodies and rows than u32 counts")
}
