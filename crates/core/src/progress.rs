//! How far the errors of a step are mended, island by island: whether another displacement pays.
//!
//! Displacements are steps of Newton's method: each leaves errors that are quadratic in those before
//! it, so that an error of a hundredth of a body's size becomes 10⁻⁴, 10⁻⁸, 10⁻¹⁶ of it. With errors e
//! in units of what counts as rounding, an island is displaced again if
//!
//! ```text
//!  1 < e < e_before/2
//! ```
//!
//! What does not shrink is a contradiction, or the rounding of large coordinates. Joints that are far from
//! contradicting each other go on up to e < 2 e_before: a chain that is nearly straight (a fold, where
//! Newton's method overshoots) first gets worse, and then by factors of 4 better.

use tangency_collision::Contact;

use crate::frames::Frames;
use crate::island::Island;
use crate::record::{IslandRecord, PostRecord};
use crate::row::{RowContext, RowSource, Stage};
use crate::solve::is_lever;
use crate::{Joint, JointRow};

/// The share of its error that a displacement may leave if another one is to follow.
const SHRUNK: f64 = 0.5;
/// The same for joints that are far from contradicting each other.
const OVERSHOT: f64 = 2.0;
/// Most displacements of a step. Factors of 4 take an error of a tenth of a body's size to 10⁻⁹ in 14.
pub(crate) const MOST: usize = 16;

/// The part of what counts as rounding above which contacts that stay closed are mended.
const CLOSED: f64 = 1e-3;

/// What the last displacement did to the islands of a step.
#[derive(Debug, Default)]
pub(crate) struct Progress {
    /// Per body, what its island's error must be below to be mended again; empty before the first
    /// displacement.
    below: Vec<f64>,
    /// Whether rows of its island depend on each other.
    dependent: Vec<bool>,
}

impl Progress {
    /// Forgets the step before.
    pub(crate) fn begin(&mut self) {
        self.below.clear();
        self.dependent.clear();
    }

    /// Takes note of a displacement. Where rows gave way, what they left stays.
    pub(crate) fn note(&mut self, context: &RowContext<'_>, post: &PostRecord) {
        self.below.resize(context.q.len(), f64::INFINITY);
        self.dependent.resize(context.q.len(), false);
        for island in &post.islands {
            let rows = island.sources.iter().zip(&island.problem.rows);
            let error = worst(rows.map(|(source, row)| error(context, *source, row.rhs)));
            let below = error * tolerated(island);
            let system = island.solution.system.as_ref();
            let dependent = system.is_some_and(|system| system.rank_defect() > 0);
            for body in &island.bodies {
                self.below[*body as usize] = below;
                self.dependent[*body as usize] = dependent;
            }
        }
    }

    /// Whether an error of joints or contacts asks for a displacement. The first one mends joints to
    /// the last bit: derivatives shall not depend on which errors happen to be below rounding.
    pub(crate) fn asks(&self, context: &RowContext<'_>, frames: &Frames, first: bool) -> bool {
        let least = if first { 0.0 } else { 1.0 };
        let joint = |(index, joint): (u32, &Joint)| {
            let asks = |(row, held): (u32, &JointRow)| {
                let value = context.joint_geometry_in(index, *held, frames).value;
                let source = RowSource::Held { joint: index, row };
                self.is_left(context, source, value, joint.bodies, least)
            };
            let mends = joint.softness.is_none() && context.mends_joint(index);
            mends && (0..).zip(&joint.held).any(asks)
        };
        let contact = |(index, contact): (u32, &Contact)| {
            let source = RowSource::Normal { contact: index };
            let bodies = || context.contact_bodies(index).map(Some);
            let closed = context.stays_closed(index);
            let least = if closed && first { CLOSED } else { 1.0 };
            (contact.gap < 0.0 || closed)
                && self.is_left(context, source, contact.gap, bodies(), least)
        };
        (0..).zip(context.contacts).any(contact) || (0..).zip(&context.scene.joints).any(joint)
    }

    /// Whether the error of a row between these bodies is above `least`, and shrinks.
    fn is_left(
        &self,
        context: &RowContext<'_>,
        source: RowSource,
        value: f64,
        bodies: [Option<usize>; 2],
        least: f64,
    ) -> bool {
        if value == 0.0 || (least > 0.0 && value.abs() <= least * context.slop(source)) {
            return false;
        }
        let error = error(context, source, context.rhs(source, value, 0.0).value);
        error > least && bodies.into_iter().flatten().all(|body| self.shrinks(body, error))
    }

    fn shrinks(&self, body: usize, error: f64) -> bool {
        self.below.get(body).is_none_or(|below| error < *below)
    }

    /// Whether an island takes part in the next displacement.
    pub(crate) fn takes(&self, context: &RowContext<'_>, island: &Island) -> bool {
        let rows = island.sources.iter().zip(&island.problem.rows);
        let mut errors = rows.map(|(source, row)| error(context, *source, row.rhs));
        if self.below.is_empty() {
            return errors.any(|error| error > 0.0);
        }
        let error = worst(errors);
        error > 1.0 && self.shrinks(island.bodies[0] as usize, error)
    }

    /// The stage in which an island is displaced. Small errors of joints that depend on each other are
    /// known to a few digits, which always contradict each other.
    pub(crate) fn stage(&self, island: &Island) -> Stage {
        let dependent = self.dependent.get(island.bodies[0] as usize) == Some(&true);
        if dependent && island.problem.is_linear() { Stage::SoftPost } else { Stage::Post }
    }
}

/// The part of its error that an island may be left with if another displacement is to follow.
fn tolerated(island: &IslandRecord) -> f64 {
    match island.stage {
        Stage::Post if is_lever(&island.problem, &island.solution) => OVERSHOT,
        Stage::Post => SHRUNK,
        _ => 0.0,
    }
}

/// dt b in units of what counts as rounding: how far a row asks to be displaced.
fn error(context: &RowContext<'_>, source: RowSource, rhs: f64) -> f64 {
    let asked = asked(context, source, rhs);
    if asked > 0.0 { context.dt * asked / context.slop(source) } else { 0.0 }
}

/// The speed at which a row asks to be displaced; negative if it allows to be.
pub(crate) fn asked(context: &RowContext<'_>, source: RowSource, rhs: f64) -> f64 {
    match source {
        RowSource::Held { .. } => rhs.abs(),
        RowSource::Normal { contact } if context.stays_closed(contact) => rhs.abs(),
        _ => rhs,
    }
}

fn worst(errors: impl Iterator<Item = f64>) -> f64 {
    errors.fold(0.0, f64::max)
}
