//! The assembly of an island read backwards.

use std::ops::Range;

use nalgebra::Vector3;
use tangency_collision::pose;
use tangency_core::IslandRecord;
use tangency_core::measure::Measure;
use tangency_core::rhs::Rhs;
use tangency_core::row::{RowContext, RowSource};

use super::{joint_row_of, motor_channels};
use crate::contact_row::ContactPlace;
use crate::joint_row::JointPlace;
use crate::lcp::{LcpAdjoint, RowVector};
use crate::rotations::Rotations;
use crate::shape::Shape;
use crate::softening;
use crate::vector::Bars;

/// Pulls the gradient by an island's problem, row by row, back onto state, control and scene.
pub(crate) fn vjp(
    context: &RowContext<'_>,
    island: &IslandRecord,
    adjoint: &LcpAdjoint,
    rotations: &mut Rotations,
    bars: &mut Bars<'_>,
) {
    let context = &RowContext { stage: island.stage, ..*context };
    for (local, body) in island.bodies.iter().enumerate() {
        bars.scene.bodies[*body as usize].mass += adjoint.mass(&island.solution, local);
    }
    let mut pull = Pull { context, island, adjoint, rotations, bars };
    let mut start = 0;
    for sources in island.sources.chunk_by(|a, b| owner(*a) == owner(*b)) {
        let rows = start..start + sources.len();
        start = rows.end;
        if rows.clone().all(|row| adjoint.is_idle(&island.solution, row)) {
            continue;
        }
        match owner(sources[0]) {
            Owner::Joint(joint) => pull.joint(joint, rows),
            Owner::Contact(contact) => pull.contact(contact, rows),
        }
    }
}

/// Pulls the gradient by the gap of a contact or a limit back.
pub(crate) fn gap_vjp(
    context: &RowContext<'_>,
    source: RowSource,
    gap_bar: f64,
    rotations: &mut Rotations,
    bars: &mut Bars<'_>,
) {
    let no_row = [Vector3::zeros(); 2];
    if let Owner::Contact(contact) = owner(source) {
        let mut place = ContactPlace::new(context, contact);
        let normal = place.normal();
        place.add_row(&normal, &no_row, gap_bar);
        return place.pull_back(context, rotations, bars);
    }
    let (joint, row, sign) = joint_row_of(context.scene, source);
    let mut place = JointPlace::new(context, joint, rotations);
    place.add_row(&row.measure, &no_row, sign * gap_bar);
    let by = &mut bars.scene.joints[joint as usize];
    match source {
        RowSource::Upper { .. } => by.upper += gap_bar,
        _ => by.lower -= gap_bar,
    }
    place.pull_back(bars);
}

/// Pulls the gradient by the speed of a contact's friction row, or of a motor's less its target, back.
pub(crate) fn speed_vjp(
    context: &RowContext<'_>,
    source: RowSource,
    speed_bar: f64,
    rotations: &mut Rotations,
    bars: &mut Bars<'_>,
) {
    let geometry = context.geometry(source);
    let mut j_bar = [Vector3::zeros(); 2];
    for (side, body) in geometry.bodies.iter().enumerate() {
        let Some(body) = *body else { continue };
        j_bar[side] = context.v[body] * speed_bar;
        bars.state.v[body] += geometry.jacobian[side] * speed_bar;
    }
    if let Owner::Contact(contact) = owner(source) {
        let mut place = ContactPlace::new(context, contact);
        let tangent = pose::perp(&place.normal());
        place.add_row(&tangent, &j_bar, 0.0);
        return place.pull_back(context, rotations, bars);
    }
    let (joint, row, _) = joint_row_of(context.scene, source);
    let mut place = JointPlace::new(context, joint, rotations);
    place.add_row(&row.measure, &j_bar, 0.0);
    place.pull_back(bars);
    bars.scene.joints[joint as usize].motor_speed -= speed_bar;
    for channel in motor_channels(context.scene, joint) {
        bars.control[channel] -= speed_bar;
    }
}

/// What rows are rows of.
#[derive(Clone, Copy, PartialEq)]
enum Owner {
    Joint(u32),
    Contact(u32),
}

