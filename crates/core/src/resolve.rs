//! Steps that are divided where something closes.
//!
//! ```text
//!  flow τ₁ ── impact ── flow τ₂ ── impact ── … ── flow dt − Σ τ
//! ```
//!
//! Each flow ends where the first gap is zero, to rounding (smooth flows also where forces jump or change
//! their law, see [`crate::event`]); then the same problem without forces and duration gives the velocities
//! after an impact. Where velocities contradict a joint, or a resting contact, they first meet what it asks
//! for, by an impact that has no time of its own.

use tangency_collision::Contact;
use tangency_lcp::LcpSolver;

use crate::event::{Event, ended};
use crate::island::assemble;
use crate::mend::mend_positions;
use crate::momentum::momentum_into;
use crate::motion::Motion;
use crate::path::{Gap, Hit};
use crate::record::StepRecord;
use crate::row::{RowContext, RowSource};
use crate::scene::Scene;
use crate::scratch::StepScratch;
use crate::smooth::End;
use crate::solve::solve;
use crate::step::{fixed, integrate};
use crate::touch::{Survey, Touch};
use crate::{State, StepError};

/// Steps of Newton's method towards the time of an impact, at most.
const MAX_NEWTON: usize = 16;

/// Part of a step by which times differ that are the same.
const SAME: f64 = 1e-16;

/// Part of a step that is too short for positions to ask for velocities.
const INSTANT: f64 = 1e-9;

/// A step that is to be divided.
pub(crate) struct Division<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) solver: &'a dyn LcpSolver,
    pub(crate) control: &'a [f64],
    /// Impacts, or events, that may divide it.
    pub(crate) most: u32,
    /// Whether its flows are smooth.
    pub(crate) smooth: bool,
}

/// How a step goes on.
enum Next {
    /// To its end.
    Whole(StepRecord),
    /// Until something happens; of gaps that close an impact follows.
    Until(StepRecord, Option<Event>),
    /// By a fixed step, because it was divided too often or no motion obeys all laws.
    Fixed,
}

/// What a part of the step models.
struct Plan<'a> {
    motion: Motion,
    dt: f64,
    contacts: Vec<Contact>,
    bounces: Vec<bool>,
    reached: &'a [RowSource],
    hit: Option<RowSource>,
    /// A step with about the same rows.
    before: Option<&'a StepRecord>,
}

