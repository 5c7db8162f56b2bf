//! Derivatives of one step: the step read backwards (VJP), and along (JVP).
//!
//! ```text
//!  p = M v + dt f(q)         v⁺ = LCP(M, p, rows(q, v))        q̃ = q + dt v⁺
//!  w = LCP(M, 0, rows(q̃))    q⁺ = q̃ + dt w                     (only where positions were mended)
//! ```

use nalgebra::{Vector3, Vector4};
use tangency_collision::Contact;
use tangency_core::row::{RowContext, Stage};
use tangency_core::{IslandRecord, PostRecord, Scene, State, StepRecord};

use crate::contact_row::{ContactBars, contact_jvp};
use crate::error::DiffError;
use crate::lcp::{lcp_jvp, lcp_vjp};
use crate::report::GradientReport;
use crate::vector::{SceneVector, StateVector};
use crate::{island, momentum};

/// Pulls `after_bar` = ∂L/∂(state after the step) back: returns ∂L/∂(state before), and adds to
/// `control` (one number per channel), `out` and `report`.
///
/// # Errors
/// [`DiffError`] where an island's adjoint system cannot be solved.
pub fn step_vjp(
    scene: &Scene,
    before: &State,
    record: &StepRecord,
    after_bar: &StateVector,
    control: &mut [f64],
    out: &mut SceneVector,
    report: &mut GradientReport,
) -> Result<StateVector, DiffError> {
    let dt = scene.dt();
    let mut moved_bar = after_bar.clone();
    if let Some(post) = &record.post {
        post_vjp(scene, record, post, &mut moved_bar, control, out, report)?;
    }
    // q̃ = q + dt v⁺, time⁺ = time + dt
    let mut v_bar = moved_bar.v;
    for ((v_bar, q_bar), v) in v_bar.iter_mut().zip(&moved_bar.q).zip(&record.after.v) {
        *v_bar += q_bar * dt;
        out.dt += q_bar.dot(v);
    }
    out.dt += moved_bar.time;
    let mut before_bar =
        StateVector { time: moved_bar.time, q: moved_bar.q, v: vec![Vector3::zeros(); v_bar.len()] };

    // v⁺ from the islands, from p/m in free flight, or driven.
    let context = velocity_context(scene, before, record);
    let mut p_bar = free_flight_vjp(scene, record, &v_bar, &mut before_bar, out);
    let mut contacts = ContactBars::new(record.contacts.len());
    for island in &record.islands {
        let seed = gather(&island.bodies, &v_bar);
        let (problem_bar, lcp_report) = lcp_vjp(&island.problem, &island.solution, &seed, None)?;
        report.add(island, &lcp_report);
        for (body, bar) in island.bodies.iter().zip(&problem_bar.momentum) {
            p_bar[*body as usize] += bar;
        }
        let bars = &mut contacts;
        island::vjp(&context, island, &problem_bar, bars, &mut before_bar, control, out);
    }
    contacts.pull_back(&context, &mut before_bar, out);
    momentum::vjp(&context, before.time, &p_bar, &mut before_bar, control, out);
    Ok(before_bar)
}

/// The change of the state after the step along a direction of what it depends on.
///
/// # Errors
/// As [`step_vjp`].
pub fn step_jvp(
    scene: &Scene,
    before: &State,
    record: &StepRecord,
    d_before: &StateVector,
    d_control: &[f64],
    along: &SceneVector,
) -> Result<StateVector, DiffError> {
    let dt = scene.dt();
    let context = velocity_context(scene, before, record);
    let dp = momentum::jvp(&context, before.time, d_before, d_control, along);
    let mut d_after = d_before.clone();
    d_after.time += along.dt;
    let bound = bodies_with_rows(scene, &record.islands);
    for i in (0..bound.len()).filter(|i| scene.is_dynamic(*i) && !bound[*i]) {
        let dm = along.bodies[i].mass.component_mul(&record.after.v[i]);
        d_after.v[i] = (dp[i] - dm).component_div(&scene.bodies()[i].mass);
    }
    let contacts = contact_changes(&context, d_before, along);
    for island in &record.islands {
        let change =
            island::jvp(&context, island, &contacts, &dp, d_before, d_control, along);
        let (dv, _) = lcp_jvp(&island.problem, &island.solution, &change)?;
        scatter(&island.bodies, &dv, &mut d_after.v);
    }
    for i in 0..bound.len() {
        let dv = d_after.v[i];
        d_after.q[i] += dv * dt + record.after.v[i] * along.dt;
    }
    if let Some(post) = &record.post {
        post_jvp(scene, record, post, &mut d_after, along)?;
    }
    Ok(d_after)
}

