//! The cases, by theme.

use crate::Case;

mod bouncing;
mod chain;
mod collisions;
mod consistency;
mod cradle;
mod double_pendulum;
mod driven;
mod extremes;
mod families;
mod fast;
mod flight;
mod friction;
mod grazing;
mod groove;
mod growth;
mod impact;
mod incline;
mod infeasible;
mod ladder;
mod linkages;
mod mixed;
mod pendulum;
mod questions;
mod quiet;
mod raw;
mod reactions;
mod redundant;
mod retold;
mod rolling;
mod shots;
mod simultaneous;
mod standing;
mod stopping;
mod strained;
mod thresholds;
mod tipping;
mod told;

/// All cases, by identifier.
#[must_use]
pub fn cases() -> Vec<&'static Case> {
    let mut cases: Vec<&'static Case> = [
        bouncing::CASES,
        chain::CASES,
        collisions::CASES,
        consistency::CASES,
        cradle::CASES,
        double_pendulum::CASES,
        driven::CASES,
        extremes::CASES,
        families::CASES,
        fast::CASES,
        flight::CASES,
        friction::CASES,
        grazing::CASES,
        groove::CASES,
        growth::CASES,
        impact::CASES,
        incline::CASES,
        infeasible::CASES,
        ladder::CASES,
        linkages::CASES,
        pendulum::CASES,
        quiet::CASES,
        raw::CASES,
        reactions::CASES,
        redundant::CASES,
        retold::CASES,
        rolling::CASES,
        shots::CASES,
        simultaneous::CASES,
        standing::CASES,
        stopping::CASES,
        strained::CASES,
        thresholds::CASES,
        tipping::CASES,
    ]
    .into_iter()
    .flatten()
    .collect();
    cases.sort_by_key(|case| case.id);
    cases
}

/// Sums of normal and of tangential contact impulses of a step, N·s.
pub(crate) fn contact_sums(record: &tangency_core::StepRecord) -> (f64, f64) {
    let impulses = record.contact_impulses();
    (impulses.iter().map(|i| i.normal).sum(), impulses.iter().map(|i| i.tangent).sum())
}

/// Greatest change of a body's pose since the start of a run.
pub(crate) fn moved(run: &crate::Run) -> f64 {
    let start = &run.tape.initial.q;
    run.worst(|s| s.q.iter().zip(start).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max))
}

/// Impulse of a joint's held row, N·s; NaN if it was not modelled.
pub(crate) fn held_impulse(record: &tangency_core::StepRecord, joint: u32, row: u32) -> f64 {
    record.impulse(tangency_core::RowSource::Held { joint, row }).unwrap_or(f64::NAN)
}
