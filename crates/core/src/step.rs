//! One time step.
//!
//! ```text
//!  contacts and limits in reach  →  islands  →  v⁺ = M⁻¹(p + Σ Jᵢᵀ λᵢ)  →  q⁺ = q + dt v⁺
//! ```
//!
//! and, only where positions are then wrong by more than rounding, a displacement of least
//! mass-weighted size that mends them: q⁺ += dt w.

use nalgebra::Vector3;
use tangency_collision::Contact;
use tangency_lcp::{Law, Lcp, LcpError, LcpSolution, LcpSolver, Metric, Scratch, solve_checked};

use crate::detect::{Detection, rows};
use crate::island::{Island, assemble};
use crate::momentum::momentum;
use crate::record::{IslandRecord, Path, PostRecord, StepRecord};
use crate::row::{RowContext, RowSource, Stage};
use crate::scene::Scene;
use crate::{Correction, Stabilisation, State, StepError};

/// Memory that is reused between steps; it never changes a result.
#[derive(Debug, Default)]
pub struct StepScratch {
    lcp: Scratch,
    detection: Detection,
}

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
    check_input(scene, state, control)?;
    let Setup { contacts, islands, momentum } =
        set_up(scene, state, control, &mut scratch.detection)?;
    let (q, v, stage) = (&state.q, &state.v, Stage::Velocity);
    let context = RowContext { scene, stage, q, v, control, contacts: &contacts, loose: &[] };
    let islands = solve(&context, solver, state.time, islands, scratch)?;
    let after = integrate(scene, state, &momentum, &islands);
    let mut record = StepRecord { control: control.to_vec(), contacts, islands, post: None, after };
    mend_positions(scene, solver, &mut record, scratch)?;
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
    detection: &mut Detection,
) -> Result<Setup, StepError> {
    let (q, v, stage) = (&state.q, &state.v, Stage::Velocity);
    let context = RowContext { scene, stage, q, v, control, contacts: &[], loose: &[] };
    let momentum = momentum(&context, state.time);
    let mut contacts = Vec::new();
    detection.detect(scene, state, &momentum, &mut contacts)?;
    let context = RowContext { contacts: &contacts, ..context };
    let islands = assemble(&context, &momentum, &rows(&context, detection.groups()));
    Ok(Setup { contacts, islands, momentum })
}

/// Solves the islands, each in the first of its stages that has a solution.
fn solve(
    context: &RowContext<'_>,
    solver: &dyn LcpSolver,
    time: f64,
    islands: Vec<Island>,
    scratch: &mut StepScratch,
) -> Result<Vec<IslandRecord>, StepError> {
    let solve = |island| solve_island(context, solver, island, scratch);
    let named = |(bodies, source): (Vec<u32>, LcpError)| {
        let names = bodies.iter().map(|b| context.scene.bodies[*b as usize].name.as_str());
        StepError::Lcp { time, bodies: names.collect::<Vec<_>>().join(", "), source }
    };
    islands.into_iter().map(solve).map(|result| result.map_err(named)).collect()
}

/// A solution more than this times faster than what drives it comes from rows that nearly
/// contradict each other, and a later stage is tried.
fn wild(stage: Stage) -> f64 {
    if stage.is_velocity() { 8.0 } else { 4.0 }
}

/// A later stage counts if its solution is calmer by this much: a lever is no contradiction.
const CALMER: f64 = 4.0;

/// The record of one island; of a refusal its bodies and the first stage's error.
fn solve_island(
    context: &RowContext<'_>,
    solver: &dyn LcpSolver,
    island: Island,
    scratch: &mut StepScratch,
) -> Result<IslandRecord, (Vec<u32>, LcpError)> {
    let tolerance = context.scene.tolerance();
    let (mut calmest, mut least) = (None, f64::INFINITY);
    let mut refusal: Option<(Vec<u32>, LcpError)> = None;
    let mut next = Some(island);
    while let Some(island) = next {
        let problem = &island.problem;
        match solve_checked(solver, problem, None, &mut scratch.lcp, tolerance) {
            Ok((solution, _)) if gives_too_much(context, &island, &solution) => {
                next = giving_way(context, &island);
            }
            Ok((solution, residual)) => {
                let amplification = problem.amplification(&solution);
                let calm = amplification <= wild(island.stage);
                next = if calm { None } else { giving_way(context, &island) };
                if calmest.is_none() || CALMER * amplification < least {
                    least = amplification;
                    calmest = Some(record(island, solution, residual.max()));
                }
            }
            Err(error) => {
                next = giving_way(context, &island);
                refusal = refusal.or(Some((island.bodies, error)));
            }
        }
    }
    calmest.ok_or_else(|| refusal.unwrap_or((Vec::new(), NOTHING_TRIED)))
}

/// Joints that may drift and give way by more than this, relative to the problem's scale, are
/// driven against each other. Drift alone takes at most ½ √(1e-8).
const DRIVEN: f64 = 1e-3;

