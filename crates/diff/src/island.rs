//! Derivatives of the assembly of an island: from the problem's entries to what they came from.
//!
//! ```text
//!  s = J·v⁻,  b = rhs(φ, s, …) − Σ_driven J·v          driven: sides without unknowns
//!  s̄ = b̄ ∂b/∂s,   φ̄ = b̄ ∂b/∂φ,   J̄ += s̄ v (− b̄ v on driven sides),   v̄ += s̄ J (− b̄ J)
//! ```

use nalgebra::{Vector2, Vector3, Vector4, Vector6};
use tangency_collision::pose;
use tangency_core::rhs::Rhs;
use tangency_core::row::{RowContext, RowGeometry, RowSource};
use tangency_core::{Control, IslandRecord, JointRow, Param, Scene};

use crate::contact_row::{self, ContactBars};
use crate::joint_row;
use crate::lcp::{LcpVector, RowVector};
use crate::momentum::stack;
use crate::softening;
use crate::vector::{Bars, Direction, SceneVector, StateVector};

/// Pulls the gradient by an island's problem back onto state, control and scene.
pub(crate) fn vjp(
    context: &RowContext<'_>,
    island: &IslandRecord,
    mut problem_bar: LcpVector,
    contacts: &mut ContactBars,
    bars: &mut Bars<'_>,
) {
    let context = &RowContext { stage: island.stage, ..*context };
    softening::vjp(context, island, &mut problem_bar);
    for (body, mass_bar) in island.bodies.iter().zip(&problem_bar.mass) {
        bars.scene.bodies[*body as usize].mass += mass_bar;
    }
    for (source, bar) in island.sources.iter().zip(&problem_bar.rows) {
        let geometry = context.geometry(*source);
        let rhs = context.rhs(*source, geometry.value, context.speed(&geometry));
        let j_bar = pull_speed(context, &geometry, &rhs, bar, &mut bars.state);
        let value_bar = bar.rhs * rhs.d_position;
        bars.scene.dt += bar.rhs * rhs.d_dt + bar.compliance * rhs.compliance_d_dt;
        pull_parameters(context, *source, bar, &rhs, bars);
        match *source {
            RowSource::Normal { contact } => {
                let d = context.contacts[contact as usize].normal;
                contacts.add_row(context, contact, &d, &j_bar, bars);
                contacts.add_gap(contact, value_bar);
            }
            RowSource::Tangent { contact } => {
                let d = pose::perp(&context.contacts[contact as usize].normal);
                contacts.add_row(context, contact, &d, &j_bar, bars);
            }
            _ => {
                let (joint, row, sign) = joint_row_of(context.scene, *source);
                let (j_bar, value_bar) = (j_bar * sign, value_bar * sign);
                joint_row::geometry_vjp(context, joint, row, &j_bar, value_bar, bars);
                pull_reference(context.scene, *source, value_bar, bars.scene);
            }
        }
    }
}

/// The change of an island's problem along a direction; `contacts` are the changes of the contacts
/// and `momentum` of p.
pub(crate) fn jvp(
    context: &RowContext<'_>,
    island: &IslandRecord,
    contacts: &[Vector4<f64>],
    momentum: &[Vector3<f64>],
    along: &Direction<'_>,
) -> LcpVector {
    let context = &RowContext { stage: island.stage, ..*context };
    let bodies = || island.bodies.iter().map(|b| *b as usize);
    let mut change = LcpVector::zeros(&island.problem);
    change.mass = bodies().map(|b| along.scene.bodies[b].mass).collect();
    change.momentum = bodies().map(|b| momentum[b]).collect();
    for (k, source) in island.sources.iter().enumerate() {
        let geometry = context.geometry(*source);
        let rhs = context.rhs(*source, geometry.value, context.speed(&geometry));
        let (dj, d_value) = geometry_jvp(context, *source, contacts, along);
        let row = &mut change.rows[k];
        let (mut d_speed, mut d_driven) = (0.0, 0.0);
        for side in 0..2 {
            let Some(body) = geometry.bodies[side] else { continue };
            let dj_side: Vector3<f64> = dj.fixed_rows::<3>(3 * side).into();
            let part =
                dj_side.dot(&context.v[body]) + geometry.jacobian[side].dot(&along.state.v[body]);
            d_speed += part;
            if context.scene.is_dynamic(body) {
                row.jacobian[side] = dj_side;
            } else if context.stage.is_velocity() {
                d_driven += part;
            }
        }
        row.rhs =
            rhs.d_position * d_value + rhs.d_speed * d_speed + rhs.d_dt * along.scene.dt - d_driven;
        row.compliance = rhs.compliance_d_dt * along.scene.dt;
        push_parameters(context, *source, row, &rhs, along);
    }
    softening::jvp(context, island, &mut change);
    change
}

/// J̄ of a row with what comes through J·v; adds to v̄.
fn pull_speed(
    context: &RowContext<'_>,
    geometry: &RowGeometry,
    rhs: &Rhs,
    bar: &RowVector,
    before: &mut StateVector,
) -> Vector6<f64> {
    let speed_bar = bar.rhs * rhs.d_speed;
    let mut j_bar = [Vector3::zeros(); 2];
    for (side, j_bar) in j_bar.iter_mut().enumerate() {
        let Some(body) = geometry.bodies[side] else { continue };
        let mut rate = speed_bar;
        if context.scene.is_dynamic(body) {
            *j_bar += bar.jacobian[side];
        } else if context.stage.is_velocity() {
            rate -= bar.rhs;
        }
        *j_bar += context.v[body] * rate;
        before.v[body] += geometry.jacobian[side] * rate;
    }
    stack(&j_bar)
}