#[inline]
fn owner(source: RowSource) -> Owner {
    match source {
        RowSource::Held { joint, .. }
        | RowSource::Lower { joint }
        | RowSource::Upper { joint }
        | RowSource::Motor { joint } => Owner::Joint(joint),
        RowSource::Normal { contact } | RowSource::Tangent { contact } => Owner::Contact(contact),
    }
}

/// What the rows of an island are pulled back through.
struct Pull<'a, 'b> {
    context: &'a RowContext<'a>,
    island: &'a IslandRecord,
    adjoint: &'a LcpAdjoint,
    rotations: &'a mut Rotations,
    bars: &'a mut Bars<'b>,
}

impl Pull<'_, '_> {
    /// Consecutive rows of one joint.
    fn joint(&mut self, joint: u32, rows: Range<usize>) {
        let mut place = JointPlace::new(self.context, joint, self.rotations);
        for row in rows {
            let source = self.island.sources[row];
            let (_, it, sign) = joint_row_of(self.context.scene, source);
            let mut bar = self.row_bar(row);
            if sign < 0.0 {
                bar.jacobian = bar.jacobian.map(|j_bar| -j_bar);
            }
            let mut shape = place.shape(it);
            shape.value = self.error(source, shape.value);
            let value_bar = sign * self.right_side(source, sign, place.bodies(), &shape, &mut bar);
            place.add_row(&it.measure, &bar.jacobian, value_bar);
            let by = &mut self.bars.scene.joints[joint as usize];
            match source {
                RowSource::Held { row: 0, .. } if it.measure == Measure::Length => {
                    by.length -= value_bar;
                }
                RowSource::Lower { .. } => by.lower -= value_bar,
                RowSource::Upper { .. } => by.upper -= value_bar,
                _ => {}
            }
        }
        place.pull_back(self.bars);
    }

    /// Error or gap of a row from φ − reference: `φ − lower`, `upper − φ`, nothing for motors.
    fn error(&self, source: RowSource, value: f64) -> f64 {
        let limits = |joint: u32| self.context.scene.joints()[joint as usize].limits;
        match source {
            RowSource::Lower { joint } => value - limits(joint).lower.expect("of a lower row"),
            RowSource::Upper { joint } => limits(joint).upper.expect("of an upper row") - value,
            RowSource::Motor { .. } => 0.0,
            _ => value,
        }
    }

    /// Consecutive rows of one contact.
    fn contact(&mut self, contact: u32, rows: Range<usize>) {
        let mut place = ContactPlace::new(self.context, contact);
        for row in rows {
            let source = self.island.sources[row];
            let (d, gap) = match source {
                RowSource::Normal { .. } => (place.normal(), place.gap()),
                _ => (pose::perp(&place.normal()), 0.0),
            };
            let shape = place.shape(&d, gap);
            let mut bar = self.row_bar(row);
            let gap_bar = self.right_side(source, 1.0, place.bodies(), &shape, &mut bar);
            place.add_row(&d, &bar.jacobian, gap_bar);
        }
        place.pull_back(self.context, self.rotations, self.bars);
    }

    /// The cotangents of a row, with what comes through the compliance it gives way by.
    #[inline]
    fn row_bar(&mut self, row: usize) -> RowVector {
        let IslandRecord { problem, solution, .. } = self.island;
        let mut bar = self.adjoint.row(problem, solution, row);
        if self.context.stage.gives_way() {
            softening::vjp(self.context, self.island, row, &mut bar, self.bars.scene);
        }
        bar
    }

