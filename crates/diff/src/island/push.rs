//! The assembly of an island along a direction.

use nalgebra::{Vector2, Vector3, Vector4, Vector6};
use tangency_collision::pose;
use tangency_core::rhs::Rhs;
use tangency_core::row::{RowContext, RowSource};
use tangency_core::{IslandRecord, Param, Scene};

use super::{joint_row_of, motor_channels};
use crate::contact_row::bend_change;
use crate::lcp::{LcpVector, RowVector};
use crate::vector::Direction;
use crate::{contact_row, joint_row, softening};

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
        if context.bends() {
            change.rows[k] = bend_jvp(context, *source, contacts, along);
            continue;
        }
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

/// The change of a row whose right-hand side is −γ.
fn bend_jvp(
    context: &RowContext<'_>,
    source: RowSource,
    contacts: &[Vector4<f64>],
    along: &Direction<'_>,
) -> RowVector {
    let (geometry, bend) = (context.geometry(source), context.bend(source));
    let (dj, _) = geometry_jvp(context, source, contacts, along);
    let mut row = RowVector::default();
    for (side, body) in geometry.bodies.iter().enumerate() {
        let Some(body) = *body else { continue };
        if context.scene.is_dynamic(body) {
            row.jacobian[side] = dj.fixed_rows::<3>(3 * side).into();
        }
        row.rhs -= bend.by_pose.fixed_rows::<3>(3 * side).dot(&along.state.q[body]);
        row.rhs -= bend.by_velocity.fixed_rows::<3>(3 * side).dot(&along.state.v[body]);
    }
    if let RowSource::Normal { contact } | RowSource::Tangent { contact } = source {
        let contact = &context.contacts[contact as usize];
        row.rhs -= bend_change(context, contact, &bend, along);
    }
    match source {
        RowSource::Tangent { .. } => {
            push_parameters(context, source, &mut row, &Rhs::default(), along);
        }
        RowSource::Normal { .. } => {}
        _ => {
            let (joint, ..) = joint_row_of(context.scene, source);
            let it = &along.scene.joints[joint as usize];
            for (side, anchor) in it.anchors.iter().enumerate() {
                row.rhs -= bend.by_anchors.fixed_rows::<2>(2 * side).dot(anchor);
            }
            if matches!(source, RowSource::Motor { .. }) {
                row.bound += it.motor_max;
            }
        }
    }
    row
}

/// The change of the speed of a contact's friction row, or of a motor's less its target; `contacts` are the
/// changes of the contacts.
pub(crate) fn speed_jvp(
    context: &RowContext<'_>,
    source: RowSource,
    contacts: &[Vector4<f64>],
    along: &Direction<'_>,
) -> f64 {
    let geometry = context.geometry(source);
    let (dj, _) = geometry_jvp(context, source, contacts, along);
    let mut change = 0.0;
    for (side, body) in geometry.bodies.iter().enumerate() {
        let Some(body) = *body else { continue };
        change += dj.fixed_rows::<3>(3 * side).dot(&context.v[body]);
        change += geometry.jacobian[side].dot(&along.state.v[body]);
    }
    if let RowSource::Motor { joint } = source {
        let inputs = motor_channels(context.scene, joint).map(|channel| along.control[channel]);
        change -= along.scene.joints[joint as usize].motor_speed + inputs.sum::<f64>();
    }
    change
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
                row.bound += it.motor_max * context.dt + max * along.scene.dt;
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

/// The change of a gap along a direction; `contacts` are the changes of the contacts.
pub(crate) fn gap_jvp(
    context: &RowContext<'_>,
    source: RowSource,
    contacts: &[Vector4<f64>],
    along: &Direction<'_>,
) -> f64 {
    geometry_jvp(context, source, contacts, along).1
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
            let (dj, d_value) = joint_row::geometry_jvp(context, joint, *row, along);
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