fn gives_too_much(context: &RowContext<'_>, island: &Island, solution: &LcpSolution) -> bool {
    if !island.stage.drifts() {
        return false;
    }
    let metric = Metric::new(&island.problem);
    let context = RowContext { stage: island.stage, ..*context };
    let gives = |(row, source): (usize, &RowSource)| {
        context.softness(*source) * metric.impulse(row, solution.impulses[row]).abs()
    };
    island.sources.iter().enumerate().map(gives).any(|gives| gives > DRIVEN * metric.scale)
}

const NOTHING_TRIED: LcpError = LcpError::NotConverged { iterations: 0, residual: f64::INFINITY };

/// The island in its next stage that asks for something else.
fn giving_way(context: &RowContext<'_>, island: &Island) -> Option<Island> {
    let mut stage = island.stage;
    while let Some(next) = stage.next() {
        if let Some(island) = island.at(&RowContext { stage: next, ..*context }) {
            return Some(island);
        }
        stage = next;
    }
    None
}

fn record(island: Island, solution: LcpSolution, residual: f64) -> IslandRecord {
    let Island { bodies, sources, problem, stage } = island;
    let path = Path::of(&problem);
    IslandRecord { bodies, sources, problem, solution, path, stage, residual }
}

/// v⁺ from the islands, or p/m where nothing acts; q⁺ = q + dt v⁺ (semi-implicit Euler).
fn integrate(
    scene: &Scene,
    state: &State,
    momentum: &[Vector3<f64>],
    islands: &[IslandRecord],
) -> State {
    let mut after = state.clone();
    after.time += scene.dt;
    for (i, v) in after.v.iter_mut().enumerate().filter(|(i, _)| scene.is_dynamic(*i)) {
        *v = momentum[i].component_div(&scene.bodies[i].mass);
    }
    for island in islands {
        for (body, v) in island.bodies.iter().zip(&island.solution.velocities) {
            after.v[*body as usize] = *v;
        }
    }
    for (q, v) in after.q.iter_mut().zip(&after.v) {
        *q += scene.dt * v;
    }
    after
}

/// Displaces `record.after` by dt w where the moved poses are wrong:
/// min ½ wᵀMw subject to the joints' and contacts' position rows.
fn mend_positions(
    scene: &Scene,
    solver: &dyn LcpSolver,
    record: &mut StepRecord,
    scratch: &mut StepScratch,
) -> Result<(), StepError> {
    let loose = loose_bodies(record);
    let Stabilisation { joints, contacts } = scene.stabilisation();
    if loose.is_empty() && ![joints, contacts].contains(&Correction::Post) {
        return Ok(());
    }
    let moved = record.after.q.clone();
    let contacts = evaluate_at(&record.contacts, &moved);
    let (stage, v, control) = (Stage::Post, &record.after.v, &record.control);
    let context =
        RowContext { scene, stage, q: &moved, v, control, contacts: &contacts, loose: &loose };
    if !needs_mending(&context) {
        return Ok(());
    }
    let still = vec![Vector3::zeros(); moved.len()];
    let mut islands = assemble(&context, &still, &rows(&context, scratch.detection.groups()));
    islands.retain(|island| is_displaced(&island.problem));
    let islands = solve(&context, solver, record.after.time, islands, scratch)?;
    for island in &islands {
        for (body, w) in island.bodies.iter().zip(&island.solution.velocities) {
            record.after.q[*body as usize] += scene.dt * w;
        }
    }
    record.post = Some(PostRecord { moved, contacts, loose, islands });
    Ok(())
}

/// Whether w = 0 breaks a row.
fn is_displaced(problem: &Lcp) -> bool {
    problem.rows.iter().any(|row| match row.law {
        Law::Equality => row.rhs != 0.0,
        _ => row.rhs > 0.0,
    })
}

/// The same features at other poses.
fn evaluate_at(contacts: &[Contact], q: &[Vector3<f64>]) -> Vec<Contact> {
    let at = |c: &Contact| {
        let [a, b] = c.feature.id.bodies;
        c.feature.evaluate(&q[a as usize], &q[b as usize])
    };
    contacts.iter().map(at).collect()
}

/// Bodies of islands that let position errors stay; empty if there are none.
fn loose_bodies(record: &StepRecord) -> Vec<bool> {
    let mut loose = Vec::new();
    for island in record.islands.iter().filter(|island| island.stage.drifts()) {
        loose.resize(record.after.q.len(), false);
        island.bodies.iter().for_each(|body| loose[*body as usize] = true);
    }
    loose
}

fn needs_mending(context: &RowContext<'_>) -> bool {
    let index = |i: usize| u32::try_from(i).expect("fewer than u32 counts");
    let penetrates = |contact: usize| {
        let (contact, gap) = (index(contact), context.contacts[contact].gap);
        gap < -context.contact_slop(contact) && context.mends_contact(contact)
    };
    let drifts = |joint: usize| {
        let (held, joint) = (&context.scene.joints[joint], index(joint));
        held.softness.is_none()
            && context.mends_joint(joint)
            && held.held.iter().any(|row| context.joint_geometry(joint, *row).value != 0.0)
    };
    (0..context.contacts.len()).any(penetrates) || (0..context.scene.joints.len()).any(drifts)
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
