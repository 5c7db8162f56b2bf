//! The cases, by theme.

use crate::Case;

mod chain;
mod driven;
mod extremes;
mod flight;
mod grazing;
mod groove;
mod incline;
mod reactions;
mod simultaneous;
mod standing;
mod strained;
mod thresholds;
mod tipping;

/// All cases, by identifier.
#[must_use]
pub fn cases() -> Vec<&'static Case> {
    let mut cases: Vec<&'static Case> = [
        chain::CASES,
        driven::CASES,
        extremes::CASES,
        flight::CASES,
        grazing::CASES,
        groove::CASES,
        incline::CASES,
        reactions::CASES,
        simultaneous::CASES,
        standing::CASES,
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