fn velocity_context<'a>(
    scene: &'a Scene,
    before: &'a State,
    record: &'a StepRecord,
) -> RowContext<'a> {
    let (q, v, stage) = (&before.q, &before.v, Stage::Velocity);
    let (control, contacts) = (&record.control, &record.contacts);
    RowContext { scene, stage, q, v, control, contacts }
}

fn post_context<'a>(
    scene: &'a Scene,
    record: &'a StepRecord,
    post: &'a PostRecord,
) -> RowContext<'a> {
    let (q, v, stage) = (&post.moved, &record.after.v, Stage::Post);
    let (control, contacts) = (&record.control, &post.contacts);
    RowContext { scene, stage, q, v, control, contacts }
}

/// q⁺ = q̃ + dt w: turns `bar` by q⁺ into that by q̃.
fn post_vjp(
    scene: &Scene,
    record: &StepRecord,
    post: &PostRecord,
    bar: &mut StateVector,
    control: &mut [f64],
    out: &mut SceneVector,
    report: &mut GradientReport,
) -> Result<(), DiffError> {
    let context = post_context(scene, record, post);
    let mut contacts = ContactBars::new(post.contacts.len());
    let q_bar = bar.q.clone();
    for island in &post.islands {
        let mut seed = gather(&island.bodies, &q_bar);
        for (seed, w) in seed.iter_mut().zip(&island.solution.velocities) {
            out.dt += seed.dot(w);
            *seed *= scene.dt();
        }
        let (problem_bar, lcp_report) = lcp_vjp(&island.problem, &island.solution, &seed, None)?;
        report.add(island, &lcp_report);
        island::vjp(&context, island, &problem_bar, &mut contacts, bar, control, out);
    }
    contacts.pull_back(&context, bar, out);
    Ok(())
}

fn post_jvp(
    scene: &Scene,
    record: &StepRecord,
    post: &PostRecord,
    d_after: &mut StateVector,
    along: &SceneVector,
) -> Result<(), DiffError> {
    let context = post_context(scene, record, post);
    let d_moved = d_after.clone();
    let contacts = contact_changes(&context, &d_moved, along);
    let still = vec![Vector3::zeros(); d_moved.q.len()];
    let no_control = vec![0.0; record.control.len()];
    for island in &post.islands {
        let change =
            island::jvp(&context, island, &contacts, &still, &d_moved, &no_control, along);
        let (dw, _) = lcp_jvp(&island.problem, &island.solution, &change)?;
        for ((body, dw), w) in island.bodies.iter().zip(&dw).zip(&island.solution.velocities) {
            d_after.q[*body as usize] += dw * scene.dt() + w * along.dt;
        }
    }
    Ok(())
}

/// v⁺ = p/m for bodies without rows, v⁺ = v for bodies without unknowns; returns ∂L/∂p.
fn free_flight_vjp(
    scene: &Scene,
    record: &StepRecord,
    v_bar: &[Vector3<f64>],
    before: &mut StateVector,
    out: &mut SceneVector,
) -> Vec<Vector3<f64>> {
    let bound = bodies_with_rows(scene, &record.islands);
    let mut p_bar = vec![Vector3::zeros(); v_bar.len()];
    for (i, body) in scene.bodies().iter().enumerate() {
        if !scene.is_dynamic(i) {
            before.v[i] += v_bar[i];
        } else if !bound[i] {
            p_bar[i] = v_bar[i].component_div(&body.mass);
            out.bodies[i].mass -= p_bar[i].component_mul(&record.after.v[i]);
        }
    }
    p_bar
}

fn bodies_with_rows(scene: &Scene, islands: &[IslandRecord]) -> Vec<bool> {
    let mut bound = vec![false; scene.bodies().len()];
    islands.iter().flat_map(|i| &i.bodies).for_each(|b| bound[*b as usize] = true);
    bound
}

fn contact_changes(
    context: &RowContext<'_>,
    d_state: &StateVector,
    along: &SceneVector,
) -> Vec<Vector4<f64>> {
    let change = |contact: &Contact| contact_jvp(context, contact, d_state, along);
    context.contacts.iter().map(change).collect()
}

fn gather(bodies: &[u32], from: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    bodies.iter().map(|b| from[*b as usize]).collect()
}

fn scatter(bodies: &[u32], from: &[Vector3<f64>], to: &mut [Vector3<f64>]) {
    bodies.iter().zip(from).for_each(|(b, x)| to[*b as usize] = *x);
}
