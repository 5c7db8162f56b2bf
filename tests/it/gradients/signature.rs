//! On which piece of its law every row of a run lies.

use tangency::lcp::Mode;
use tangency::{Contact, ContactId, IslandRecord, Rollout, RowSource};

/// A row, named so that it is the same row in another run: contacts by their features.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Row {
    Joint(RowSource),
    Normal(ContactId),
    Tangent(ContactId),
}

/// Rows that are not open, with their modes, of every problem of every step.
pub(super) fn signature(tape: &Rollout) -> Vec<(usize, bool, Row, Mode)> {
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