/// The joint row behind a source, and the sign with which it enters.
fn joint_row_of(scene: &Scene, source: RowSource) -> (u32, JointRow, f64) {
    let free = |joint: u32| scene.joints()[joint as usize].free.expect("limits need one");
    match source {
        RowSource::Held { joint, row } => {
            (joint, scene.joints()[joint as usize].held[row as usize], 1.0)
        }
        RowSource::Lower { joint } | RowSource::Motor { joint } => (joint, free(joint), 1.0),
        RowSource::Upper { joint } => (joint, free(joint), -1.0),
        RowSource::Normal { .. } | RowSource::Tangent { .. } => {
            unreachable!("contact rows have no joint")
        }
    }
}

/// φ = m − reference (− lower), or upper − m: `value_bar` is by m.
fn pull_reference(scene: &Scene, source: RowSource, value_bar: f64, out: &mut SceneVector) {
    match source {
        RowSource::Held { joint, row: 0 } if has_length(scene, joint) => {
            out.joints[joint as usize].length -= value_bar;
        }
        RowSource::Lower { joint } => out.joints[joint as usize].lower -= value_bar,
        RowSource::Upper { joint } => out.joints[joint as usize].upper -= value_bar,
        _ => {}
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
        RowSource::Held { joint, .. } => {
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
        RowSource::Normal { contact } => {
            let bodies = context.contact_bodies(contact);
            let e = scene.pair_restitution(bodies[0], bodies[1]);
            for (body, d) in bodies.iter().zip(e.d) {
                bars.scene.bodies[*body].restitution += bar.rhs * rhs.d_restitution * d;
            }
        }
        RowSource::Tangent { contact } => {
            let bodies = context.contact_bodies(contact);
            let mu = scene.pair_friction(bodies[0], bodies[1]);
            for (body, d) in bodies.iter().zip(mu.d) {
                bars.scene.bodies[*body].friction += bar.bound * d;
            }
        }
        RowSource::Lower { .. } | RowSource::Upper { .. } => {}
    }
}

fn push_parameters(
    context: &RowContext<'_>,
    source: RowSource,
    row: &mut RowVector,
    rhs: &Rhs,
    along: &Direction<'_>,
) {
    let scene = context.scene;
    match source {
        RowSource::Held { joint, .. } => {
            let it = &along.scene.joints[joint as usize];
            let rates = [it.stiffness, it.damping];
            for (k, rate) in rates.into_iter().enumerate() {
                row.rhs += rhs.d_softness[k] * rate;
                row.compliance += rhs.compliance_d_softness[k] * rate;
            }
        }
        RowSource::Motor { joint } => {
            let it = &along.scene.joints[joint as usize];
            let inputs: f64 = motor_channels(scene, joint).map(|c| along.control[c]).sum();
            row.rhs += it.motor_speed + inputs;
            if let Some(max) = scene.joints()[joint as usize].motor.and_then(|m| m.max) {
                row.bound += it.motor_max * scene.dt() + max * along.scene.dt;
            }
        }
        RowSource::Normal { contact } => {
            let bodies = context.contact_bodies(contact);
            let e = scene.pair_restitution(bodies[0], bodies[1]);
            let rate: f64 =
                bodies.iter().zip(e.d).map(|(b, d)| along.scene.bodies[*b].restitution * d).sum();
            row.rhs += rhs.d_restitution * rate;
        }
        RowSource::Tangent { contact } => {
            let bodies = context.contact_bodies(contact);
            let mu = scene.pair_friction(bodies[0], bodies[1]);
            row.bound += bodies
                .iter()
                .zip(mu.d)
                .map(|(b, d)| along.scene.bodies[*b].friction * d)
                .sum::<f64>();
        }
        RowSource::Lower { .. } | RowSource::Upper { .. } => {}
    }
}

/// Control channels that drive a joint's motor.
fn motor_channels(scene: &Scene, joint: u32) -> impl Iterator<Item = usize> {
    let drives = Control::MotorSpeed { joint: joint as usize };
    scene.controls().iter().enumerate().filter(move |(_, c)| **c == drives).map(|(i, _)| i)
}

/// The change of J (6) and φ of any row.
fn geometry_jvp(
    context: &RowContext<'_>,
    source: RowSource,
    contacts: &[Vector4<f64>],
    along: &Direction<'_>,
) -> (Vector6<f64>, f64) {
    let contact_jvp = |contact: u32, d: &Vector2<f64>| {
        contact_row::row_jvp(context, contact, d, &contacts[contact as usize], along)
    };
    match source {
        RowSource::Normal { contact } => {
            let d = context.contacts[contact as usize].normal;
            (contact_jvp(contact, &d), contacts[contact as usize].w)
        }
        RowSource::Tangent { contact } => {
            let d = pose::perp(&context.contacts[contact as usize].normal);
            (contact_jvp(contact, &d), 0.0)
        }
        _ => {
            let (joint, row, sign) = joint_row_of(context.scene, source);
            let (dj, d_value) = joint_row::geometry_jvp(context, joint, row, along);
            let it = &along.scene.joints[joint as usize];
            let d_reference = match source {
                RowSource::Held { row: 0, .. } if has_length(context.scene, joint) => it.length,
                RowSource::Lower { .. } => it.lower,
                RowSource::Upper { .. } => it.upper,
                _ => 0.0,
            };
            (dj * sign, (d_value - d_reference) * sign)
        }
    }
}

fn has_length(scene: &Scene, joint: u32) -> bool {
    scene.get(Param::Length(joint as usize)).is_some()
}
