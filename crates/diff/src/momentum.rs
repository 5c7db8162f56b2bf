//! Derivatives of p = M v⁻ + dt f.
//!
//! ```text
//!  p_i = M_i (v_i + dt g s_i) + Σ overlap · wrench + dt u e_component + dt u J_freeᵀ
//! ```
//!
//! In smooth flows p is the force alone: M v is left out, dt is 1, a force in time acts or does not, and soft
//! joints pull.

use nalgebra::Vector3;
use tangency_core::momentum::{acts, overlap};
use tangency_core::row::RowContext;
use tangency_core::{Control, Force, JointRow, Scene};

use crate::joint_row::{self, JointPlace};
use crate::rotations::Rotations;
use crate::spring;
use crate::vector::{Bars, Direction};

/// Pulls ∂L/∂p back onto state, control and scene.
pub(crate) fn vjp(
    context: &RowContext<'_>,
    time: f64,
    p_bar: &[Vector3<f64>],
    rotations: &mut Rotations,
    bars: &mut Bars<'_>,
) {
    let scene = context.scene;
    let moves = !context.bends();
    for (i, body) in scene.bodies().iter().enumerate().filter(|(i, _)| scene.is_dynamic(*i)) {
        let (g, p_bar) = (gravity(scene, i), &p_bar[i]);
        if moves {
            bars.state.v[i] += body.mass.component_mul(p_bar);
        }
        let v = if moves { context.v[i] } else { Vector3::zeros() };
        bars.scene.bodies[i].mass += p_bar.component_mul(&(v + g * context.dt));
        bars.scene.gravity += p_bar.xy() * (body.mass.x * context.dt * body.gravity_scale);
        bars.scene.dt += p_bar.dot(&body.mass.component_mul(&g));
    }
    for (k, force) in scene.forces().iter().enumerate().filter(|(_, f)| scene.is_dynamic(f.body)) {
        let (lasts, by_time, by_dt) = lasting(context, force, time);
        let power = force.wrench.dot(&p_bar[force.body]);
        bars.scene.forces[k] += p_bar[force.body] * lasts;
        bars.state.time += by_time * power;
        bars.scene.dt += by_dt * power;
    }
    for (channel, (input, u)) in scene.controls().iter().zip(context.control).enumerate() {
        match *input {
            Control::Wrench { body, component } => {
                bars.control[channel] += context.dt * p_bar[body][component];
                bars.scene.dt += u * p_bar[body][component];
            }
            Control::JointForce { joint } => {
                let (index, free) = free_row(scene, joint);
                let mut place = JointPlace::new(context, index, rotations);
                let shape = place.shape(&free);
                let pushed = |body: Option<usize>| match body {
                    Some(body) if scene.is_dynamic(body) => p_bar[body],
                    _ => Vector3::zeros(),
                };
                let sides = place.bodies().map(pushed);
                let [j_a, j_b] = &shape.jacobian;
                let power = j_a.dot(&sides[0]) + j_b.dot(&sides[1]);
                bars.control[channel] += context.dt * power;
                bars.scene.dt += u * power;
                let j_bar = sides.map(|side| side * (context.dt * u));
                place.add_row(&free.measure, &j_bar, 0.0);
                place.pull_back(bars);
            }
            Control::MotorSpeed { .. } => {}
        }
    }
    if !moves {
        spring::vjp(context, p_bar, rotations, bars);
    }
}

/// The change of p along a direction.
pub(crate) fn jvp(context: &RowContext<'_>, time: f64, along: &Direction<'_>) -> Vec<Vector3<f64>> {
    let scene = context.scene;
    let mut p = vec![Vector3::zeros(); scene.bodies().len()];
    for (i, body) in scene.bodies().iter().enumerate().filter(|(i, _)| scene.is_dynamic(*i)) {
        let (g, dt) = (gravity(scene, i), context.dt);
        let dg = along.scene.gravity * body.gravity_scale;
        let moves = if context.bends() { 0.0 } else { 1.0 };
        let gained = Vector3::new(dg.x, dg.y, 0.0) * dt + g * along.scene.dt;
        let dv = along.state.v[i] * moves + gained;
        let dm = along.scene.bodies[i].mass.component_mul(&(context.v[i] * moves + g * dt));
        p[i] = body.mass.component_mul(&dv) + dm;
    }
    for (k, force) in scene.forces().iter().enumerate().filter(|(_, f)| scene.is_dynamic(f.body)) {
        let (lasts, by_time, by_dt) = lasting(context, force, time);
        p[force.body] += along.scene.forces[k] * lasts;
        p[force.body] += force.wrench * (by_time * along.state.time + by_dt * along.scene.dt);
    }
    for (channel, (input, u)) in scene.controls().iter().zip(context.control).enumerate() {
        let rate = context.dt * along.control[channel] + along.scene.dt * u;
        match *input {
            Control::Wrench { body, component } => p[body][component] += rate,
            Control::JointForce { joint } => {
                let (index, free) = free_row(scene, joint);
                let row = context.joint_geometry(index, free);
                let (dj, _) = joint_row::geometry_jvp(context, index, free, along);
                for (s, j) in row.jacobian.iter().enumerate() {
                    if let Some(b) = row.bodies[s].filter(|b| scene.is_dynamic(*b)) {
                        p[b] += j * rate + dj.fixed_rows::<3>(3 * s) * (context.dt * u);
                    }
                }
            }
            Control::MotorSpeed { .. } => {}
        }
    }
    if context.bends() {
        spring::jvp(context, along, &mut p);
    }
    p
}

/// How long a force acts, s, and that by (time, dt).
fn lasting(context: &RowContext<'_>, force: &Force, time: f64) -> (f64, f64, f64) {
    if context.bends() {
        return (f64::from(u8::from(acts(force, time))), 0.0, 0.0);
    }
    let (by_time, by_dt) = overlap_derivative(force, time, context.dt);
    (overlap(force, time, context.dt), by_time, by_dt)
}

fn gravity(scene: &Scene, i: usize) -> Vector3<f64> {
    let g = scene.gravity() * scene.bodies()[i].gravity_scale;
    Vector3::new(g.x, g.y, 0.0)
}

fn free_row(scene: &Scene, joint: usize) -> (u32, JointRow) {
    let free = scene.joints()[joint].free.expect("checked when the scene was built");
    (u32::try_from(joint).expect("fewer joints than u32 counts"), free)
}

/// By (time, dt) of min(end, time + dt) − max(start, time) where that is positive.
fn overlap_derivative(force: &Force, time: f64, dt: f64) -> (f64, f64) {
    if overlap(force, time, dt) <= 0.0 {
        return (0.0, 0.0);
    }
    let runs_on = if force.end > time + dt { 1.0 } else { 0.0 };
    let had_begun = if force.start < time { 1.0 } else { 0.0 };
    (runs_on - had_begun, runs_on)
}
