//! Where a smooth flow ends, other than at the end of its step.
//!
//! ```text
//!  a gap or a limit closes                g = 0                            an impact follows
//!  a contact stops sliding                J_t v = 0
//!  a motor reaches its speed              J v = target
//!  a contact opens, begins to slide,      λn = 0,  |λt| = μ λn,            accelerations are continuous
//!  a motor gives way                      |λ| = max
//! ```
//!
//! What sliding contacts and motors do is looked at along the flow and at its end, impulses at the flow's
//! four slopes. The first event is then located by intervals and secants on the flow itself, with all that is
//! mended in it: speeds to rounding, impulses to a part of [`LATE`] behind the event, where only the other
//! mode obeys the laws. Single impulses are not unique where rows depend on each other: a mode changes only
//! if the complementarity problem has other accelerations.

use nalgebra::Vector3;
use tangency_collision::Contact;
use tangency_lcp::Mode;

use crate::path::{Hit, Path};
use crate::record::StepRecord;
use crate::resolve::Division;
use crate::row::{RowContext, RowSource};
use crate::scratch::StepScratch;
use crate::search::Search;
use crate::smooth::End;
use crate::touch::Survey;
use crate::{Motion, State, StepError};

/// Impulses that break their law by less than this part of all that drives a problem do not count.
const LATE: f64 = 1e-10;

/// Speeds are zero below this part of what counts as rounding.
const ZERO: f64 = 1e-3;

/// Parts of a step by which a force begins or ends later that begins or ends now.
const NOW: f64 = 1e-9;

/// Places along a flow at which speeds are looked at.
const LOOKS: [f64; 4] = [0.25, 0.5, 0.75, 1.0];

/// How often an event may turn out to have another one before it.
const EARLIER: usize = 8;

/// What ends a flow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Event {
    /// A gap or a limit closes.
    Hit(Hit),
    /// A speed is zero, which had this sign before.
    Stop {
        /// About when, s from the beginning of the flow.
        at: f64,
        /// A time at which it is past.
        within: f64,
        /// Whose.
        source: RowSource,
        /// ±1.
        sign: f64,
    },
    /// An impulse is at the end of its law.
    Force {
        /// A time at which it is past, s from the beginning of the flow.
        within: f64,
        /// How far it is from that at the beginning.
        margin: f64,
        /// Whose.
        source: RowSource,
    },
}

