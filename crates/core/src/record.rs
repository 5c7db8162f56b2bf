//! The record of a step: what it modelled, what it solved, and the next state.

use nalgebra::{Vector2, Vector3};
use serde::{Deserialize, Serialize};
use tangency_collision::Contact;
use tangency_lcp::{Lcp, LcpSolution};

use crate::State;
use crate::motion::Motion;
use crate::row::{RowContext, RowSource, SlowRow, Stage};
use crate::scene::Scene;
use crate::smooth::{Slope, SmoothRecord, WEIGHTS};

/// The cheapest way that an island could be solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Path {
    /// Equality rows only: one linear solve.
    Linear,
    /// Contacts, limits, bounded motors: a complementarity problem.
    Complementarity,
}

impl Path {
    /// The cheapest path for a problem.
    #[must_use]
    pub fn of(problem: &Lcp) -> Self {
        if problem.is_linear() { Self::Linear } else { Self::Complementarity }
    }
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
    /// Which problem of the step it is, and how much of it gave way.
    pub stage: Stage,
    /// Scaled residual, as judged by the engine.
    pub residual: f64,
}

/// One displacement after the move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PostRecord {
    /// Poses after the move and the displacements before this one.
    pub moved: Vec<Vector3<f64>>,
    /// The step's contacts, evaluated there.
    pub contacts: Vec<Contact>,
    /// Bodies of islands that [let errors stay](Stage::drifts): theirs were removed, too. Empty if
    /// there are none.
    pub loose: Vec<bool>,
    /// Rows whose errors it removes in part only, by source.
    pub slow: Vec<SlowRow>,
    /// Contacts that pressed in a flow, and stay closed; empty if there are none.
    pub marked: Vec<bool>,
    /// The problems; their velocities are the displacement divided by dt.
    pub islands: Vec<IslandRecord>,
}

/// Everything that one step produced: what it modelled, what it solved, and the next state.
/// The derivative needs this and the state before; nothing else.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepRecord {
    /// The control that was applied.
    pub control: Vec<f64>,
    /// How bodies moved.
    pub motion: Motion,
    /// How long this lasted, s: the scene's step, the rest of it after the parts, or 0 for impacts.
    pub dt: f64,
    /// What the step began with where impacts divide it: flows and impacts, in the order of time. The
    /// other fields are about what was left of the step.
    pub parts: Vec<StepRecord>,
    /// Of an impact the row whose gap closed, and so told its time; `None` where velocities only met
    /// what joints and resting contacts ask for.
    pub hit: Option<RowSource>,
    /// Of a flow the poses at which its rows were evaluated: halfway along the velocities before it.
    pub midway: Vec<Vector3<f64>>,
    /// Of an impact which contacts bounced; of anything else empty.
    pub bounces: Vec<bool>,
    /// Contacts in the order of their ids: those in reach, or of flows and impacts those that touch.
    pub contacts: Vec<Contact>,
    /// Islands; bodies in none moved freely.
    pub islands: Vec<IslandRecord>,
    /// Of a smooth flow what it solved; its `islands` are empty.
    #[serde(default)]
    pub smooth: Option<Box<SmoothRecord>>,
    /// Whether the rest of the step was one of fixed length, because events went on for longer than the
    /// scene divides a step for, or no motion obeys all laws.
    #[serde(default)]
    pub fell_back: bool,
    /// What mended positions, one displacement after the other; empty where none was needed.
    pub post: Vec<PostRecord>,
    /// The state at the end of the step.
    pub after: State,
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
    /// Displacements that mended positions after the move.
    pub displacements: usize,
    /// Islands that let position errors stay for the step ([`Stage::Loose`]).
    pub loose_islands: usize,
    /// Islands that also gave up restitution ([`Stage::Plastic`]).
    pub plastic_islands: usize,
    /// Islands whose positions could only be mended in part ([`Stage::SoftPost`]).
    pub soft_islands: usize,
    /// Impacts that divide the step.
    pub impacts: usize,
}

impl Counts {
    /// Takes the work of a part of the step along.
    fn add(&mut self, part: &Self, record: &StepRecord) {
        self.iterations += part.iterations;
        self.factorisations += part.factorisations;
        self.displacements += part.displacements;
        self.loose_islands += part.loose_islands;
        self.plastic_islands += part.plastic_islands;
        self.soft_islands += part.soft_islands;
        self.impacts += usize::from(record.hit.is_some());
    }
}

