//! Derivatives of one step: the step read backwards (VJP), and along (JVP).
//!
//! ```text
//!  p = M v + dt f(q)         v⁺ = LCP(M, p, rows(q, v))        q̃ = q + dt v⁺
//!  w = LCP(M, 0, rows(q̃))    q̃ ← q̃ + dt w       (once for each displacement)      q⁺ = q̃
//! ```

use nalgebra::{Vector3, Vector4};
use tangency_collision::Contact;
use tangency_core::row::RowContext;
use tangency_core::{IslandRecord, Motion, PostRecord, Scene, State, StepRecord};

use crate::contact_row::contact_jvp;
use crate::error::DiffError;
use crate::impulse::RowImpulse;
use crate::lcp::lcp_jvp;
use crate::report::GradientReport;
use crate::reverse::Reverse;
use crate::vector::{Bars, Direction, SceneVector, StateVector};
use crate::{division, impulse, island, momentum, sizes, smooth};

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
    let mut state = after_bar.clone();
    let mut bars = Bars { state: &mut state, control, scene: out };
    Reverse::default().step(scene, before, record, &mut bars, report)?;
    Ok(state)
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
    step_jvp_with_impulses(scene, before, record, along).map(|(d_after, _)| d_after)
}

/// The same, with the changes of the step's impulses, row by row.
pub(crate) fn step_jvp_with_impulses(
    scene: &Scene,
    before: &State,
    record: &StepRecord,
    along: &Direction<'_>,
) -> Result<(StateVector, Vec<RowImpulse>), DiffError> {
    sizes::direction(scene, along)?;
    let mut impulses = Vec::new();
    let d_after = division::jvp(scene, before, record, along, &mut impulses)?;
    sizes::state_vector("the change of a state", scene, &d_after)?;
    Ok((d_after, impulses))
}

/// The same of a step that is not divided, or of a part of one; `along.scene.dt` is the change of its
/// length. Adds the changes of its impulses to `impulses`.
pub(crate) fn part_jvp(
    scene: &Scene,
    before: &State,
    record: &StepRecord,
    along: &Direction<'_>,
    part: Option<usize>,
    impulses: &mut Vec<RowImpulse>,
) -> Result<StateVector, DiffError> {
    if let Some(smooth) = &record.smooth {
        return smooth::jvp(scene, record, smooth, along, part, impulses);
    }
    let context = record.velocity_context(scene, before);
    let midway = (record.motion == Motion::Flow).then(|| midway_jvp(before, record, along));
    let at_rows = Direction { state: midway.as_ref().unwrap_or(along.state), ..*along };
    let dp = momentum::jvp(&context, before.time, &at_rows);
    let mut d_after = along.state.clone();
    d_after.time += along.scene.dt;
    let bound = bodies_with_rows(scene, &record.islands);
    for i in (0..bound.len()).filter(|i| scene.is_dynamic(*i) && !bound[*i]) {
        let dm = along.scene.bodies[i].mass.component_mul(&record.after.v[i]);
        d_after.v[i] = (dp[i] - dm).component_div(&scene.bodies()[i].mass);
    }
    let contacts = contact_changes(&context, &at_rows);
    for island in &record.islands {
        let change = island::jvp(&context, island, &contacts, &dp, &at_rows);
        let (dv, pushed) = lcp_jvp(&island.problem, &island.solution, &change)?;
        impulse::list(part, island, &pushed, impulses);
        scatter(&island.bodies, &dv, &mut d_after.v);
    }
    for (i, v) in record.after.v.iter().enumerate() {
        let (dv, dt) = (d_after.v[i], along.scene.dt);
        d_after.q[i] += match record.motion {
            Motion::Fixed => dv * record.dt + v * dt,
            Motion::Flow => {
                (along.state.v[i] + dv) * (0.5 * record.dt) + (before.v[i] + v) * (0.5 * dt)
            }
            Motion::Impact | Motion::Projection | Motion::Smooth => Vector3::zeros(),
        };
    }
    for post in &record.post {
        post_jvp(scene, record, post, &mut d_after, along.scene)?;
    }
    Ok(d_after)
}

/// The change of the poses q + ½ h v⁻ at which a flow evaluates its rows, and of v⁻.
fn midway_jvp(before: &State, record: &StepRecord, along: &Direction<'_>) -> StateVector {
    let mut midway = along.state.clone();
    for (i, q) in midway.q.iter_mut().enumerate() {
        *q += along.state.v[i] * (0.5 * record.dt) + before.v[i] * (0.5 * along.scene.dt);
    }
    midway
}

pub(crate) fn post_jvp(
    scene: &Scene,
    record: &StepRecord,
    post: &PostRecord,
    d_after: &mut StateVector,
    along: &SceneVector,
) -> Result<(), DiffError> {
    let context = record.post_context(scene, post);
    let d_moved = d_after.clone();
    let no_control = vec![0.0; record.control.len()];
    let direction = Direction { state: &d_moved, control: &no_control, scene: along };
    let contacts = contact_changes(&context, &direction);
    let still = vec![Vector3::zeros(); d_moved.q.len()];
    for island in &post.islands {
        let change = island::jvp(&context, island, &contacts, &still, &direction);
        let (dw, _) = lcp_jvp(&island.problem, &island.solution, &change)?;
        for ((body, dw), w) in island.bodies.iter().zip(&dw).zip(&island.solution.velocities) {
            d_after.q[*body as usize] += dw * record.dt + w * along.dt;
        }
    }
    Ok(())
}

pub(crate) fn bodies_with_rows(scene: &Scene, islands: &[IslandRecord]) -> Vec<bool> {
    let mut bound = vec![false; scene.bodies().len()];
    islands.iter().flat_map(|i| &i.bodies).for_each(|b| bound[*b as usize] = true);
    bound
}

pub(crate) fn contact_changes(
    context: &RowContext<'_>,
    along: &Direction<'_>,
) -> Vec<Vector4<f64>> {
    let change = |contact: &Contact| contact_jvp(context, contact, along);
    context.contacts.iter().map(change).collect()
}

pub(crate) fn scatter(bodies: &[u32], from: &[Vector3<f64>], to: &mut [Vector3<f64>]) {
    bodies.iter().zip(from).for_each(|(b, x)| to[*b as usize] = *x);
}
