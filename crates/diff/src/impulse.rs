//! Impulses as results of a step: derivatives by them, and their changes.

use serde::{Deserialize, Serialize};
use tangency_core::{IslandRecord, RowSource, StepRecord};

use crate::error::DiffError;

/// A derivative by, or the change of, the impulse of one row.
///
/// Impulses are those of [`StepRecord::impulse`]: of a contact along its normal and its tangent, N·s on
/// body b; of a joint along the coordinates it holds, N·s or N·m·s; what displacements push with after
/// the step is none.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RowImpulse {
    /// Which of the step's [`parts`](StepRecord::parts) has the row; `None` for what was left of the
    /// step, and where nothing divides it.
    pub part: Option<usize>,
    /// The row.
    pub source: RowSource,
    /// ∂L/∂λ, or dλ.
    pub value: f64,
}

/// What a loss depends on of the impulses of a step, and which of it is meant now.
#[derive(Clone, Debug, Default)]
pub(crate) struct ImpulseSeeds {
    list: Vec<RowImpulse>,
    part: Option<usize>,
    /// Per row of an island.
    rows: Vec<f64>,
}

impl ImpulseSeeds {
    /// Takes the seeds of a step.
    pub(crate) fn take(
        &mut self,
        record: &StepRecord,
        list: Vec<RowImpulse>,
    ) -> Result<(), DiffError> {
        for it in &list {
            check(record, it)?;
        }
        self.list = list;
        self.part = None;
        Ok(())
    }

    /// What follows is about a part of the step, or what was left of it.
    pub(crate) fn go_to(&mut self, part: Option<usize>) {
        self.part = part;
    }

    /// Whether the loss sees impulses of the step.
    pub(crate) fn any(&self) -> bool {
        !self.list.is_empty()
    }

    /// Σ λ̄ dλ over the rows that both know.
    pub(crate) fn dot(&self, changes: &[RowImpulse]) -> f64 {
        let of = |seed: &RowImpulse| {
            let same = |it: &&RowImpulse| (it.part, it.source) == (seed.part, seed.source);
            changes.iter().find(same).map_or(0.0, |it| seed.value * it.value)
        };
        self.list.iter().map(of).sum()
    }

    /// Σ λ̄ λ over an island of the part.
    pub(crate) fn along(&mut self, island: &IslandRecord) -> f64 {
        let bars = self.of(island, 1.0).unwrap_or_default();
        bars.iter().zip(&island.solution.impulses).map(|(bar, impulse)| bar * impulse).sum()
    }

    /// λ̄ times `weight` per row of an island of the part; `None` if it has none.
    pub(crate) fn of(&mut self, island: &IslandRecord, weight: f64) -> Option<&[f64]> {
        let part = self.part;
        let mut found = false;
        self.rows.clear();
        self.rows.resize(island.sources.len(), 0.0);
        for it in self.list.iter().filter(|it| it.part == part) {
            if let Some(row) = island.sources.iter().position(|source| *source == it.source) {
                self.rows[row] += weight * it.value;
                found = true;
            }
        }
        found.then_some(&self.rows[..])
    }
}

/// Refuses what names no row of the step.
fn check(record: &StepRecord, it: &RowImpulse) -> Result<(), DiffError> {
    let RowImpulse { part, source, value } = *it;
    if !value.is_finite() {
        return Err(DiffError::NotFinite { what: "the seed of an impulse" });
    }
    let owner = match part {
        None => Some(record),
        Some(part) => record.parts.get(part),
    };
    match owner.and_then(|record| record.impulse(source)) {
        Some(_) => Ok(()),
        None => Err(DiffError::NoSuchRow { part, row: source }),
    }
}

/// The changes of the impulses of an island's rows, added to a list.
pub(crate) fn list(
    part: Option<usize>,
    island: &IslandRecord,
    changes: &[f64],
    to: &mut Vec<RowImpulse>,
) {
    let entry =
        |(source, value): (&RowSource, &f64)| RowImpulse { part, source: *source, value: *value };
    to.extend(island.sources.iter().zip(changes).map(entry));
}