impl Division<'_> {
    /// The first event of a flow.
    pub(crate) fn first_event(
        &self,
        now: &State,
        flow: &StepRecord,
        survey: &Survey,
        scratch: &mut StepScratch,
    ) -> Result<Option<Event>, StepError> {
        if flow.dt == 0.0 {
            return Ok(None);
        }
        let path = Path::new(self.scene, now, flow);
        let hit = path.first_hit(survey, scratch)?;
        if !self.smooth {
            return Ok(hit.map(Event::Hit));
        }
        match (hit, self.first_stop(&path)) {
            (Some(hit), Some(Event::Stop { at, .. })) if hit.at <= at => Ok(Some(Event::Hit(hit))),
            (Some(hit), None) => Ok(Some(Event::Hit(hit))),
            (_, Some(stop)) => Ok(Some(stop)),
            (None, None) => self.first_switch(now, flow, survey, scratch),
        }
    }

    /// The flow that ends at its first event, of which `event` is a guess, within `length`; `None` if there
    /// is none after all.
    pub(crate) fn until(
        &self,
        now: &State,
        survey: &Survey,
        event: Event,
        length: f64,
        scratch: &mut StepScratch,
    ) -> Result<Option<(StepRecord, Event)>, StepError> {
        if let (Event::Hit(hit), false) = (event, self.smooth) {
            let flow = self.locate(now, survey, hit, length, scratch)?;
            return Ok(flow.map(|flow| (flow, event)));
        }
        let (mut found, mut next) = (None, Some(event));
        for _ in 0..EARLIER {
            let Some(event) = next.take() else { break };
            let limit = found.as_ref().map_or(length, |(flow, _): &(StepRecord, Event)| flow.dt);
            match self.located(now, survey, event, limit, scratch)? {
                Some(flow) => {
                    next = self.before(now, &flow, survey, event, scratch)?;
                    found = Some((flow, event));
                }
                None if matches!(event, Event::Hit(_)) => {
                    let flow = self.flow(now, survey, limit, None, scratch)?;
                    next = self.before(now, &flow, survey, event, scratch)?;
                }
                None => {}
            }
        }
        Ok(found.map(|(flow, event)| match event {
            Event::Hit(_) => (flow, event),
            Event::Stop { source, .. } => (ended(flow, End::Speed(source)), event),
            Event::Force { source, .. } => (ended(flow, End::Force(source)), event),
        }))
    }

    /// The flow that ends at an event; `None` if that is not within `limit`.
    fn located(
        &self,
        now: &State,
        survey: &Survey,
        event: Event,
        limit: f64,
        scratch: &mut StepScratch,
    ) -> Result<Option<StepRecord>, StepError> {
        match event {
            Event::Hit(hit) => self.locate(now, survey, hit, limit, scratch),
            Event::Stop { within, source, sign, .. } => {
                let first = self.flow(now, survey, 0.0, None, scratch)?;
                let rates = rates(&first);
                let speed = |flow: &StepRecord| {
                    let (speed, noise) = self.drift_of(flow, &rates, source, &flow.after);
                    (sign * speed, ZERO * noise)
                };
                let search = Search { start: speed(&first).0, within: within.min(limit) };
                search.find(self.scene.dt, |length| {
                    let flow = self.flow(now, survey, length, None, scratch)?;
                    let (value, zero) = speed(&flow);
                    Ok((value, zero, flow))
                })
            }
            Event::Force { within, margin, .. } => {
                let search = Search { start: margin + 3.0 * LATE, within: within.min(limit) };
                search.find(self.scene.dt, |length| {
                    let flow = self.flow(now, survey, length, None, scratch)?;
                    let (margin, _) = self.margin_after(&flow, survey, scratch)?;
                    Ok((margin + 3.0 * LATE, 2.0 * LATE, flow))
                })
            }
        }
    }

    /// An event of another kind or row in the flow that ends at `event`.
    fn before(
        &self,
        now: &State,
        flow: &StepRecord,
        survey: &Survey,
        event: Event,
        scratch: &mut StepScratch,
    ) -> Result<Option<Event>, StepError> {
        if flow.dt == 0.0 {
            return Ok(None);
        }
        let path = Path::new(self.scene, now, flow);
        if !matches!(event, Event::Hit(_)) {
            let hit = path.first_hit(survey, scratch)?;
            if let Some(hit) = hit.filter(|hit| hit.at < flow.dt * (1.0 - NOW)) {
                return Ok(Some(Event::Hit(hit)));
            }
        }
        match (self.first_stop(&path), event) {
            (Some(stop), _) => Ok(Some(stop)),
            (None, Event::Force { .. }) => Ok(None),
            (None, _) => self.first_switch(now, flow, survey, scratch),
        }
    }

    /// The first speed of a contact that slides, or of a motor at its maximum, that changes its sign.
    fn first_stop(&self, path: &Path<'_>) -> Option<Event> {
        let mut first: Option<(f64, Event)> = None;
        let rates = rates(path.flow);
        for (source, sign) in leaning(path.flow) {
            let speed = |state: &State| self.drift_of(path.flow, &rates, source, state);
            let mut last = (0.0, sign * speed(path.from).0);
            for part in LOOKS {
                let within = part * path.flow.dt;
                let state = if part < 1.0 { &path.state(within) } else { &path.flow.after };
                let (speed, noise) = speed(state);
                let value = sign * speed;
                if value < -noise {
                    let (s, before) = (last.0, f64::max(last.1, 0.0));
                    let at = s + (within - s) * before / (before - value);
                    if first.is_none_or(|(earliest, _)| at < earliest) {
                        first = Some((at, Event::Stop { at, within, source, sign }));
                    }
                    break;
                }
                last = (within, value);
            }
        }
        first.map(|(_, event)| event)
    }

    /// The speed of a row that slides, and what of it may be rounding, at another state.
    fn drift_of(
        &self,
        flow: &StepRecord,
        rates: &[Vector3<f64>],
        source: RowSource,
        state: &State,
    ) -> (f64, f64) {
        let context = RowContext::of(self.scene, state, self.control, self.scene.dt);
        let RowSource::Tangent { contact } = source else {
            return self.drift(&context, rates, source);
        };
        let feature = flow.contacts[contact as usize].feature;
        let [a, b] = feature.id.bodies.map(|body| &state.q[body as usize]);
        let contacts: [Contact; 1] = [feature.evaluate(a, b)];
        let context = RowContext { contacts: &contacts, ..context };
        self.drift(&context, rates, RowSource::Tangent { contact: 0 })
    }

    /// The first impulse that leaves its law.
    fn first_switch(
        &self,
        now: &State,
        flow: &StepRecord,
        survey: &Survey,
        scratch: &mut StepScratch,
    ) -> Result<Option<Event>, StepError> {
        let Some(smooth) = &flow.smooth else { return Ok(None) };
        let margin = |index: usize| {
            let slope = &smooth.slopes[index];
            self.margin(&flow.slope_context(self.scene, slope), slope).0
        };
        let leaves = |index: usize| margin(index) < -LATE;
        let shorter;
        let (within, looked) = if leaves(3) {
            (flow.dt, flow)
        } else if leaves(1) || leaves(2) {
            shorter = self.flow(now, survey, 0.5 * flow.dt, None, scratch)?;
            (0.5 * flow.dt, &shorter)
        } else {
            return Ok(None);
        };
        let (after, source) = self.margin_after(looked, survey, scratch)?;
        let event = || Event::Force { within, margin: margin(0).max(0.0), source };
        Ok((after < -LATE).then(event))
    }

    /// How long a flow may be until a force begins or ends.
    pub(crate) fn until_clock(&self, now: &State, left: f64) -> f64 {
        let ends = self.scene.forces.iter().flat_map(|force| [force.start, force.end]);
        let ahead = ends.map(|end| end - now.time).filter(|ahead| *ahead > NOW * self.scene.dt);
        let next = ahead.fold(f64::INFINITY, f64::min);
        if next < left - NOW * self.scene.dt { next } else { left }
    }
}

/// How fast bodies accelerate in a flow, about.
fn rates(flow: &StepRecord) -> Vec<Vector3<f64>> {
    flow.smooth.as_ref().map_or_else(Vec::new, |smooth| smooth.slopes[0].rates())
}

/// The rows of a flow whose impulses are at an end of their law, with the sign of their speed.
fn leaning(flow: &StepRecord) -> Vec<(RowSource, f64)> {
    let mut all = Vec::new();
    if flow.motion != Motion::Smooth {
        return all;
    }
    for island in flow.problems() {
        for (source, mode) in island.sources.iter().zip(&island.solution.modes) {
            match mode {
                Mode::Lower => all.push((*source, 1.0)),
                Mode::Upper => all.push((*source, -1.0)),
                Mode::Active | Mode::Open => {}
            }
        }
    }
    all
}

/// A flow that ended before its step did.
pub(crate) fn ended(mut flow: StepRecord, end: End) -> StepRecord {
    if let Some(smooth) = &mut flow.smooth {
        smooth.end = Some(end);
    }
    flow
}
