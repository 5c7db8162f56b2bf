//! Steps that are divided where something closes.
//!
//! ```text
//!  flow τ₁ ── impact ── flow τ₂ ── impact ── … ── flow dt − Σ τ
//! ```
//!
//! Each flow ends where the first gap is zero, to rounding; then the same problem without forces and
//! duration gives the velocities after the impact. Where velocities contradict a joint, or a resting
//! contact, they first meet what it asks for, by an impact that has no time of its own.

use tangency_collision::Contact;
use tangency_lcp::LcpSolver;

use crate::island::assemble;
use crate::mend::mend_positions;
use crate::momentum::momentum_into;
use crate::motion::Motion;
use crate::path::{Gap, Hit, Path};
use crate::record::StepRecord;
use crate::row::{RowContext, RowSource};
use crate::scene::Scene;
use crate::scratch::StepScratch;
use crate::solve::solve;
use crate::step::{fixed, integrate};
use crate::touch::{Survey, Touch};
use crate::{State, StepError};

/// Steps of Newton's method towards the time of an impact, at most.
const MAX_NEWTON: usize = 16;

/// Part of a step by which times differ that are the same.
const SAME: f64 = 1e-16;

/// A step that is to be divided.
pub(crate) struct Division<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) solver: &'a dyn LcpSolver,
    pub(crate) control: &'a [f64],
    pub(crate) max_impacts: u32,
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
        let (mut hit, mut jolted, mut impacts) = (None, false, 0);
        let mut last = loop {
            let mut survey = Survey::new(self.scene, &now, self.control, scratch)?;
            if jolted {
                survey.settle();
            } else if hit.is_some() || survey.jolts() {
                if hit.is_none() && survey.closes() {
                    parts.push(self.flow(&now, &survey, 0.0, None, scratch)?);
                }
                let impact = self.impact(&now, &mut survey, hit.take(), scratch)?;
                impacts += u32::from(impact.hit.is_some());
                now.clone_from(&impact.after);
                parts.push(impact);
                jolted = true;
                continue;
            }
            jolted = false;
            let before = if parts.is_empty() { before } else { None };
            let flow = self.flow(&now, &survey, left, before, scratch)?;
            let Some(first) = self.first_hit(&now, &flow, &survey, scratch)? else { break flow };
            if impacts >= self.max_impacts {
                break fixed(self.scene, self.solver, &now, None, self.control, left, scratch)?;
            }
            let Some(to_hit) = self.locate(&now, &survey, first, left, scratch)? else {
                break flow;
            };
            scratch.recycle(flow);
            hit = Some(first.gap);
            left = (left - to_hit.dt).max(0.0);
            now.clone_from(&to_hit.after);
            parts.push(to_hit);
        };
        last.parts = parts;
        Ok(last)
    }

    fn first_hit(
        &self,
        now: &State,
        flow: &StepRecord,
        survey: &Survey,
        scratch: &mut StepScratch,
    ) -> Result<Option<Hit>, StepError> {
        if flow.dt == 0.0 {
            return Ok(None);
        }
        Path { scene: self.scene, from: now, flow }.first_hit(survey, scratch)
    }

    /// The flow that ends where a gap is zero, by Newton's method; `None` if that is not within `left`.
    fn locate(
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
    fn flow(
        &self,
        now: &State,
        survey: &Survey,
        dt: f64,
        before: Option<&StepRecord>,
        scratch: &mut StepScratch,
    ) -> Result<StepRecord, StepError> {
        let mut contacts = scratch.contacts.take();
        contacts
            .extend(survey.with(|_, touch| touch == Touch::Resting).map(|(contact, _)| *contact));
        let (motion, reached) = (Motion::Flow, survey.reached.as_slice());
        let plan = Plan { motion, dt, contacts, bounces: Vec::new(), reached, hit: None, before };
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
