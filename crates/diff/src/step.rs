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
use crate::vector::{Bars, Direction, SceneVector, StateVector};
use crate::{island, momentum, sizes};

/// Pulls `after_bar` = ∂L/∂(state after the step) back: returns ∂L/∂(state before), and adds to
/// `control` (one number per channel), `out` and `report`.
///
/// # Errors
/// [`DiffError`] where an island's adjoint system cannot be solved, or where vectors do not fit the
/// scene or are not finite.
pub fn step_vjp(
    scene: &Scene,
    before: &State,
    record: &StepRecord,
    after_bar: &StateVector,
    control: &mut [f64],
    out: &mut SceneVector,
    report: &mut GradientReport,
) -> Result<StateVector, DiffError> {
    sizes::state_vector("the gradient by a state", scene, after_bar)?;
    sizes::length("the gradient by a control", scene.controls().len(), control.len())?;
    let mut bars = Bars { state: after_bar.clone(), control, scene: out };
    if let Some(post) = &record.post {
        post_vjp(scene, record, post, &mut bars, report)?;
    }
    // q̃ = q + dt v⁺, time⁺ = time + dt
    let still = vec![Vector3::zeros(); bars.state.v.len()];
    let mut v_bar = std::mem::replace(&mut bars.state.v, still);
    for ((v_bar, q_bar), v) in v_bar.iter_mut().zip(&bars.state.q).zip(&record.after.v) {
        *v_bar += q_bar * scene.dt();
        bars.scene.dt += q_bar.dot(v);
    }
    bars.scene.dt += bars.state.time;

    // v⁺ from the islands, from p/m in free flight, or driven.
    let context = velocity_context(scene, before, record);
    let mut p_bar = free_flight_vjp(scene, record, &v_bar, &mut bars);
    let mut contacts = ContactBars::new(record.contacts.len());
    for island in &record.islands {
        let seed = gather(&island.bodies, &v_bar);
        let (problem_bar, lcp_report) = lcp_vjp(&island.problem, &island.solution, &seed, None)?;
        report.add(island, &lcp_report);
        report.add_bounces(&context, island);
        for (body, bar) in island.bodies.iter().zip(&problem_bar.momentum) {
            p_bar[*body as usize] += bar;
        }
        island::vjp(&context, island, problem_bar, &mut contacts, &mut bars);
    }
    contacts.pull_back(&context, &mut bars);
    momentum::vjp(&context, before.time, &p_bar, &mut bars);
    sizes::state_vector("the gradient by a state", scene, &bars.state)?;
    sizes::finite("the gradient by a control", bars.control.iter().all(|u| u.is_finite()))?;
    Ok(bars.state)
}

/// The change of the state after the step along a direction of what it depends on.
///
/// # Errors
/// As [`step_vjp`].
pub fn step_jvp(
    scene: &Scene,
    before: &State,
    record: &StepRecord,
    along: &Direction<'_>,
) -> Result<StateVector, DiffError> {
    sizes::direction(scene, along)?;
    let context = velocity_context(scene, before, record);
    let dp = momentum::jvp(&context, before.time, along);
    let mut d_after = along.state.clone();
    d_after.time += along.scene.dt;
    let bound = bodies_with_rows(scene, &record.islands);
    for i in (0..bound.len()).filter(|i| scene.is_dynamic(*i) && !bound[*i]) {
        let dm = along.scene.bodies[i].mass.component_mul(&record.after.v[i]);
        d_after.v[i] = (dp[i] - dm).component_div(&scene.bodies()[i].mass);
    }
    let contacts = contact_changes(&context, along);
    for island in &record.islands {
        let change = island::jvp(&context, island, &contacts, &dp, along);
        let (dv, _) = lcp_jvp(&island.problem, &island.solution, &change)?;
        scatter(&island.bodies, &dv, &mut d_after.v);
    }
    for i in 0..bound.len() {
        let dv = d_after.v[i];
        d_after.q[i] += dv * scene.dt() + record.after.v[i] * along.scene.dt;
    }
    if let Some(post) = &record.post {
        post_jvp(scene, record, post, &mut d_after, along.scene)?;
    }
    sizes::state_vector("the change of a state", scene, &d_after)?;
    Ok(d_after)
}

