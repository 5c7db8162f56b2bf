//! Derivatives of the forces of soft joints in smooth flows.
//!
//! ```text
//!  F = −k φ − d s,  s = J v        p += Jᵀ F
//!
//!  F̄ = J·p̄      J̄ += F p̄ − d F̄ v      φ̄ = −k F̄      v̄ −= d F̄ J      k̄ −= φ F̄      d̄ −= s F̄
//! ```

use nalgebra::Vector3;
use tangency_core::measure::Measure;
use tangency_core::row::{RowContext, RowGeometry};
use tangency_core::{JointRow, Scene};

use crate::joint_row::{self, JointPlace};
use crate::rotations::Rotations;
use crate::vector::{Bars, Direction};

/// Joints that are soft.
fn soft(scene: &Scene) -> impl Iterator<Item = (u32, &tangency_core::Joint)> {
    (0_u32..).zip(scene.joints()).filter(|(_, joint)| joint.softness.is_some())
}

/// Pulls the gradient by forces back.
pub(crate) fn vjp(
    context: &RowContext<'_>,
    p_bar: &[Vector3<f64>],
    rotations: &mut Rotations,
    bars: &mut Bars<'_>,
) {
    let scene = context.scene;
    for (index, joint) in soft(scene) {
        let Some(softness) = joint.softness else { continue };
        let (k, d) = (softness.stiffness, softness.damping);
        let mut place = JointPlace::new(context, index, rotations);
        for row in &joint.held {
            let shape = place.shape(row);
            let (bodies, jacobian, value) = (joint.bodies, shape.jacobian, shape.value);
            let speed = context.speed(&RowGeometry { bodies, value, jacobian });
            let pushed = |body: Option<usize>| match body {
                Some(body) if scene.is_dynamic(body) => p_bar[body],
                _ => Vector3::zeros(),
            };
            let pushed = bodies.map(pushed);
            let force_bar = jacobian[0].dot(&pushed[0]) + jacobian[1].dot(&pushed[1]);
            let force = -k * value - d * speed;
            let mut j_bar = pushed.map(|side| side * force);
            for (side, body) in bodies.iter().enumerate() {
                let Some(body) = *body else { continue };
                j_bar[side] -= context.v[body] * (d * force_bar);
                bars.state.v[body] -= jacobian[side] * (d * force_bar);
            }
            place.add_row(&row.measure, &j_bar, -k * force_bar);
            let by = &mut bars.scene.joints[index as usize];
            by.stiffness -= value * force_bar;
            by.damping -= speed * force_bar;
            if row.measure == Measure::Length {
                by.length += k * force_bar;
            }
        }
        place.pull_back(bars);
    }
}

/// Adds the change of the forces.
pub(crate) fn jvp(context: &RowContext<'_>, along: &Direction<'_>, p: &mut [Vector3<f64>]) {
    for (index, joint) in soft(context.scene) {
        joint.held.iter().for_each(|row| row_jvp(context, index, *row, along, p));
    }
}

fn row_jvp(
    context: &RowContext<'_>,
    joint: u32,
    row: JointRow,
    along: &Direction<'_>,
    p: &mut [Vector3<f64>],
) {
    let scene = context.scene;
    let Some(softness) = scene.joints()[joint as usize].softness else { return };
    let (k, d) = (softness.stiffness, softness.damping);
    let by = &along.scene.joints[joint as usize];
    let geometry = context.joint_geometry(joint, row);
    let (dj, mut d_value) = joint_row::geometry_jvp(context, joint, row, along);
    if row.measure == Measure::Length {
        d_value -= by.length;
    }
    let side = |k: usize| -> Vector3<f64> { dj.fixed_rows::<3>(3 * k).into() };
    let (speed, mut d_speed) = (context.speed(&geometry), 0.0);
    for (s, body) in geometry.bodies.iter().enumerate() {
        if let Some(body) = *body {
            d_speed += side(s).dot(&context.v[body]);
            d_speed += geometry.jacobian[s].dot(&along.state.v[body]);
        }
    }
    let force = -k * geometry.value - d * speed;
    let d_force = -by.stiffness * geometry.value - k * d_value - by.damping * speed - d * d_speed;
    for (s, body) in geometry.bodies.iter().enumerate() {
        if let Some(body) = body.filter(|body| scene.is_dynamic(*body)) {
            p[body] += geometry.jacobian[s] * d_force + side(s) * force;
        }
    }
}
