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

use crate::detect::{Reach, detect, reach, rows};
use crate::island::{Island, assemble};
use crate::momentum::momentum;
use crate::record::{IslandRecord, Path, PostRecord, StepRecord};
use crate::row::{RowContext, RowSource, Stage};
use crate::scene::Scene;
use crate::{Correction, State, StepError};

/// Memory that is reused between steps; it never changes a result.
#[derive(Debug, Default)]
pub struct StepScratch {
    lcp: Scratch,
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
    let Setup { contacts, islands, momentum, reach } = set_up(scene, state, control)?;
    let (q, v, stage) = (&state.q, &state.v, Stage::Velocity);
    let context =
        RowContext { scene, stage, q, v, control, contacts: &contacts, mends_joints: false };
    let islands = solve(&context, solver, state.time, islands, scratch)?;
    let after = integrate(scene, state, &momentum, &islands);
    let mut record = StepRecord { control: control.to_vec(), contacts, islands, post: None, after };
    mend_positions(scene, solver, reach, &mut record, scratch)?;
    record.after.check(scene.bodies.len())?;
    Ok(record)
}

/// What a step is about to solve.
pub(crate) struct Setup {
    pub(crate) contacts: Vec<Contact>,
    pub(crate) islands: Vec<Island>,
    momentum: Vec<Vector3<f64>>,
    reach: Reach,
}

pub(crate) fn set_up(scene: &Scene, state: &State, control: &[f64]) -> Result<Setup, StepError> {
    let (q, v, stage) = (&state.q, &state.v, Stage::Velocity);
    let context = RowContext { scene, stage, q, v, control, contacts: &[], mends_joints: false };
    let momentum = momentum(&context, state.time);
    let reach = reach(scene, v, &momentum);
    let contacts = detect(scene, state, reach)?;
    let context = RowContext { contacts: &contacts, ..context };
    let islands = assemble(&context, &momentum, &rows(&context, reach));
    Ok(Setup { contacts, islands, momentum, reach })
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

/// The record of one island; of a refusal its bodies and the first stage's error.
fn solve_island(
    context: &RowContext<'_>,
    solver: &dyn LcpSolver,
    island: Island,
    scratch: &mut StepScratch,
) -> Result<IslandRecord, (Vec<u32>, LcpError)> {
    let tolerance = context.scene.tolerance();
    let (mut calmest, mut least) = (None, f64::INFINITY);
    let mut refusal = None;
    let mut next = Some(island.clone());
    while let Some(island) = next {
        let result = solve_checked(solver, &island.problem, None, &mut scratch.lcp, tolerance);
        match result {
            Ok((solution, _)) if gives_too_much(context, &island, &solution) => {
                next = giving_way(context, &island);
            }
            Ok((solution, residual)) => {
                let amplification = island.problem.amplification(&solution);
                if amplification <= wild(island.stage) {
                    return Ok(record(island, solution, residual.max()));
                }
                next = giving_way(context, &island);
                if calmest.is_none() || amplification < least {
                    least = amplification;
                    calmest = Some(record(island, solution, residual.max()));
                }
            }
            Err(error) => {
                next = giving_way(context, &island);
                refusal = refusal.or(Some(error));
            }
        }
    }
    calmest.ok_or_else(|| (island.bodies, refusal.unwrap_or(NOTHING_TRIED)))
}

/// Joints that may drift and give way by more than this, relative to the problem's scale, are
/// driven against each other. Drift alone takes at most ½ √(1e-8).
const DRIVEN: f64 = 1e-3;

fn gives_too_much(context: &RowContext<'_>, island: &Island, solution: &LcpSolution) -> bool {
    let metric = Metric::new(&island.problem);
    let context = RowContext { stage: island.stage, ..*context };
    let gives = |(row, source): (usize, &RowSource)| {
        context.softness(*source) * metric.impulse(row, solution.impulses[row]).abs()
    };
    island.stage.drifts()
        && island.sources.iter().enumerate().map(gives).any(|gives| gives > DRIVEN * metric.scale)
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
    reach: Reach,
    record: &mut StepRecord,
    scratch: &mut StepScratch,
) -> Result<(), StepError> {
    let stabilisation = scene.stabilisation();
    let loose = record.islands.iter().any(|island| island.stage.drifts());
    let mends_joints = loose || stabilisation.joints == Correction::Post;
    if !mends_joints && stabilisation.contacts != Correction::Post {
        return Ok(());
    }
    let moved = record.after.q.clone();
    let contacts = evaluate_at(&record.contacts, &moved);
    let (stage, v, control) = (Stage::Post, &record.after.v, &record.control);
    let context =
        RowContext { scene, stage, q: &moved, v, control, contacts: &contacts, mends_joints };
    if !needs_mending(&context) {
        return Ok(());
    }
    let still = vec![Vector3::zeros(); moved.len()];
    let mut islands = assemble(&context, &still, &rows(&context, reach));
    islands.retain(|island| is_displaced(&island.problem));
    let islands = solve(&context, solver, record.after.time, islands, scratch)?;
    for island in &islands {
        for (body, w) in island.bodies.iter().zip(&island.solution.velocities) {
            record.after.q[*body as usize] += scene.dt * w;
        }
    }
    record.post = Some(PostRecord { moved, contacts, mends_joints, islands });
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

fn needs_mending(context: &RowContext<'_>) -> bool {
    let contacts = context.scene.stabilisation().contacts;
    let penetrates = |c: u32| context.contacts[c as usize].gap < -context.contact_slop(c);
    let drifts = |joint: usize| {
        let held = &context.scene.joints[joint];
        let index = u32::try_from(joint).expect("fewer joints than u32 counts");
        held.softness.is_none()
            && held.held.iter().any(|row| context.joint_geometry(index, *row).value != 0.0)
    };
    let n_contacts = u32::try_from(context.contacts.len()).expect("fewer contacts than u32 counts");
    (contacts == Correction::Post && (0..n_contacts).any(penetrates))
        || (context.mends_joints && (0..context.scene.joints.len()).any(drifts))
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
