//! On which piece of its law every row of a run lies.

use tangency_core::lcp::Mode;
use tangency_core::{Contact, ContactId, IslandRecord, Rollout, RowSource};

/// A row, named so that it is the same row in another run: contacts by their features.
#[derive(Clone, Debug, PartialEq)]
pub enum Row {
    /// Of a joint.
    Joint(RowSource),
    /// Of a contact, along its normal.
    Normal(ContactId),
    /// Of a contact, along its tangent.
    Tangent(ContactId),
}

/// Rows that are not open, with their modes, of every problem of every step, and whether it is one after
/// the move. Runs with the same signature are on the same side of every switch.
#[must_use]
pub fn signature(tape: &Rollout) -> Vec<(usize, bool, Row, Mode)> {
    let mut all = Vec::new();
    for (k, record) in tape.records.iter().enumerate() {
        for island in &record.islands {
            all.extend(active(island, &record.contacts).map(|(row, mode)| (k, false, row, mode)));
        }
        for post in &record.post {
            for island in &post.islands {
                all.extend(active(island, &post.contacts).map(|(row, mode)| (k, true, row, mode)));
            }
        }
    }
    all
}

fn active<'a>(
    island: &'a IslandRecord,
    contacts: &'a [Contact],
) -> impl Iterator<Item = (Row, Mode)> + 'a {
    let id = |contact: u32| contacts[contact as usize].feature.id;
    let rows = island.sources.iter().zip(&island.solution.modes);
    rows.filter(|(_, mode)| **mode != Mode::Open).map(move |(source, mode)| {
        let row = match *source {
            RowSource::Normal { contact } => Row::Normal(id(contact)),
            RowSource::Tangent { contact } => Row::Tangent(id(contact)),
            joint => Row::Joint(joint),
        };
        (row, *mode)
    })
}
