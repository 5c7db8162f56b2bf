//! What the step before tells about the modes of this one.

use tangency_collision::Contact;
use tangency_lcp::{Guess, Law, Mode};

use crate::island::Island;
use crate::record::StepRecord;
use crate::row::RowSource;

/// An island of a record, and a row of it.
type Place = (u32, u32);

/// Where the rows of the step before are.
#[derive(Debug, Default)]
pub(crate) struct Places {
    /// Index of each contact in the step before; [`NONE`] if it is new.
    contact: Vec<u32>,
    /// Place of the normal row of each contact of the step before.
    normal: Vec<Place>,
    /// Place of the first limit or motor row of each joint.
    joint: Vec<Place>,
    /// Whether the contacts are the same.
    same: bool,
    /// Whether the places are known.
    indexed: bool,
}

const NONE: u32 = u32::MAX;

impl Places {
    /// Finds the contacts of a step in the step before; both are in the order of their ids.
    pub(crate) fn find(&mut self, before: &StepRecord, contacts: &[Contact]) {
        let id = |contact: &Contact| contact.feature.id;
        self.indexed = false;
        self.same = before.contacts.len() == contacts.len()
            && before.contacts.iter().zip(contacts).all(|(a, b)| id(a) == id(b));
        if self.same {
            return;
        }
        self.contact.clear();
        let mut old = before.contacts.iter().map(id).zip(0..).peekable();
        for contact in contacts {
            while old.next_if(|(old, _)| *old < id(contact)).is_some() {}
            let known = old.next_if(|(old, _)| *old == id(contact));
            self.contact.push(known.map_or(NONE, |(_, index)| index));
        }
    }

    fn index(&mut self, before: &StepRecord, joints: usize) {
        self.indexed = true;
        for (list, len) in [(&mut self.normal, before.contacts.len()), (&mut self.joint, joints)] {
            list.clear();
            list.resize(len, (NONE, NONE));
        }
        for (island, record) in (0_u32..).zip(before.problems()) {
            for (row, source) in (0_u32..).zip(&record.sources) {
                match source {
                    RowSource::Normal { contact } => {
                        self.normal[*contact as usize] = (island, row);
                    }
                    RowSource::Lower { joint }
                    | RowSource::Upper { joint }
                    | RowSource::Motor { joint } => {
                        let place = &mut self.joint[*joint as usize];
                        if place.0 == NONE {
                            *place = (island, row);
                        }
                    }
                    RowSource::Held { .. } | RowSource::Tangent { .. } => {}
                }
            }
        }
    }

    /// Writes the modes and impulses that an island's rows had in the step before.
    pub(crate) fn guess(
        &mut self,
        before: &StepRecord,
        index: usize,
        island: &Island,
        joints: usize,
        guess: &mut Guess,
    ) {
        guess.modes.clear();
        guess.impulses.clear();
        let unchanged =
            before.problems().get(index).filter(|old| self.same && old.sources == island.sources);
        if let Some(old) = unchanged {
            guess.modes.extend_from_slice(&old.solution.modes);
            guess.impulses.extend_from_slice(&old.solution.impulses);
            return;
        }
        if !self.indexed {
            self.index(before, joints);
        }
        for row in 0..island.sources.len() {
            let (mode, impulse) = self
                .known(before, island, row)
                .unwrap_or_else(|| (likely(island, row, &guess.modes), 0.0));
            guess.modes.push(mode);
            guess.impulses.push(impulse);
        }
    }

    fn known(&self, before: &StepRecord, island: &Island, row: usize) -> Option<(Mode, f64)> {
        let at = |place: Place| {
            let record = before.problems().get(place.0 as usize)?;
            let (row, solution) = (place.1 as usize, &record.solution);
            Some((
                *record.sources.get(row)?,
                *solution.modes.get(row)?,
                *solution.impulses.get(row)?,
            ))
        };
        let normal = |contact: u32| {
            let old = if self.same { contact } else { *self.contact.get(contact as usize)? };
            self.normal.get(old as usize).copied()
        };
        match island.sources[row] {
            RowSource::Held { .. } => None,
            RowSource::Normal { contact } => at(normal(contact)?).map(|(_, m, y)| (m, y)),
            RowSource::Tangent { contact } => {
                let (island, row) = normal(contact)?;
                let (source, mode, impulse) = at((island, row.checked_add(1)?))?;
                matches!(source, RowSource::Tangent { .. }).then_some((mode, impulse))
            }
            source @ (RowSource::Lower { joint }
            | RowSource::Upper { joint }
            | RowSource::Motor { joint }) => {
                let (island, row) = *self.joint.get(joint as usize)?;
                let next = |k: u32| at((island, row.checked_add(k)?));
                let found = (0..3).filter_map(next).find(|(old, ..)| *old == source)?;
                Some((found.1, found.2))
            }
        }
    }
}

/// Writes the modes that the rows of an island without a past are likely to have.
pub(crate) fn guess_likely(island: &Island, guess: &mut Guess) {
    guess.modes.clear();
    guess.impulses.clear();
    for row in 0..island.sources.len() {
        let mode = likely(island, row, &guess.modes);
        guess.modes.push(mode);
        guess.impulses.push(0.0);
    }
}

/// The mode that a row without a past takes: closed where it would be violated at the free velocities.
fn likely(island: &Island, row: usize, modes: &[Mode]) -> Mode {
    let (problem, index) = (&island.problem, row);
    let row = &problem.rows[index];
    match row.law {
        Law::Equality | Law::Bounded { .. } => Mode::Active,
        Law::Friction { normal, .. } => modes[normal as usize],
        Law::Unilateral => {
            let free = |(body, block): (usize, &nalgebra::Vector3<f64>)| {
                block.dot(&problem.momentum[body].component_div(&problem.mass[body]))
            };
            let closes = row.blocks().map(free).sum::<f64>() < row.rhs;
            if closes { Mode::Active } else { Mode::Open }
        }
    }
}
