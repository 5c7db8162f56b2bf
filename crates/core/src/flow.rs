//! Flows of order 4, between events.
//!
//! ```text
//!  M a = f(q, v) + Σ Jᵀ λ       J a = −γ  for joints, contacts that press, what sticks, motors at their speed
//!
//!  a₁ = a(q, v)                        a₂ = a(q + ½ h v,  v + ½ h a₁)
//!  a₃ = a(q + ½ h v₂, v + ½ h a₂)      a₄ = a(q + h v₃,   v + h a₃)
//!  q̃  = q + h/6 (v + 2 v₂ + 2 v₃ + v₄)       ṽ = v + h/6 (a₁ + 2 a₂ + 2 a₃ + a₄)
//!
//!  q⁺: the least displacement of q̃ that closes joints and contacts       v⁺: of ṽ that obeys J v⁺ = 0
//! ```
//!
//! (Kutta 1901.) Which contacts press, stick or slide, and which motors are at their maximum, is decided at the
//! beginning, by the complementarity problem of the accelerations, and stays. What slides there already
//! has the friction of its direction, whatever its acceleration.

use nalgebra::Vector3;
use tangency_collision::Contact;
use tangency_lcp::Mode;

use crate::island::{Island, assemble};
use crate::mend::{evaluate_at, mend_positions};
use crate::momentum::{forces_into, momentum_into};
use crate::motion::Motion;
use crate::record::{IslandRecord, StepRecord};
use crate::resolve::Division;
use crate::row::{RowContext, RowSource};
use crate::scratch::StepScratch;
use crate::smooth::{Meeting, STEPS, Slope, SmoothRecord, WEIGHTS};
use crate::touch::{Survey, Touch};
use crate::{State, StepError};

/// How the modes of a flow's rows are known.
#[derive(Clone, Copy)]
enum Modes<'a> {
    /// They are found; a step with about the same rows is a guess.
    Found(Option<&'a StepRecord>),
    /// They are those of the flow's first slope.
    Kept(&'a Slope),
}

/// What has rows in a flow.
#[derive(Clone, Copy)]
struct Held<'a> {
    contacts: &'a [Contact],
    reached: &'a [RowSource],
    /// The time at which it is decided which forces act, s.
    middle: f64,
}

