//! Momentum without the impulses of contacts and joints: p = M v⁻ + dt f.

use nalgebra::Vector3;

use crate::frames::Frames;
use crate::model::{Control, Force};
use crate::row::RowContext;
use crate::scene::Scene;

/// p per body, (N·s, N·s, N·m·s); zero for bodies without unknowns.
#[must_use]
pub fn momentum(context: &RowContext<'_>, time: f64) -> Vec<Vector3<f64>> {
    let (mut p, mut frames) = (Vec::new(), Frames::default());
    frames.place(context.q);
    momentum_into(context, &frames, time, &mut p);
    p
}

/// The same into memory that is used again, where the frames of the context's poses are at hand.
pub(crate) fn momentum_into(
    context: &RowContext<'_>,
    frames: &Frames,
    time: f64,
    p: &mut Vec<Vector3<f64>>,
) {
    let scene = context.scene;
    p.clear();
    p.extend((0..scene.bodies.len()).map(|i| inertial(context, i)));
    for force in &scene.forces {
        p[force.body] += force.wrench * overlap(force, time, context.dt);
    }
    add_controls(context, frames, p);
    hold_others(scene, p);
}

/// The forces f(q, v) that act at the context's state, (N, N, N·m), into memory that is used again; of
/// those in time the ones that act at `time`.
pub(crate) fn forces_into(
    context: &RowContext<'_>,
    frames: &Frames,
    time: f64,
    f: &mut Vec<Vector3<f64>>,
) {
    let scene = context.scene;
    f.clear();
    f.extend((0..scene.bodies.len()).map(|i| weight(scene, i)));
    for force in scene.forces.iter().filter(|force| acts(force, time)) {
        f[force.body] += force.wrench;
    }
    add_controls(context, frames, f);
    for (joint, _) in (0_u32..).zip(&scene.joints).filter(|(_, joint)| joint.softness.is_some()) {
        add_spring(context, joint, f);
    }
    hold_others(scene, f);
}

fn add_controls(context: &RowContext<'_>, frames: &Frames, p: &mut [Vector3<f64>]) {
    let scene = context.scene;
    for (control, u) in scene.controls.iter().zip(context.control) {
        match *control {
            Control::Wrench { body, component } => p[body][component] += context.dt * u,
            Control::JointForce { joint } => add_joint_force(context, frames, joint, *u, p),
            Control::MotorSpeed { .. } => {}
        }
    }
}

/// Nothing moves bodies without unknowns.
fn hold_others(scene: &Scene, p: &mut [Vector3<f64>]) {
    for (i, p) in p.iter_mut().enumerate().filter(|(i, _)| !scene.is_dynamic(*i)) {
        debug_assert!(scene.bodies[i].mass == Vector3::zeros());
        *p = Vector3::zeros();
    }
}

/// M v + dt M g.
fn inertial(context: &RowContext<'_>, i: usize) -> Vector3<f64> {
    let Scene { bodies, gravity, .. } = context.scene;
    let body = &bodies[i];
    let g = gravity * body.gravity_scale;
    body.mass.component_mul(&(context.v[i] + Vector3::new(g.x, g.y, 0.0) * context.dt))
}

/// M g.
fn weight(scene: &Scene, i: usize) -> Vector3<f64> {
    let body = &scene.bodies[i];
    let g = scene.gravity * body.gravity_scale;
    body.mass.component_mul(&Vector3::new(g.x, g.y, 0.0))
}

/// Whether a force acts at a time.
#[must_use]
pub fn acts(force: &Force, time: f64) -> bool {
    force.start <= time && time < force.end
}

/// −k φ − d J v along every row of a soft joint.
fn add_spring(context: &RowContext<'_>, joint: u32, f: &mut [Vector3<f64>]) {
    let it = context.joint(joint);
    let Some(softness) = it.softness else { return };
    for row in &it.held {
        let geometry = context.joint_geometry(joint, *row);
        let speed = context.speed(&geometry);
        let pull = -softness.stiffness * geometry.value - softness.damping * speed;
        for (body, j) in geometry.bodies.iter().zip(geometry.jacobian) {
            if let Some(body) = body {
                f[*body] += j * pull;
            }
        }
    }
}

/// How long a force acts within the step that begins at `time`, s.
#[must_use]
pub fn overlap(force: &Force, time: f64, dt: f64) -> f64 {
    (force.end.min(time + dt) - force.start.max(time)).max(0.0)
}

fn add_joint_force(
    context: &RowContext<'_>,
    frames: &Frames,
    joint: usize,
    u: f64,
    p: &mut [Vector3<f64>],
) {
    let free = context.scene.joints[joint].free.expect("checked when the scene was built");
    let index = u32::try_from(joint).expect("fewer joints than u32 counts");
    let row = context.joint_geometry_in(index, free, frames);
    for (body, j) in row.bodies.iter().zip(row.jacobian) {
        if let Some(body) = body {
            p[*body] += j * (context.dt * u);
        }
    }
}