impl StepRecord {
    /// What the rows of one of its displacements were evaluated from.
    #[must_use]
    pub fn post_context<'a>(&'a self, scene: &'a Scene, post: &'a PostRecord) -> RowContext<'a> {
        RowContext {
            scene,
            stage: Stage::Post,
            motion: self.motion,
            dt: self.dt,
            q: &post.moved,
            v: &self.after.v,
            control: &self.control,
            contacts: &post.contacts,
            loose: &post.loose,
            slow: &post.slow,
            marked: &post.marked,
        }
    }

    /// What the rows of its velocities were evaluated from; `before` is the state before.
    #[must_use]
    pub fn velocity_context<'a>(&'a self, scene: &'a Scene, before: &'a State) -> RowContext<'a> {
        let q = if self.motion == Motion::Flow { &self.midway } else { &before.q };
        RowContext {
            scene,
            stage: Stage::Velocity,
            motion: self.motion,
            dt: self.dt,
            q,
            v: &before.v,
            control: &self.control,
            contacts: &self.contacts,
            loose: &[],
            slow: &[],
            marked: &self.bounces,
        }
    }

    /// The worst residual of the step's problems; 0 where none was solved.
    #[must_use]
    pub fn residual(&self) -> f64 {
        let post = self.post.iter().flat_map(|post| &post.islands);
        let smooth = self.smooth.iter().flat_map(|smooth| &smooth.slopes);
        let slopes = smooth.flat_map(|slope| &slope.islands);
        let all = self.islands.iter().chain(post).chain(slopes);
        let meeting = self.smooth.as_ref().and_then(|smooth| smooth.meeting.as_ref());
        let own = all.map(|i| i.residual).fold(0.0, f64::max);
        let own = meeting.map_or(own, |meeting| meeting.record.residual().max(own));
        self.parts.iter().map(Self::residual).fold(own, f64::max)
    }

    /// Impulses of the contacts that have any; those of impacts that divide the step are their own
    /// records' in [`parts`](Self::parts).
    #[must_use]
    pub fn contact_impulses(&self) -> Vec<ContactImpulse> {
        let mut impulses: Vec<ContactImpulse> = Vec::new();
        for (number, island) in self.problems().iter().enumerate() {
            for (row, source) in island.sources.iter().enumerate() {
                let impulse = self.impulse_of(number, row);
                match source {
                    RowSource::Normal { contact } if impulse != 0.0 => {
                        let index = *contact as usize;
                        let Contact { point, normal: direction, .. } = self.contacts[index];
                        let (normal, tangent) = (impulse, 0.0);
                        let it =
                            ContactImpulse { contact: index, point, direction, normal, tangent };
                        impulses.push(it);
                    }
                    RowSource::Tangent { contact } => {
                        let same = |i: &&mut ContactImpulse| i.contact == *contact as usize;
                        if let Some(it) = impulses.last_mut().filter(same) {
                            it.tangent = impulse;
                        }
                    }
                    _ => {}
                }
            }
        }
        impulses
    }

    /// Impulse (of a divided step in its last part) of the row with this source, N·s or N·m·s, if it was modelled.
    #[must_use]
    pub fn impulse(&self, source: RowSource) -> Option<f64> {
        self.problems().iter().enumerate().find_map(|(number, island)| {
            let row = island.sources.iter().position(|s| *s == source)?;
            Some(self.impulse_of(number, row))
        })
    }

    /// What the step modelled and what it cost.
    #[must_use]
    pub fn counts(&self, scene: &Scene) -> Counts {
        let dynamic = (0..scene.bodies.len()).filter(|i| scene.is_dynamic(*i)).count();
        let bound: usize = self.problems().iter().map(|i| i.bodies.len()).sum();
        let mut counts = Counts {
            free_bodies: dynamic - bound,
            contacts: self.contacts.len(),
            displacements: self.post.len(),
            ..Counts::default()
        };
        for island in self.problems() {
            match island.path {
                Path::Linear => counts.linear_islands += 1,
                Path::Complementarity => counts.lcp_islands += 1,
            }
            counts.rows += island.sources.len();
        }
        let post = self.post.iter().flat_map(|post| &post.islands);
        let slopes = self.smooth.iter().flat_map(|smooth| &smooth.slopes);
        let slopes = slopes.flat_map(|slope| &slope.islands);
        let meeting = self.smooth.iter().flat_map(|smooth| &smooth.meeting);
        let meeting = meeting.flat_map(|meeting| &meeting.record.islands);
        for island in self.islands.iter().chain(post).chain(slopes).chain(meeting) {
            match island.stage {
                Stage::Velocity | Stage::Post => {}
                Stage::Plastic => counts.plastic_islands += 1,
                Stage::Loose => counts.loose_islands += 1,
                Stage::SoftPost => counts.soft_islands += 1,
            }
            counts.iterations += island.solution.stats.iterations as usize;
            counts.factorisations += island.solution.stats.factorisations as usize;
        }
        self.parts.iter().for_each(|part| counts.add(&part.counts(scene), part));
        counts
    }

    /// Whether events went on for longer than the scene divides a step for, or no motion obeys all laws:
    /// the rest of the step was one of fixed length.
    #[must_use]
    pub fn fell_back(&self) -> bool {
        self.fell_back
    }

    /// Impulse of row `row` of problem `island`, N·s or N·m·s; of a smooth flow the integral of its force.
    fn impulse_of(&self, island: usize, row: usize) -> f64 {
        let Some(smooth) = &self.smooth else { return self.islands[island].solution.impulses[row] };
        let force = |slope: &Slope| slope.islands[island].solution.impulses[row];
        let parts = smooth.slopes.iter().zip(WEIGHTS);
        self.dt * parts.map(|(slope, weight)| weight * force(slope)).sum::<f64>()
    }
}