impl Division<'_> {
    /// A smooth flow of length `dt`.
    pub(crate) fn smooth(
        &self,
        now: &State,
        survey: &Survey,
        dt: f64,
        before: Option<&StepRecord>,
        scratch: &mut StepScratch,
    ) -> Result<StepRecord, StepError> {
        let mut resting = scratch.contacts.take();
        resting.extend(survey.with(|_, touch| touch == Touch::Resting).map(|(c, _)| *c));
        let middle = now.time + 0.5 * dt;
        let held = Held { contacts: &resting, reached: &survey.reached, middle };
        let first = self.slope(scratch.copy(now), held, Modes::Found(before), scratch)?;
        let mut slopes = vec![first];
        for part in STEPS {
            let last = &slopes[slopes.len() - 1];
            let at = later(now, &last.at.v, &last.accelerations, part * dt, scratch);
            let next = self.slope(at, held, Modes::Kept(&slopes[0]), scratch)?;
            slopes.push(next);
        }
        let after = combined(now, &slopes, dt, scratch);
        let smooth = SmoothRecord { slopes, meeting: None, end: None };
        let mut record = StepRecord {
            control: scratch.copy_control(self.control),
            motion: Motion::Smooth,
            dt,
            parts: Vec::new(),
            hit: None,
            midway: Vec::new(),
            bounces: Vec::new(),
            contacts: resting,
            islands: Vec::new(),
            smooth: Some(Box::new(smooth)),
            fell_back: false,
            post: Vec::new(),
            after,
        };
        if dt > 0.0 {
            mend_positions(self.scene, self.solver, &now.q, &mut record, scratch)?;
            self.meet(&survey.reached, &mut record, scratch)?;
        }
        record.after.check(self.scene.bodies.len())?;
        Ok(record)
    }

    /// The accelerations at a state, on the modes of a flow.
    pub(crate) fn slope_again(
        &self,
        flow: &StepRecord,
        reached: &[RowSource],
        scratch: &mut StepScratch,
    ) -> Result<Slope, StepError> {
        let held = Held { contacts: &flow.contacts, reached, middle: flow.middle() };
        let first = flow.smooth.as_ref().map(|smooth| &smooth.slopes[0]);
        let modes = first.map_or(Modes::Found(None), Modes::Kept);
        self.slope(scratch.copy(&flow.after), held, modes, scratch)
    }

    /// The accelerations at a state.
    fn slope(
        &self,
        at: State,
        held: Held<'_>,
        modes: Modes<'_>,
        scratch: &mut StepScratch,
    ) -> Result<Slope, StepError> {
        let contacts = evaluate_at(held.contacts, &at.q, scratch);
        let context = RowContext::of(self.scene, &at, self.control, 1.0);
        let context = RowContext { motion: Motion::Smooth, contacts: &contacts, ..context };
        let mut accelerations = scratch.vectors.take();
        forces_into(&context, &scratch.frames, held.middle, &mut accelerations);
        let mut islands = list(&context, &accelerations, held.reached, scratch);
        for (i, a) in
            accelerations.iter_mut().enumerate().filter(|(i, _)| self.scene.is_dynamic(*i))
        {
            *a = a.component_div(&self.scene.bodies[i].mass);
        }
        let mut records = scratch.records.take();
        if let Modes::Found(Some(before)) = modes {
            scratch.places.find(before, &contacts);
        }
        for (index, island) in islands.drain(..).enumerate() {
            records.push(match modes {
                Modes::Found(before) => {
                    self.found(&context, (before, &accelerations), (index, island), scratch)?
                }
                Modes::Kept(first) => {
                    let modes = kept(&first.islands, index, &island);
                    self.in_modes(&context, island, modes, scratch)?
                }
            });
        }
        scratch.islands.give(islands);
        scatter(&records, &mut accelerations);
        Ok(Slope { at, contacts, islands: records, accelerations })
    }

    /// Brings the velocities after a flow to what its rows hold.
    fn meet(
        &self,
        reached: &[RowSource],
        flow: &mut StepRecord,
        scratch: &mut StepScratch,
    ) -> Result<(), StepError> {
        if flow.problems().is_empty() {
            return Ok(());
        }
        let before = scratch.copy(&flow.after);
        let contacts = evaluate_at(&flow.contacts, &before.q, scratch);
        let context = RowContext::of(self.scene, &before, self.control, 0.0);
        let context = RowContext { motion: Motion::Projection, contacts: &contacts, ..context };
        let mut momentum = scratch.vectors.take();
        momentum_into(&context, &scratch.frames, before.time, &mut momentum);
        let mut islands = list(&context, &momentum, reached, scratch);
        scratch.vectors.give(momentum);
        let mut records = scratch.records.take();
        for (index, island) in islands.drain(..).enumerate() {
            let modes = kept(flow.problems(), index, &island).iter().map(|mode| match mode {
                Mode::Active => Mode::Active,
                _ => Mode::Open,
            });
            let modes: Vec<Mode> = modes.collect();
            records.push(self.in_modes(&context, island, &modes, scratch)?);
        }
        scratch.islands.give(islands);
        scatter(&records, &mut flow.after.v);
        let record = StepRecord {
            control: scratch.copy_control(self.control),
            motion: Motion::Projection,
            dt: 0.0,
            parts: Vec::new(),
            hit: None,
            midway: Vec::new(),
            bounces: Vec::new(),
            contacts,
            islands: records,
            smooth: None,
            fell_back: false,
            post: Vec::new(),
            after: scratch.copy(&flow.after),
        };
        if let Some(smooth) = &mut flow.smooth {
            smooth.meeting = Some(Box::new(Meeting { before, record }));
        }
        Ok(())
    }
}

/// The islands of a context's rows.
fn list(
    context: &RowContext<'_>,
    momentum: &[Vector3<f64>],
    reached: &[RowSource],
    scratch: &mut StepScratch,
) -> Vec<Island> {
    let mut rows = std::mem::take(&mut scratch.rows);
    rows.reached.clear();
    rows.reached.extend_from_slice(reached);
    rows.fill(context, &scratch.frames, scratch.detection.groups());
    let islands = assemble(context, momentum, &mut rows, scratch);
    scratch.rows = rows;
    islands
}

/// The modes of an island among those of a flow; none where it has other rows.
fn kept<'a>(islands: &'a [IslandRecord], index: usize, island: &Island) -> &'a [Mode] {
    let same = islands.get(index).filter(|old| old.sources == island.sources);
    same.map_or(&[], |old| &old.solution.modes)
}

/// The velocities, or accelerations, of the islands' bodies.
fn scatter(islands: &[IslandRecord], to: &mut [Vector3<f64>]) {
    for island in islands {
        for (body, v) in island.bodies.iter().zip(&island.solution.velocities) {
            to[*body as usize] = *v;
        }
    }
}

/// The state after a time s at constant rates.
fn later(
    now: &State,
    v: &[Vector3<f64>],
    a: &[Vector3<f64>],
    s: f64,
    scratch: &mut StepScratch,
) -> State {
    let mut state = scratch.copy(now);
    state.time += s;
    state.q.iter_mut().zip(v).for_each(|(q, v)| *q += s * v);
    state.v.iter_mut().zip(a).for_each(|(v, a)| *v += s * a);
    state
}

/// The state after a flow, by its slopes.
fn combined(now: &State, slopes: &[Slope], dt: f64, scratch: &mut StepScratch) -> State {
    let mut state = scratch.copy(now);
    state.time += dt;
    for (slope, weight) in slopes.iter().zip(WEIGHTS) {
        let part = weight * dt;
        state.q.iter_mut().zip(&slope.at.v).for_each(|(q, v)| *q += part * v);
        state.v.iter_mut().zip(&slope.accelerations).for_each(|(v, a)| *v += part * a);
    }
    state
}
