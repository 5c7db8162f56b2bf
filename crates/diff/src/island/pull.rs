//! The assembly of an island read backwards.

use nalgebra::{Vector2, Vector3};
use tangency_collision::pose;
use tangency_core::measure::Measure;
use tangency_core::rhs::Rhs;
use tangency_core::row::{RowContext, RowGeometry, RowSource};
use tangency_core::{IslandRecord, Scene};

use super::{joint_row_of, motor_channels};
use crate::contact_row::ContactPlace;
use crate::joint_row::JointPlace;
use crate::lcp::{LcpAdjoint, RowVector};
use crate::rotations::Rotations;
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
    let (joint, contact) = (None, None);
    let mut pull = Pull { context, rotations, bars, joint, contact };
    for (row, source) in island.sources.iter().enumerate() {
        if adjoint.is_idle(&island.solution, row) {
            continue;
        }
        let mut bar = adjoint.row(&island.problem, &island.solution, row);
        if context.stage.gives_way() {
            softening::vjp(context, island, row, &mut bar, pull.bars.scene);
        }
        pull.row(*source, &bar);
    }
    pull.close_contact();
}

/// What the rows of an island are pulled back through, one after the other.
struct Pull<'a, 'b, 'c> {
    context: &'b RowContext<'a>,
    rotations: &'b mut Rotations,
    bars: &'b mut Bars<'c>,
    /// Joint and contact of the row before: rows of one come together.
    joint: Option<(u32, JointPlace)>,
    contact: Option<(u32, ContactPlace<'a>)>,
}

impl Pull<'_, '_, '_> {
    fn row(&mut self, source: RowSource, bar: &RowVector) {
        match source {
            RowSource::Normal { contact } => {
                let place = self.open_contact(contact);
                let (d, gap) = (place.normal(), place.gap());
                self.contact_row(source, &d, gap, bar);
            }
            RowSource::Tangent { contact } => {
                let d = pose::perp(&self.open_contact(contact).normal());
                self.contact_row(source, &d, 0.0, bar);
            }
            _ => self.joint_row(source, bar),
        }
    }

    fn contact_row(&mut self, source: RowSource, d: &Vector2<f64>, gap: f64, bar: &RowVector) {
        let Some((_, place)) = &mut self.contact else { return };
        let geometry = place.geometry(d, gap);
        let (j_bar, gap_bar) = pull_right_side(self.context, source, &geometry, bar, self.bars);
        place.add_row(d, &j_bar, gap_bar);
    }

    fn joint_row(&mut self, source: RowSource, bar: &RowVector) {
        let (joint, row, sign) = joint_row_of(self.context.scene, source);
        if self.joint.as_ref().is_none_or(|(open, _)| *open != joint) {
            self.joint = Some((joint, JointPlace::new(self.context, joint, self.rotations)));
        }
        let Some((_, place)) = &self.joint else { return };
        let geometry = of_source(self.context.scene, source, place.geometry(row));
        let (j_bar, error_bar) = pull_right_side(self.context, source, &geometry, bar, self.bars);
        let (j_bar, value_bar) = (j_bar.map(|j_bar| j_bar * sign), error_bar * sign);
        place.pull_row(row.measure, &j_bar, value_bar, self.bars);
        let by = &mut self.bars.scene.joints[joint as usize];
        match source {
            RowSource::Held { row: 0, .. } if row.measure == Measure::Length => {
                by.length -= value_bar;
            }
            RowSource::Lower { .. } => by.lower -= value_bar,
            RowSource::Upper { .. } => by.upper -= value_bar,
            _ => {}
        }
    }

    /// The contact of the row at hand; what the one before collected is pulled back.
    fn open_contact(&mut self, contact: u32) -> &ContactPlace<'_> {
        if self.contact.as_ref().is_none_or(|(open, _)| *open != contact) {
            self.close_contact();
        }
        &self.contact.get_or_insert_with(|| (contact, ContactPlace::new(self.context, contact))).1
    }

    fn close_contact(&mut self) {
        if let Some((_, place)) = self.contact.take() {
            place.pull_back(self.context, self.rotations, self.bars);
        }
    }
}

/// Error or gap of a row from φ − reference: `φ − lower`, `upper − φ`, nothing for motors.
fn of_source(scene: &Scene, source: RowSource, measured: RowGeometry) -> RowGeometry {
    let RowGeometry { value, jacobian, .. } = measured;
    let limits = |joint: u32| scene.joints()[joint as usize].limits;
    match source {
        RowSource::Lower { joint } => {
            let lower = limits(joint).lower.expect("a lower row has a lower limit");
            RowGeometry { value: value - lower, ..measured }
        }
        RowSource::Upper { joint } => {
            let upper = limits(joint).upper.expect("an upper row has an upper limit");
            RowGeometry { value: upper - value, jacobian: jacobian.map(|j| -j), ..measured }
        }
        RowSource::Motor { .. } => RowGeometry { value: 0.0, ..measured },
        _ => measured,
    }
}

/// Pulls b̄ and c̄ of a row back; returns J̄ with what comes through J·v, and φ̄.
fn pull_right_side(
    context: &RowContext<'_>,
    source: RowSource,
    geometry: &RowGeometry,
    bar: &RowVector,
    bars: &mut Bars<'_>,
) -> ([Vector3<f64>; 2], f64) {
    let rhs = context.rhs(source, geometry.value, context.speed(geometry));
    pull_parameters(context, source, bar, &rhs, bars);
    bars.scene.dt += bar.rhs * rhs.d_dt + bar.compliance * rhs.compliance_d_dt;
    let speed_bar = bar.rhs * rhs.d_speed;
    let mut j_bar = bar.jacobian;
    for (side, j_bar) in j_bar.iter_mut().enumerate() {
        let Some(body) = geometry.bodies[side] else { continue };
        let driven = context.stage.is_velocity() && !context.scene.is_dynamic(body);
        let rate = speed_bar - if driven { bar.rhs } else { 0.0 };
        if rate != 0.0 {
            *j_bar += context.v[body] * rate;
            bars.state.v[body] += geometry.jacobian[side] * rate;
        }
    }
    (j_bar, bar.rhs * rhs.d_position)
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
                it.motor_max += bar.bound * scene.dt();
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