fn velocity_context<'a>(
    scene: &'a Scene,
    before: &'a State,
    record: &'a StepRecord,
) -> RowContext<'a> {
    let (q, v, stage) = (&before.q, &before.v, Stage::Velocity);
    let (control, contacts) = (&record.control, &record.contacts);
    RowContext { scene, stage, q, v, control, contacts, loose: &[] }
}

fn post_context<'a>(
    scene: &'a Scene,
    record: &'a StepRecord,
    post: &'a PostRecord,
) -> RowContext<'a> {
    let (q, v, stage) = (&post.moved, &record.after.v, Stage::Post);
    let (control, contacts, loose) = (&record.control, &post.contacts, &post.loose);
    RowContext { scene, stage, q, v, control, contacts, loose }
}

/// q⁺ = q̃ + dt w: turns the gradient by q⁺ into that by q̃.
fn post_vjp(
    scene: &Scene,
    record: &StepRecord,
    post: &PostRecord,
    bars: &mut Bars<'_>,
    report: &mut GradientReport,
) -> Result<(), DiffError> {
    let context = post_context(scene, record, post);
    let mut contacts = ContactBars::new(post.contacts.len());
    let q_bar = bars.state.q.clone();
    for island in &post.islands {
        let mut seed = gather(&island.bodies, &q_bar);
        for (seed, w) in seed.iter_mut().zip(&island.solution.velocities) {
            bars.scene.dt += seed.dot(w);
            *seed *= scene.dt();
        }
        let (problem_bar, lcp_report) = lcp_vjp(&island.problem, &island.solution, &seed, None)?;
        report.add(island, &lcp_report);
        island::vjp(&context, island, problem_bar, &mut contacts, bars);
    }
    contacts.pull_back(&context, bars);
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
    let no_control = vec![0.0; record.control.len()];
    let direction = Direction { state: &d_moved, control: &no_control, scene: along };
    let contacts = contact_changes(&context, &direction);
    let still = vec![Vector3::zeros(); d_moved.q.len()];
    for island in &post.islands {
        let change = island::jvp(&context, island, &contacts, &still, &direction);
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
    bars: &mut Bars<'_>,
) -> Vec<Vector3<f64>> {
    let bound = bodies_with_rows(scene, &record.islands);
    let mut p_bar = vec![Vector3::zeros(); v_bar.len()];
    for (i, body) in scene.bodies().iter().enumerate() {
        if !scene.is_dynamic(i) {
            bars.state.v[i] += v_bar[i];
        } else if !bound[i] {
            p_bar[i] = v_bar[i].component_div(&body.mass);
            bars.scene.bodies[i].mass -= p_bar[i].component_mul(&record.after.v[i]);
        }
    }
    p_bar
}

fn bodies_with_rows(scene: &Scene, islands: &[IslandRecord]) -> Vec<bool> {
    let mut bound = vec![false; scene.bodies().len()];
    islands.iter().flat_map(|i| &i.bodies).for_each(|b| bound[*b as usize] = true);
    bound
}

fn contact_changes(context: &RowContext<'_>, along: &Direction<'_>) -> Vec<Vector4<f64>> {
    let change = |contact: &Contact| contact_jvp(context, contact, along);
    context.contacts.iter().map(change).collect()
}

fn gather(bodies: &[u32], from: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    bodies.iter().map(|b| from[*b as usize]).collect()
}

fn scatter(bodies: &[u32], from: &[Vector3<f64>], to: &mut [Vector3<f64>]) {
    bodies.iter().zip(from).for_each(|(b, x)| to[*b as usize] = *x);
}
