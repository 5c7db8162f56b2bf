//! Derivatives of steps that impacts divide.
//!
//! The part before an event is a flow F(x, τ) whose length obeys g(F(x, τ)) = 0 (g a gap, or whatever tells
//! the time, see [`Event`]), the last part lasts for dt − Σ τ. With x̄ the gradient by the state that hits and l̄
//! that by the length of the last part,
//!
//! ```text
//!  dτ = −(∂g·dF + g_p dp)/ġ           ġ = ∂g·F_τ           dx = dF + F_τ dτ
//!  τ̄ = x̄·F_τ − l̄                      x̄ += ∂g ḡ,  p̄ += g_p ḡ           ḡ = −τ̄/ġ
//! ```
//!
//! (and τ̄ += λ̄·λ_τ, dλ += λ_τ dτ where impulses of the flow are asked for),
//!
//! which is the saltation of the motion (Leine & Nijmeijer 2004): how an impact that comes earlier or
//! later changes what follows.

use nalgebra::Vector3;
use tangency_core::row::{RowContext, RowSource};
use tangency_core::{Motion, Scene, State, StepRecord};

use crate::error::DiffError;
use crate::event::Event;
use crate::impulse::RowImpulse;
use crate::lcp::WEAK_MARGIN;
use crate::report::{GradientReport, Switch};
use crate::reverse::Reverse;
use crate::step::part_jvp;
use crate::vector::{Bars, Direction, SceneVector, StateVector};

impl Reverse {
    /// A divided step: as [`step`](Self::step).
    pub(crate) fn division(
        &mut self,
        scene: &Scene,
        before: &State,
        record: &StepRecord,
        bars: &mut Bars<'_>,
        report: &mut GradientReport,
    ) -> Result<(), DiffError> {
        report.go_to(None);
        self.impulses.go_to(None);
        let by_dt = std::mem::take(&mut bars.scene.dt);
        self.part(scene, start(before, record, record.parts.len()), record, bars, report)?;
        let by_length = bars.scene.dt;
        for (k, part) in record.parts.iter().enumerate().rev() {
            let before = start(before, record, k);
            report.go_to(Some(k + 1));
            if let Some(event) = Event::of(scene, part, record.parts.get(k + 1)) {
                self.event(scene, (k, before), (part, &event), by_length, bars, report)?;
            }
            report.go_to(Some(k));
            self.impulses.go_to(Some(k));
            self.part(scene, before, part, bars, report)?;
        }
        bars.scene.dt = by_dt + by_length;
        Ok(())
    }

    /// What comes through the time of an event, by the state that the flow before it, part k from the
    /// state `before`, ends in.
    fn event(
        &mut self,
        scene: &Scene,
        (k, before): (usize, &State),
        (flow, event): (&StepRecord, &Event<'_>),
        by_length: f64,
        bars: &mut Bars<'_>,
        report: &mut GradientReport,
    ) -> Result<(), DiffError> {
        let (rate, rates) = flow_rate(scene, before, flow, k)?;
        let opens = passing(event, &rate, flow, scene);
        if let Event::Gap(context, row) = event {
            add_switches(context, *row, opens, report);
        }
        let by_time = bars.state.dot(&rate) - by_length + self.impulses.dot(&rates);
        self.rotations.renew(before.q.len());
        event.pull(-by_time / opens, &mut self.rotations, bars);
        Ok(())
    }
}

/// The state before part k of a step, or before its last part.
fn start<'a>(before: &'a State, record: &'a StepRecord, k: usize) -> &'a State {
    if k == 0 { before } else { &record.parts[k - 1].after }
}

/// The change of the state after a step, divided or not, along a direction; adds those of its impulses to
/// `impulses`.
pub(crate) fn jvp(
    scene: &Scene,
    before: &State,
    record: &StepRecord,
    along: &Direction<'_>,
    impulses: &mut Vec<RowImpulse>,
) -> Result<StateVector, DiffError> {
    if record.parts.is_empty() {
        return part_jvp(scene, before, record, along, None, impulses);
    }
    let mut numbers = SceneVector { dt: 0.0, ..along.scene.clone() };
    let (mut state, mut length) = (along.state.clone(), along.scene.dt);
    for (k, part) in record.parts.iter().enumerate() {
        let (before, control) = (start(before, record, k), along.control);
        let direction = Direction { state: &state, control, scene: &numbers };
        let first = impulses.len();
        state = part_jvp(scene, before, part, &direction, Some(k), impulses)?;
        if let Some(event) = Event::of(scene, part, record.parts.get(k + 1)) {
            let (rate, rates) = flow_rate(scene, before, part, k)?;
            let direction = Direction { state: &state, control, scene: &numbers };
            let later = -event.along(&direction) / passing(&event, &rate, part, scene);
            state.add_scaled(later, &rate);
            let changes = impulses[first..].iter_mut().zip(&rates);
            changes.for_each(|(it, rate)| it.value += later * rate.value);
            length -= later;
        }
    }
    numbers.dt = length;
    let direction = Direction { state: &state, control: along.control, scene: &numbers };
    let before = start(before, record, record.parts.len());
    part_jvp(scene, before, record, &direction, None, impulses)
}

/// F_τ: how the end of a flow, part k of its step, and its impulses change with its length.
fn flow_rate(
    scene: &Scene,
    before: &State,
    flow: &StepRecord,
    k: usize,
) -> Result<(StateVector, Vec<RowImpulse>), DiffError> {
    let still = StateVector::like(before);
    let control = vec![0.0; flow.control.len()];
    let numbers = SceneVector { dt: 1.0, ..SceneVector::like(scene) };
    let along = Direction { state: &still, control: &control, scene: &numbers };
    let mut impulses = Vec::new();
    let end = part_jvp(scene, before, flow, &along, Some(k), &mut impulses)?;
    Ok((end, impulses))
}

/// ġ: how what tells the time of an event changes in time.
fn passing(event: &Event<'_>, rate: &StateVector, flow: &StepRecord, scene: &Scene) -> f64 {
    let control = vec![0.0; flow.control.len()];
    let still = SceneVector::like(scene);
    event.along(&Direction { state: rate, control: &control, scene: &still })
}

/// Tells whether the time of an impact is ill-conditioned, or that of several gaps.
fn add_switches(context: &RowContext<'_>, row: RowSource, opens: f64, report: &mut GradientReport) {
    if -opens <= WEAK_MARGIN * speeds(context, row) {
        report.add_switch(row, Switch::Grazing);
    }
    let closes = |contact: &u32| {
        let row = RowSource::Normal { contact: *contact };
        context.speed(&context.geometry(row)) < -WEAK_MARGIN * speeds(context, row)
    };
    if (0..).take(context.contacts.len()).filter(closes).count() > 1 {
        report.add_switch(row, Switch::Together);
    }
}

/// What adds up to the speed of a row.
fn speeds(context: &RowContext<'_>, row: RowSource) -> f64 {
    let geometry = context.geometry(row);
    let sides = geometry.bodies.iter().zip(&geometry.jacobian);
    let speed = |(body, j): (&Option<usize>, &Vector3<f64>)| {
        body.map_or(0.0, |body| j.abs().dot(&context.v[body].abs()))
    };
    sides.map(speed).sum()
}

/// Whether a step has derivatives that only its parts know.
pub(crate) fn is_divided(record: &StepRecord) -> bool {
    record.motion != Motion::Fixed || !record.parts.is_empty()
}