impl Division<'_> {
    /// The whole step; `before` is the one before it.
    pub(crate) fn step(
        &self,
        state: &State,
        before: Option<&StepRecord>,
        scratch: &mut StepScratch,
    ) -> Result<StepRecord, StepError> {
        let (mut parts, mut left, mut now) = (Vec::new(), self.scene.dt, state.clone());
        let (mut hit, mut jolted, mut events) = (None, false, 0);
        if self.smooth && before.is_none() && self.scene.joints.iter().any(|j| j.softness.is_none())
        {
            let joined = self.join(&now, scratch)?;
            now.clone_from(&joined.after);
            parts.push(joined);
        }
        let mut last = loop {
            let mut survey = Survey::new(self.scene, &now, self.control, self.smooth, scratch)?;
            if jolted {
                survey.settle();
            } else if hit.is_some() || survey.jolts() {
                if hit.is_none() && survey.closes() {
                    let Some(still) = self.met(self.flow(&now, &survey, 0.0, None, scratch))?
                    else {
                        break self.rest(&now, left, scratch)?;
                    };
                    parts.push(still);
                }
                let impact = self.impact(&now, &mut survey, hit.take(), scratch)?;
                events += u32::from(impact.hit.is_some());
                now.clone_from(&impact.after);
                parts.push(impact);
                jolted = true;
                continue;
            }
            jolted = false;
            let before = if parts.is_empty() { before } else { self.last_flow(&parts) };
            match self.next(&now, &survey, left, events < self.most, before, scratch)? {
                Next::Whole(flow) => break flow,
                Next::Fixed => break self.rest(&now, left, scratch)?,
                Next::Until(part, event) => {
                    match event {
                        Some(Event::Hit(first)) => hit = Some(first.gap),
                        Some(_) => events += 1,
                        None => {}
                    }
                    left = (left - part.dt).max(0.0);
                    now.clone_from(&part.after);
                    parts.push(part);
                }
            }
        };
        last.parts = parts;
        Ok(last)
    }

    /// The last smooth flow of a step's parts.
    fn last_flow<'a>(&self, parts: &'a [StepRecord]) -> Option<&'a StepRecord> {
        parts.iter().rfind(|part| self.smooth && part.motion == Motion::Smooth)
    }

    /// The rest of a step as one of fixed length; nothing where that is rounding.
    fn rest(
        &self,
        now: &State,
        left: f64,
        scratch: &mut StepScratch,
    ) -> Result<StepRecord, StepError> {
        let (scene, solver) = (self.scene, self.solver);
        if left <= INSTANT * scene.dt {
            return Ok(StepRecord { fell_back: true, ..self.join(now, scratch)? });
        }
        let mut record = fixed(scene, solver, now, None, self.control, left, scratch)?;
        record.fell_back = true;
        Ok(record)
    }

    /// The next flow, to its first event or to the end of what is `left`; `divides` tells whether the step
    /// may be divided.
    fn next(
        &self,
        now: &State,
        survey: &Survey,
        left: f64,
        divides: bool,
        before: Option<&StepRecord>,
        scratch: &mut StepScratch,
    ) -> Result<Next, StepError> {
        let length = if self.smooth { self.until_clock(now, left) } else { left };
        let Some(flow) = self.met(self.flow(now, survey, length, before, scratch))? else {
            return Ok(Next::Fixed);
        };
        let Some(event) = self.met(self.first_event(now, &flow, survey, scratch))? else {
            return Ok(Next::Fixed);
        };
        let Some(event) = event else { return Ok(Self::whole(flow, length < left)) };
        if !divides {
            return Ok(Next::Fixed);
        }
        let Some(found) = self.met(self.until(now, survey, event, length, scratch))? else {
            return Ok(Next::Fixed);
        };
        let Some((part, event)) = found else { return Ok(Self::whole(flow, length < left)) };
        scratch.recycle(flow);
        Ok(Next::Until(part, Some(event)))
    }

    /// What a flow came to; `None` where no smooth motion obeys all laws.
    fn met<T>(&self, answer: Result<T, StepError>) -> Result<Option<T>, StepError> {
        match answer {
            Ok(found) => Ok(Some(found)),
            Err(StepError::Lcp { .. }) if self.smooth => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// A flow without events, which is the last of its step unless a force begins or ends there.
    fn whole(flow: StepRecord, cut: bool) -> Next {
        if cut { Next::Until(ended(flow, End::Clock), None) } else { Next::Whole(flow) }
    }

    /// The flow that ends where a gap is zero, by Newton's method; `None` if that is not within `left`.
    pub(crate) fn locate(
        &self,
        now: &State,
        survey: &Survey,
        hit: Hit,
        left: f64,
        scratch: &mut StepScratch,
    ) -> Result<Option<StepRecord>, StepError> {
        let (mut tau, mut off) = (hit.at.clamp(0.0, left), f64::INFINITY);
        for _ in 0..MAX_NEWTON {
            let flow = self.flow(now, survey, tau, None, scratch)?;
            let [gap, rate] = hit.gap.evaluate(self.scene, &flow.after);
            let next = tau - gap / rate;
            if rate >= 0.0 || !next.is_finite() || next > left {
                scratch.recycle(flow);
                return Ok(None);
            }
            let next = next.max(0.0);
            if (next - tau).abs() <= SAME * self.scene.dt || gap.abs() >= off {
                return Ok(Some(flow));
            }
            (tau, off) = (next, gap.abs());
            scratch.recycle(flow);
        }
        Ok(Some(self.flow(now, survey, tau, None, scratch)?))
    }

    /// A flow of length `dt` in which what rests stays closed.
    pub(crate) fn flow(
        &self,
        now: &State,
        survey: &Survey,
        dt: f64,
        before: Option<&StepRecord>,
        scratch: &mut StepScratch,
    ) -> Result<StepRecord, StepError> {
        if self.smooth {
            return self.smooth(now, survey, dt, before, scratch);
        }
        let mut contacts = scratch.contacts.take();
        contacts
            .extend(survey.with(|_, touch| touch == Touch::Resting).map(|(contact, _)| *contact));
        let (motion, reached) = (Motion::Flow, survey.reached.as_slice());
        let plan = Plan { motion, dt, contacts, bounces: Vec::new(), reached, hit: None, before };
        self.part(now, plan, scratch)
    }

    /// An impact of the rigid joints alone, where nobody knows that velocities obey them. It changes none
    /// that do, but it tells how those depend on a state that may change in any direction.
    fn join(&self, now: &State, scratch: &mut StepScratch) -> Result<StepRecord, StepError> {
        let (motion, contacts, bounces) = (Motion::Impact, Vec::new(), Vec::new());
        let reached = &[];
        let plan = Plan { motion, dt: 0.0, contacts, bounces, reached, hit: None, before: None };
        self.part(now, plan, scratch)
    }

    /// The impact of all that touches. `hit` is the gap whose time was located.
    fn impact(
        &self,
        now: &State,
        survey: &mut Survey,
        hit: Option<Gap>,
        scratch: &mut StepScratch,
    ) -> Result<StepRecord, StepError> {
        survey.add(hit);
        let (mut contacts, mut bounces) = (scratch.contacts.take(), scratch.flags.take());
        for (contact, touch) in survey.with(|_, touch| touch != Touch::Apart) {
            contacts.push(*contact);
            bounces.push(touch == Touch::Closing { bounces: true });
        }
        let (motion, dt, hit) = (Motion::Impact, 0.0, survey.cause(hit));
        let reached = survey.reached.as_slice();
        let plan = Plan { motion, dt, contacts, bounces, reached, hit, before: None };
        self.part(now, plan, scratch)
    }

    /// Models and solves a part of the step.
    fn part(
        &self,
        now: &State,
        plan: Plan<'_>,
        scratch: &mut StepScratch,
    ) -> Result<StepRecord, StepError> {
        let Plan { motion, dt, mut contacts, bounces, reached, hit, before } = plan;
        let mut midway = scratch.vectors.take();
        midway.extend(now.q.iter().zip(&now.v).map(|(q, v)| q + 0.5 * dt * v));
        scratch.frames.place(&midway);
        for contact in &mut contacts {
            let [a, b] = contact.feature.id.bodies.map(|body| scratch.frames.body(body as usize));
            *contact = contact.feature.evaluate_in(a, b);
        }
        let context = RowContext::of(self.scene, now, self.control, dt);
        let context =
            RowContext { motion, q: &midway, contacts: &contacts, marked: &bounces, ..context };
        let mut momentum = scratch.vectors.take();
        momentum_into(&context, &scratch.frames, now.time, &mut momentum);
        let mut rows = std::mem::take(&mut scratch.rows);
        rows.reached.clear();
        rows.reached.extend_from_slice(reached);
        rows.fill(&context, &scratch.frames, scratch.detection.groups());
        let islands = assemble(&context, &momentum, &mut rows, scratch);
        scratch.rows = rows;
        if let Some(before) = before {
            scratch.places.find(before, &contacts);
        }
        let islands = solve(&context, self.solver, now.time, before, islands, scratch)?;
        let after = integrate(&context, now, &momentum, &islands, scratch);
        scratch.vectors.give(momentum);
        let (control, parts, post) = (scratch.copy_control(self.control), Vec::new(), Vec::new());
        let mut record = StepRecord {
            control,
            motion,
            dt,
            parts,
            hit,
            midway,
            bounces,
            contacts,
            islands,
            smooth: None,
            fell_back: false,
            post,
            after,
        };
        if dt > 0.0 {
            mend_positions(self.scene, self.solver, &now.q, &mut record, scratch)?;
        }
        record.after.check(self.scene.bodies.len())?;
        Ok(record)
    }
}
