//! Positions that are wrong by more than rounding after the move, mended by displacements of least
//! mass-weighted size.

use nalgebra::Vector3;
use tangency_collision::{Contact, Pose};
use tangency_lcp::{LcpSolver, Mode};

use crate::island::{Island, assemble};
use crate::motion::Motion;
use crate::progress::{MOST, asked};
use crate::record::{IslandRecord, PostRecord, StepRecord};
use crate::row::{RowContext, RowSource, SlowRow};
use crate::scene::Scene;
use crate::scratch::StepScratch;
use crate::solve::solve;
use crate::{Correction, Stabilisation, StepError};

/// Displaces `record.after` by dt w, as often as poses are wrong and get better by it:
/// min ½ wᵀMw subject to the joints' and contacts' position rows. `before` are the poses before the
/// move.
pub(crate) fn mend_positions(
    scene: &Scene,
    solver: &dyn LcpSolver,
    before: &[Pose],
    record: &mut StepRecord,
    scratch: &mut StepScratch,
) -> Result<(), StepError> {
    let loose = loose_bodies(record, scratch);
    let Stabilisation { joints, contacts } = scene.stabilisation();
    let mends_contacts = contacts == Correction::Post && !record.contacts.is_empty();
    let mends = joints == Correction::Post || mends_contacts || record.motion.flows();
    if loose.is_empty() && !mends {
        scratch.flags.give(loose);
        return Ok(());
    }
    scratch.progress.begin();
    let mut next = evaluate(record, loose, scratch);
    while let Some(islands) = islands(scene, before, record, &mut next, scratch) {
        let context = record.post_context(scene, &next);
        let islands = solve(&context, solver, record.after.time, None, islands, scratch)?;
        displace(&mut record.after.q, record.dt, &islands);
        let mut loose = scratch.flags.take();
        loose.extend_from_slice(&next.loose);
        if record.post.is_empty() {
            record.post = scratch.posts.take();
        }
        record.post.push(PostRecord { islands, ..next });
        next = evaluate(record, loose, scratch);
    }
    scratch.recycle_post(next);
    Ok(())
}

/// q ← q + dt w.
fn displace(q: &mut [Pose], dt: f64, islands: &[IslandRecord]) {
    for island in islands {
        for (body, w) in island.bodies.iter().zip(&island.solution.velocities) {
            q[*body as usize] += dt * w;
        }
    }
}

/// Where the next displacement starts from.
fn evaluate(record: &StepRecord, loose: Vec<bool>, scratch: &mut StepScratch) -> PostRecord {
    let mut moved = scratch.vectors.take();
    moved.extend_from_slice(&record.after.q);
    let contacts = evaluate_at(&record.contacts, &moved, scratch);
    let slow = match record.post.last() {
        Some(last) => stopped(&last.slow, scratch),
        None => Vec::new(),
    };
    let marked = if record.motion.flows() && !record.contacts.is_empty() {
        pressed(record, scratch.flags.take())
    } else {
        Vec::new()
    };
    PostRecord { moved, contacts, loose, slow, marked, islands: Vec::new() }
}

/// Which contacts pressed in a flow, in memory that is used again.
pub(crate) fn pressed(record: &StepRecord, mut pressed: Vec<bool>) -> Vec<bool> {
    pressed.resize(record.contacts.len(), false);
    for island in record.problems() {
        for (row, source) in island.sources.iter().enumerate() {
            if let RowSource::Normal { contact } = source {
                pressed[*contact as usize] = match record.motion {
                    Motion::Smooth => island.solution.modes[row] == Mode::Active,
                    _ => island.solution.impulses[row] > 0.0,
                };
            }
        }
    }
    pressed
}

/// The same rows, which have moved as far as they may.
fn stopped(rows: &[SlowRow], scratch: &mut StepScratch) -> Vec<SlowRow> {
    let mut stopped = scratch.slow.take();
    stopped.extend(rows.iter().map(|row| SlowRow { speed: 0.0, ..*row }));
    stopped
}

/// The islands that are displaced next; `None` if there are none.
fn islands(
    scene: &Scene,
    before: &[Pose],
    record: &StepRecord,
    next: &mut PostRecord,
    scratch: &mut StepScratch,
) -> Option<Vec<Island>> {
    let (context, last) = (record.post_context(scene, next), record.post.last());
    let StepScratch { progress, frames, .. } = scratch;
    if record.post.len() == MOST || !progress.asks(&context, frames, last.is_none()) {
        return None;
    }
    if let Some(last) = last {
        progress.note(&context, last);
        if !progress.asks(&context, frames, false) {
            return None;
        }
    }
    let mut islands = list(&context, scratch);
    if islands.is_empty() {
        scratch.islands.give(islands);
        return None;
    }
    match last {
        Some(_) => islands.iter_mut().for_each(|island| soften(&context, island, scratch)),
        None => next.slow = slow_down(&context, before, &mut islands, scratch),
    }
    Some(islands)
}

/// The islands that take part, each mending all of its errors.
fn list(context: &RowContext<'_>, scratch: &mut StepScratch) -> Vec<Island> {
    let still = scratch.vectors.filled(context.q.len(), Vector3::zeros());
    let mut rows = std::mem::take(&mut scratch.rows);
    rows.fill(context, &scratch.frames, scratch.detection.groups());
    let mut islands = assemble(context, &still, &mut rows, scratch);
    scratch.rows = rows;
    scratch.vectors.give(still);
    let progress = std::mem::take(&mut scratch.progress);
    for island in islands.extract_if(.., |island| !progress.takes(context, island)) {
        scratch.recycle_island(island);
    }
    scratch.progress = progress;
    islands
}

/// Lets the rows of an island give way from the start if displacing it again asks for that.
fn soften(context: &RowContext<'_>, island: &mut Island, scratch: &StepScratch) {
    island.stage = scratch.progress.stage(island);
    if island.stage.gives_way() {
        let context = RowContext { stage: island.stage, ..*context };
        island.problem.soften(|row| context.softness(island.sources[row]));
    }
}

/// Bounds the speed of the rows that ask for more than their recovery speed, and lists them. What the
/// move opened of a joint that was nearly closed is closed at once.
fn slow_down(
    context: &RowContext<'_>,
    before: &[Pose],
    islands: &mut [Island],
    scratch: &mut StepScratch,
) -> Vec<SlowRow> {
    let mut slow = scratch.slow.take();
    for island in islands {
        for (source, row) in island.sources.iter().zip(&mut island.problem.rows) {
            let (asks, speed) = (asked(context, *source, row.rhs), context.recovery(*source));
            if asks > speed && was_open(context, before, *source, speed) {
                row.rhs = speed.copysign(row.rhs);
                slow.push(SlowRow { source: *source, speed });
            }
        }
    }
    slow.sort_unstable_by_key(|row| row.source);
    slow
}

/// Whether an error was there before the move that takes more than a step to remove. Of contacts and
/// limits every deep penetration counts as such.
fn was_open(context: &RowContext<'_>, before: &[Pose], source: RowSource, speed: f64) -> bool {
    match source {
        RowSource::Held { .. } => {}
        RowSource::Normal { contact } => return !context.stays_closed(contact),
        _ => return true,
    }
    let context = RowContext { q: before, ..*context };
    context.geometry(source).value.abs() > context.dt * speed
}

/// The same features at other poses.
pub(crate) fn evaluate_at(
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