    /// Pulls b̄ and c̄ of a row back; adds to J̄ what comes through J·v and returns φ̄. `sign` is that
    /// with which J and J̄ enter the row.
    fn right_side(
        &mut self,
        source: RowSource,
        sign: f64,
        bodies: &[Option<usize>; 2],
        shape: &Shape,
        bar: &mut RowVector,
    ) -> f64 {
        if self.context.bends() {
            self.bend(source, bodies, bar);
            return 0.0;
        }
        let (context, bars) = (self.context, &mut *self.bars);
        let sides = bodies.iter().zip(&shape.jacobian);
        let along = |(body, j): (&Option<usize>, &Vector3<f64>)| {
            body.map_or(0.0, |body| j.dot(&context.v[body]))
        };
        let rhs = context.rhs(source, shape.value, sign * sides.map(along).sum::<f64>());
        pull_parameters(context, source, bar, &rhs, bars);
        bars.scene.dt += bar.rhs * rhs.d_dt + bar.compliance * rhs.compliance_d_dt;
        for (side, body) in bodies.iter().enumerate() {
            let Some(body) = *body else { continue };
            let driven = context.stage.is_velocity() && !context.scene.is_dynamic(body);
            let rate = sign * bar.rhs * (rhs.d_speed - if driven { 1.0 } else { 0.0 });
            if rate != 0.0 {
                bar.jacobian[side] += context.v[body] * rate;
                bars.state.v[body] += shape.jacobian[side] * rate;
            }
        }
        bar.rhs * rhs.d_position
    }
}

impl Pull<'_, '_> {
    /// The same for b = −γ.
    fn bend(&mut self, source: RowSource, bodies: &[Option<usize>; 2], bar: &RowVector) {
        let bars = &mut *self.bars;
        match source {
            RowSource::Motor { joint } => {
                bars.scene.joints[joint as usize].motor_max += bar.bound;
            }
            RowSource::Tangent { .. } => {
                pull_parameters(self.context, source, bar, &Rhs::default(), bars);
            }
            _ => {}
        }
        if bar.rhs == 0.0 {
            return;
        }
        let bend = self.context.bend(source);
        for (side, body) in bodies.iter().enumerate() {
            let Some(body) = *body else { continue };
            bars.state.q[body] -= bend.by_pose.fixed_rows::<3>(3 * side) * bar.rhs;
            bars.state.v[body] -= bend.by_velocity.fixed_rows::<3>(3 * side) * bar.rhs;
        }
        match owner(source) {
            Owner::Joint(joint) => {
                for (side, by) in bars.scene.joints[joint as usize].anchors.iter_mut().enumerate() {
                    *by -= bend.by_anchors.fixed_rows::<2>(2 * side) * bar.rhs;
                }
            }
            Owner::Contact(contact) => {
                ContactPlace::new(self.context, contact).pull_bend(
                    self.context,
                    &bend,
                    -bar.rhs,
                    bars,
                );
            }
        }
    }
}

fn pull_parameters(
    context: &RowContext<'_>,
    source: RowSource,
    bar: &RowVector,
    rhs: &Rhs,
    bars: &mut Bars<'_>,
) {
    let scene = context.scene;
    match source {
        RowSource::Held { joint, .. } if scene.joints()[joint as usize].softness.is_some() => {
            let it = &mut bars.scene.joints[joint as usize];
            let by = |k: usize| {
                bar.rhs * rhs.d_softness[k] + bar.compliance * rhs.compliance_d_softness[k]
            };
            it.stiffness += by(0);
            it.damping += by(1);
        }
        RowSource::Motor { joint } => {
            let it = &mut bars.scene.joints[joint as usize];
            it.motor_speed += bar.rhs;
            for channel in motor_channels(scene, joint) {
                bars.control[channel] += bar.rhs;
            }
            if let Some(max) = scene.joints()[joint as usize].motor.and_then(|m| m.max) {
                it.motor_max += bar.bound * context.dt;
                bars.scene.dt += bar.bound * max;
            }
        }
        RowSource::Normal { contact } if rhs.d_restitution != 0.0 => {
            let bodies = context.contact_bodies(contact);
            let e = scene.pair_restitution(bodies[0], bodies[1]);
            for (body, d) in bodies.iter().zip(e.d) {
                bars.scene.bodies[*body].restitution += bar.rhs * rhs.d_restitution * d;
            }
        }
        RowSource::Tangent { contact } if bar.bound != 0.0 => {
            let bodies = context.contact_bodies(contact);
            let mu = scene.pair_friction(bodies[0], bodies[1]);
            for (body, d) in bodies.iter().zip(mu.d) {
                bars.scene.bodies[*body].friction += bar.bound * d;
            }
        }
        _ => {}
    }
}
