//! One time step, and the record of it.
//!
//! ```text
//!  contacts and limits in reach  →  islands  →  v⁺ = M⁻¹(p + Σ Jᵢᵀ λᵢ)  →  q⁺ = q + dt v⁺
//! ```
//!
//! and, only where positions are then wrong by more than rounding, a displacement of least
//! mass-weighted size that mends them: q⁺ += dt w.

use nalgebra::{Vector2, Vector3};
use serde::{Deserialize, Serialize};
use tangency_collision::Contact;
use tangency_lcp::{Lcp, LcpSolution, LcpSolver, Scratch, solve_checked};

use crate::detect::{Reach, detect, reach, rows};
use crate::island::{Island, assemble};
use crate::momentum::momentum;
use crate::row::{RowContext, RowSource, Stage};
use crate::scene::Scene;
use crate::{Correction, State, StepError};

/// The cheapest way that an island could be solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Path {
    /// Equality rows only: one linear solve.
    Linear,
    /// Contacts, limits, bounded motors: a complementarity problem.
    Complementarity,
}

/// One island's problem and its accepted solution.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct IslandRecord {
    /// Scene indices of the problem's bodies, ascending.
    pub bodies: Vec<u32>,
    /// Where each row comes from.
    pub sources: Vec<RowSource>,
    /// The problem.
    pub problem: Lcp,
    /// Its solution.
    pub solution: LcpSolution,
    /// How it was solved.
    pub path: Path,
    /// Scaled residual, as judged by the engine.
    pub residual: f64,
}

/// The displacement after the move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PostRecord {
    /// Poses after the move, before the displacement.
    pub moved: Vec<Vector3<f64>>,
    /// The step's contacts, evaluated there.
    pub contacts: Vec<Contact>,
    /// The problems; their velocities are the displacement divided by dt.
    pub islands: Vec<IslandRecord>,
}

/// Everything that one step produced: what it modelled, what it solved, and the next state.
/// The derivative needs this and the state before; nothing else.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepRecord {
    /// The control that was applied.
    pub control: Vec<f64>,
    /// Contacts in reach, in the order of their ids.
    pub contacts: Vec<Contact>,
    /// Islands; bodies in none moved freely.
    pub islands: Vec<IslandRecord>,
    /// What mended positions, where that was needed.
    pub post: Option<PostRecord>,
    /// The state at the end of the step.
    pub after: State,
}

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
    let islands = solve(scene, solver, state.time, islands, scratch)?;
    let after = integrate(scene, state, &momentum, &islands);
    let mut record = StepRecord { control: control.to_vec(), contacts, islands, post: None, after };
    mend_positions(scene, solver, reach, &mut record, scratch)?;
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
    let context = RowContext { scene, stage, q, v, control, contacts: &[] };
    let momentum = momentum(&context, state.time);
    let reach = reach(scene, v, &momentum);
    let contacts = detect(scene, state, reach)?;
    let context = RowContext { contacts: &contacts, ..context };
    let islands = assemble(&context, &momentum, &rows(&context, reach));
    Ok(Setup { contacts, islands, momentum, reach })
}

fn solve(
    scene: &Scene,
    solver: &dyn LcpSolver,
    time: f64,
    islands: Vec<Island>,
    scratch: &mut StepScratch,
) -> Result<Vec<IslandRecord>, StepError> {
    let mut solved = Vec::with_capacity(islands.len());
    for Island { bodies, sources, problem } in islands {
        let path = Path::of(&problem);
        let result = solve_checked(solver, &problem, None, &mut scratch.lcp, scene.tolerance());
        let (solution, residual) = result.map_err(|source| {
            let names = bodies.iter().map(|b| scene.bodies[*b as usize].name.as_str());
            StepError::Lcp { time, bodies: names.collect::<Vec<_>>().join(", "), source }
        })?;
        let residual = residual.max();
        solved.push(IslandRecord { bodies, sources, problem, solution, path, residual });
    }
    Ok(solved)
}

impl Path {
    /// The cheapest path for a problem.
    #[must_use]
    pub fn of(problem: &Lcp) -> Self {
        if problem.is_linear() { Self::Linear } else { Self::Complementarity }
    }
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
    let asked = [stabilisation.joints, stabilisation.contacts];
    if !asked.contains(&Correction::Post) {
        return Ok(());
    }
    let moved = record.after.q.clone();
    let contacts = evaluate_at(&record.contacts, &moved);
    let (stage, v, control) = (Stage::Post, &record.after.v, &record.control);
    let context = RowContext { scene, stage, q: &moved, v, control, contacts: &contacts };
    if !needs_mending(&context) {
        return Ok(());
    }
    let still = vec![Vector3::zeros(); moved.len()];
    let islands = assemble(&context, &still, &rows(&context, reach));
    let islands = solve(scene, solver, record.after.time, islands, scratch)?;
    for island in &islands {
        for (body, w) in island.bodies.iter().zip(&island.solution.velocities) {
            record.after.q[*body as usize] += scene.dt * w;
        }
    }
    record.post = Some(PostRecord { moved, contacts, islands });
    Ok(())
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
    let stabilisation = context.scene.stabilisation();
    let penetrates = |c: u32| context.contacts[c as usize].gap < -context.contact_slop(c);
    let drifts = |joint: usize| {
        let held = &context.scene.joints[joint];
        let index = u32::try_from(joint).expect("fewer joints than u32 counts");
        held.softness.is_none()
            && held.held.iter().any(|row| context.joint_geometry(index, *row).value != 0.0)
    };
    let n_contacts = u32::try_from(context.contacts.len()).expect("fewer contacts than u32 counts");
    (stabilisation.contacts == Correction::Post && (0..n_contacts).any(penetrates))
        || (stabilisation.joints == Correction::Post && (0..context.scene.joints.len()).any(drifts))
}

