//! Positions that are wrong by more than rounding after the move, mended by a displacement of least
//! mass-weighted size.

use nalgebra::Vector3;
use tangency_collision::Contact;
use tangency_lcp::{Law, Lcp, LcpSolver};

use crate::island::assemble;
use crate::record::{PostRecord, StepRecord};
use crate::row::{RowContext, Stage};
use crate::scene::Scene;
use crate::scratch::StepScratch;
use crate::solve::solve;
use crate::{Correction, Stabilisation, StepError};

/// Displaces `record.after` by dt w where the moved poses are wrong:
/// min ½ wᵀMw subject to the joints' and contacts' position rows.
pub(crate) fn mend_positions(
    scene: &Scene,
    solver: &dyn LcpSolver,
    record: &mut StepRecord,
    scratch: &mut StepScratch,
) -> Result<(), StepError> {
    let loose = loose_bodies(record, scratch);
    let Stabilisation { joints, contacts } = scene.stabilisation();
    let mends_contacts = contacts == Correction::Post && !record.contacts.is_empty();
    if loose.is_empty() && joints != Correction::Post && !mends_contacts {
        return Ok(());
    }
    let mut moved = scratch.vectors.take();
    moved.extend_from_slice(&record.after.q);
    let contacts = evaluate_at(&record.contacts, &moved, scratch);
    let (stage, v, control) = (Stage::Post, &record.after.v, &record.control);
    let context =
        RowContext { scene, stage, q: &moved, v, control, contacts: &contacts, loose: &loose };
    if !needs_mending(&context, scratch) {
        scratch.vectors.give(moved);
        scratch.contacts.give(contacts);
        scratch.flags.give(loose);
        return Ok(());
    }
    let still = scratch.vectors.filled(moved.len(), Vector3::zeros());
    let mut rows = std::mem::take(&mut scratch.rows);
    rows.list(&context, &scratch.frames, scratch.detection.groups());
    let mut islands = assemble(&context, &still, &mut rows, scratch);
    scratch.rows = rows;
    scratch.vectors.give(still);
    for island in islands.extract_if(.., |island| !is_displaced(&island.problem)) {
        scratch.recycle_island(island);
    }
    let islands = solve(&context, solver, record.after.time, None, islands, scratch)?;
    for island in &islands {
        for (body, w) in island.bodies.iter().zip(&island.solution.velocities) {
            record.after.q[*body as usize] += scene.dt * w;
        }
    }
    record.post = Some(PostRecord { moved, contacts, loose, islands });
    Ok(())
}

/// Whether w = 0 breaks a row.
fn is_displaced(problem: &Lcp) -> bool {
    problem.rows.iter().any(|row| match row.law {
        Law::Equality => row.rhs != 0.0,
        _ => row.rhs > 0.0,
    })
}

/// The same features at other poses.
fn evaluate_at(
    contacts: &[Contact],
    q: &[Vector3<f64>],
    scratch: &mut StepScratch,
) -> Vec<Contact> {
    scratch.frames.place(q);
    let mut moved = scratch.contacts.take();
    moved.extend(contacts.iter().map(|contact| {
        let [a, b] = contact.feature.id.bodies.map(|body| scratch.frames.body(body as usize));
        contact.feature.evaluate_in(a, b)
    }));
    moved
}

/// Bodies of islands that let position errors stay; empty if there are none.
fn loose_bodies(record: &StepRecord, scratch: &mut StepScratch) -> Vec<bool> {
    let mut loose = scratch.flags.take();
    for island in record.islands.iter().filter(|island| island.stage.drifts()) {
        loose.resize(record.after.q.len(), false);
        island.bodies.iter().for_each(|body| loose[*body as usize] = true);
    }
    loose
}

fn needs_mending(context: &RowContext<'_>, scratch: &StepScratch) -> bool {
    let index = |i: usize| u32::try_from(i).expect("fewer than u32 counts");
    let penetrates = |contact: usize| {
        let (contact, gap) = (index(contact), context.contacts[contact].gap);
        gap < 0.0 && gap < -context.contact_slop(contact) && context.mends_contact(contact)
    };
    let drifts = |joint: usize| {
        let (held, joint) = (&context.scene.joints[joint], index(joint));
        let error = |row| context.joint_geometry_in(joint, row, &scratch.frames).value;
        held.softness.is_none()
            && context.mends_joint(joint)
            && held.held.iter().any(|row| error(*row) != 0.0)
    };
    (0..context.contacts.len()).any(penetrates) || (0..context.scene.joints.len()).any(drifts)
}
