//! One time step.
//!
//! ```text
//!  contacts and limits in reach  →  islands  →  v⁺ = M⁻¹(p + Σ Jᵢᵀ λᵢ)  →  q⁺ = q + dt v⁺
//! ```
//!
//! (or, where impacts are located, several such parts, see [`Motion`]) and, only where positions are then
//! wrong by more than rounding, displacements of least mass-weighted size that mend them: q⁺ += dt w.

use nalgebra::Vector3;
use tangency_collision::Contact;
use tangency_lcp::LcpSolver;

use crate::island::{Island, assemble};
use crate::mend::mend_positions;
use crate::momentum::momentum_into;
use crate::motion::Motion;
use crate::record::{IslandRecord, StepRecord};
use crate::resolve::Division;
use crate::row::RowContext;
use crate::scene::Scene;
use crate::scratch::StepScratch;
use crate::solve::solve;
use crate::{State, StepError, Stepping};

/// Advances `state` by one step under `control` (one number per control channel).
///
/// # Errors
/// A [`StepError`] where sizes do not fit, numbers are not finite, or the complementarity problem
/// was not solved to the scene's tolerance.
pub fn step(
    scene: &Scene,
    solver: &dyn LcpSolver,
    state: &State,
    control: &[f64],
    scratch: &mut StepScratch,
) -> Result<StepRecord, StepError> {
    advance(scene, solver, state, None, control, scratch)
}

/// The step after `before`: as [`step`] from the state that it left, with the modes of its rows as a
/// first guess.
///
/// The guess saves work. It changes what is found at most among solutions that are equally good: single
/// impulses of rows that depend on each other, and the last digits.
///
/// # Errors
/// As [`step`].
pub fn next_step(
    scene: &Scene,
    solver: &dyn LcpSolver,
    before: &StepRecord,
    control: &[f64],
    scratch: &mut StepScratch,
) -> Result<StepRecord, StepError> {
    advance(scene, solver, &before.after, Some(before), control, scratch)
}

/// The step from `state`, which `before` left if there was a step before.
pub(crate) fn advance(
    scene: &Scene,
    solver: &dyn LcpSolver,
    state: &State,
    before: Option<&StepRecord>,
    control: &[f64],
    scratch: &mut StepScratch,
) -> Result<StepRecord, StepError> {
    check_input(scene, state, control)?;
    match scene.def.stepping {
        Stepping::Fixed => fixed(scene, solver, state, before, control, scene.dt, scratch),
        Stepping::ImpactResolved { max_impacts: most } => {
            let division = Division { scene, solver, control, most, smooth: false };
            division.step(state, before, scratch)
        }
        Stepping::Accurate { max_events: most } => {
            let division = Division { scene, solver, control, most, smooth: true };
            division.step(state, before, scratch)
        }
    }
}

/// A step of length `dt` with rows for all that is in reach.
pub(crate) fn fixed(
    scene: &Scene,
    solver: &dyn LcpSolver,
    state: &State,
    before: Option<&StepRecord>,
    control: &[f64],
    dt: f64,
    scratch: &mut StepScratch,
) -> Result<StepRecord, StepError> {
    let Setup { contacts, islands, momentum } = set_up(scene, state, control, dt, scratch)?;
    if let Some(before) = before {
        scratch.places.find(before, &contacts);
    }
    let context = RowContext::of(scene, state, control, dt);
    let context = RowContext { contacts: &contacts, ..context };
    let islands = solve(&context, solver, state.time, before, islands, scratch)?;
    let after = integrate(&context, state, &momentum, &islands, scratch);
    scratch.vectors.give(momentum);
    let mut record = StepRecord {
        control: scratch.copy_control(control),
        motion: Motion::Fixed,
        dt,
        parts: Vec::new(),
        hit: None,
        midway: Vec::new(),
        bounces: Vec::new(),
        contacts,
        islands,
        smooth: None,
        fell_back: false,
        post: Vec::new(),
        after,
    };
    mend_positions(scene, solver, &state.q, &mut record, scratch)?;
    record.after.check(scene.bodies.len())?;
    Ok(record)
}

/// What a step is about to solve.
pub(crate) struct Setup {
    pub(crate) contacts: Vec<Contact>,
    pub(crate) islands: Vec<Island>,
    momentum: Vec<Vector3<f64>>,
}

pub(crate) fn set_up(
    scene: &Scene,
    state: &State,
    control: &[f64],
    dt: f64,
    scratch: &mut StepScratch,
) -> Result<Setup, StepError> {
    scratch.frames.place(&state.q);
    let context = RowContext::of(scene, state, control, dt);
    let mut momentum = scratch.vectors.take();
    momentum_into(&context, &scratch.frames, state.time, &mut momentum);
    let mut contacts = scratch.contacts.take();
    scratch.detection.detect(scene, state, scratch.frames.bodies(), &momentum, &mut contacts)?;
    let context = RowContext { contacts: &contacts, ..context };
    let mut rows = std::mem::take(&mut scratch.rows);
    rows.fill(&context, &scratch.frames, scratch.detection.groups());
    let islands = assemble(&context, &momentum, &mut rows, scratch);
    scratch.rows = rows;
    Ok(Setup { contacts, islands, momentum })
}

/// v⁺ from the islands, or p/m where nothing acts; q⁺ as the context's motion says.
#[inline]
pub(crate) fn integrate(
    context: &RowContext<'_>,
    state: &State,
    momentum: &[Vector3<f64>],
    islands: &[IslandRecord],
    scratch: &mut StepScratch,
) -> State {
    let (scene, dt) = (context.scene, context.dt);
    let mut after = scratch.copy(state);
    after.time += dt;
    let bound: usize = islands.iter().map(|island| island.bodies.len()).sum();
    if bound < after.v.len() {
        for (i, v) in after.v.iter_mut().enumerate().filter(|(i, _)| scene.is_dynamic(*i)) {
            *v = momentum[i].component_div(&scene.bodies[i].mass);
        }
    }
    for island in islands {
        for (body, v) in island.bodies.iter().zip(&island.solution.velocities) {
            after.v[*body as usize] = *v;
        }
    }
    let moved = after.q.iter_mut().zip(&after.v);
    match context.motion {
        Motion::Fixed => moved.for_each(|(q, v)| *q += dt * v),
        Motion::Flow => {
            moved.zip(&state.v).for_each(|((q, after), before)| *q += 0.5 * dt * (before + after));
        }
        Motion::Impact | Motion::Smooth | Motion::Projection => {}
    }
    after
}

fn check_input(scene: &Scene, state: &State, control: &[f64]) -> Result<(), StepError> {
    state.check(scene.bodies.len())?;
    let (expected, found) = (scene.controls.len(), control.len());
    if found != expected {
        return Err(StepError::ControlSize { expected, found });
    }
    match control.iter().position(|u| !u.is_finite()) {
        Some(index) => Err(StepError::NotFinite { what: "control", index }),
        None => Ok(()),
    }
}