fn check_input(scene: &Scene, state: &State, control: &[f64]) -> Result<(), StepError> {
    let expected = scene.bodies.len();
    for found in [state.q.len(), state.v.len()] {
        if found != expected {
            return Err(StepError::StateSize { expected, found });
        }
    }
    let (expected, found) = (scene.controls.len(), control.len());
    if found != expected {
        return Err(StepError::ControlSize { expected, found });
    }
    let bad = |x: &Vector3<f64>| !x.iter().all(|x| x.is_finite());
    let lists = [("pose of body", &state.q), ("velocity of body", &state.v)];
    for (what, list) in lists {
        if let Some(index) = list.iter().position(bad) {
            return Err(StepError::NotFinite { what, index });
        }
    }
    match control.iter().position(|u| !u.is_finite()) {
        Some(index) => Err(StepError::NotFinite { what: "control", index }),
        None => Ok(()),
    }
}

/// The impulse of one contact, for showing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactImpulse {
    /// Index into [`StepRecord::contacts`].
    pub contact: usize,
    /// Where it acts, m.
    pub point: Vector2<f64>,
    /// Normal from body a to body b.
    pub direction: Vector2<f64>,
    /// Impulse on b along the normal, N·s.
    pub normal: f64,
    /// Impulse on b along the tangent ⊥n, N·s.
    pub tangent: f64,
}

/// What a step modelled and what it cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts {
    /// Dynamic bodies without any row: closed form.
    pub free_bodies: usize,
    /// Islands solved by one linear solve.
    pub linear_islands: usize,
    /// Islands solved as complementarity problems.
    pub lcp_islands: usize,
    /// Rows of all islands.
    pub rows: usize,
    /// Contacts in reach.
    pub contacts: usize,
    /// Solver iterations.
    pub iterations: usize,
    /// Factorisations.
    pub factorisations: usize,
    /// Whether positions were mended after the move.
    pub mended: bool,
}

impl StepRecord {
    /// The worst residual of the step's problems; 0 where none was solved.
    #[must_use]
    pub fn residual(&self) -> f64 {
        let post = self.post.iter().flat_map(|post| &post.islands);
        self.islands.iter().chain(post).map(|i| i.residual).fold(0.0, f64::max)
    }

    /// Impulses of the contacts that have any.
    #[must_use]
    pub fn contact_impulses(&self) -> Vec<ContactImpulse> {
        let mut impulses: Vec<ContactImpulse> = Vec::new();
        for island in &self.islands {
            for (source, impulse) in island.sources.iter().zip(&island.solution.impulses) {
                match source {
                    RowSource::Normal { contact } if *impulse != 0.0 => {
                        let index = *contact as usize;
                        let Contact { point, normal: direction, .. } = self.contacts[index];
                        let (normal, tangent) = (*impulse, 0.0);
                        let it =
                            ContactImpulse { contact: index, point, direction, normal, tangent };
                        impulses.push(it);
                    }
                    RowSource::Tangent { contact } => {
                        let same = |i: &&mut ContactImpulse| i.contact == *contact as usize;
                        if let Some(it) = impulses.last_mut().filter(same) {
                            it.tangent = *impulse;
                        }
                    }
                    _ => {}
                }
            }
        }
        impulses
    }

    /// Impulse of the row with this source, N·s or N·m·s, if it was modelled.
    #[must_use]
    pub fn impulse(&self, source: RowSource) -> Option<f64> {
        self.islands.iter().find_map(|island| {
            let row = island.sources.iter().position(|s| *s == source)?;
            Some(island.solution.impulses[row])
        })
    }

    /// What the step modelled and what it cost.
    #[must_use]
    pub fn counts(&self, scene: &Scene) -> Counts {
        let dynamic = (0..scene.bodies.len()).filter(|i| scene.is_dynamic(*i)).count();
        let bound: usize = self.islands.iter().map(|i| i.bodies.len()).sum();
        let mut counts = Counts {
            free_bodies: dynamic - bound,
            contacts: self.contacts.len(),
            mended: self.post.is_some(),
            ..Counts::default()
        };
        for island in &self.islands {
            match island.path {
                Path::Linear => counts.linear_islands += 1,
                Path::Complementarity => counts.lcp_islands += 1,
            }
            counts.rows += island.sources.len();
        }
        let post = self.post.iter().flat_map(|post| &post.islands);
        for island in self.islands.iter().chain(post) {
            counts.iterations += island.solution.stats.iterations as usize;
            counts.factorisations += island.solution.stats.factorisations as usize;
        }
        counts
    }
}
