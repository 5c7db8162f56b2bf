//! What was not smooth along a gradient.

use tangency_core::row::{RowContext, Stage};
use tangency_core::{ContactModel, IslandRecord, Motion, RowSource};

use crate::lcp::{LcpGradientReport, WEAK_MARGIN, WeakKind, WeakRow};

/// Between which two pieces a row was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Switch {
    /// Open and closed: zero impulse and zero slack.
    Touching,
    /// Sticking and sliding.
    Slipping,
    /// Below and at a motor's greatest effort.
    Saturating,
    /// Reaching the other body within the step, and so bouncing off it, or just not.
    Bouncing,
    /// Several gaps that close at once: the time of the impact is that of the row named here.
    Together,
    /// Closing so slowly, for how fast it moves, that the time of the impact is ill-conditioned.
    Grazing,
}

impl From<WeakKind> for Switch {
    fn from(kind: WeakKind) -> Self {
        match kind {
            WeakKind::Touching => Self::Touching,
            WeakKind::Slipping => Self::Slipping,
            WeakKind::Saturating => Self::Saturating,
        }
    }
}

/// A row that was between two pieces, so that its derivative holds on one side only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneSided {
    /// The step.
    pub step: usize,
    /// Which of the step's [`parts`](tangency_core::StepRecord::parts) has the row; `None` for what was
    /// left of the step, and where nothing divides it.
    pub part: Option<usize>,
    /// The row.
    pub source: RowSource,
    /// Between which pieces.
    pub kind: Switch,
    /// Which problem of the step the row belongs to.
    pub stage: Stage,
}

/// An island whose rows contradicted each other, so that some gave way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GaveWay {
    /// The step.
    pub step: usize,
    /// How much gave way.
    pub stage: Stage,
}

/// What a gradient's user should know about it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GradientReport {
    /// Rows at a switch, by step.
    pub one_sided: Vec<OneSided>,
    /// Steps with dependent active rows: velocities and their derivatives are unique, impulses are
    /// not.
    pub dependent_rows: Vec<usize>,
    /// Islands in which restitution or the correction of positions gave way; the derivative is that
    /// of the problem that was solved.
    pub gave_way: Vec<GaveWay>,
    /// Steps in which more impacts were in reach than the scene divides a step for, so that their rest
    /// was one of fixed length.
    pub fell_back: Vec<usize>,
    /// Steps at which the loss sees impulses that dependent rows share in a way of their own, so that it
    /// is a convention by which it depends on them.
    pub undetermined_impulses: Vec<usize>,
    /// How much the adjoint has grown back to each state of a rollout, the initial one first: its norm in
    /// the metric of the masses, relative to those of all derivatives of the loss by states from there on
    /// (a change of velocity counts for what it does in the time of the run). Without unit; nothing is
    /// clipped.
    pub growth: Vec<f64>,
    step: usize,
    part: Option<usize>,
}

impl GradientReport {
    pub(crate) fn begin(&mut self, step: usize) {
        self.step = step;
        self.part = None;
    }

    /// What follows is about a part of the step, or what was left of it.
    pub(crate) fn go_to(&mut self, part: Option<usize>) {
        self.part = part;
    }

    pub(crate) fn add(&mut self, island: &IslandRecord, report: &LcpGradientReport) {
        let (step, part) = (self.step, self.part);
        if report.rank_defect > 0 && self.dependent_rows.last() != Some(&step) {
            self.dependent_rows.push(step);
        }
        if report.undetermined && self.undetermined_impulses.last() != Some(&step) {
            self.undetermined_impulses.push(step);
        }
        if island.stage.gives_way() {
            self.gave_way.push(GaveWay { step, stage: island.stage });
        }
        let row = |weak: &WeakRow| OneSided {
            step,
            part,
            source: island.sources[weak.row as usize],
            kind: weak.kind.into(),
            stage: island.stage,
        };
        self.one_sided.extend(report.weak.iter().map(row));
    }

    /// Adds the contacts for which `gap + dt Jₙ v⁻` is zero to rounding, the switch of restitution.
    pub(crate) fn add_bounces(&mut self, context: &RowContext<'_>, island: &IslandRecord) {
        let bounces = island.stage != Stage::Plastic;
        let gaps = context.motion == Motion::Fixed
            && context.scene.contact_model() == ContactModel::Gap
            && !context.contacts.is_empty();
        if !gaps || !bounces {
            return;
        }
        let (step, part) = (self.step, self.part);
        let at_switch = island.sources.iter().filter(|source| at_bounce(context, **source));
        let (kind, stage) = (Switch::Bouncing, island.stage);
        let one_sided = |source: &RowSource| OneSided { step, part, source: *source, kind, stage };
        self.one_sided.extend(at_switch.map(one_sided));
    }

    /// Adds a row at a switch.
    pub(crate) fn add_switch(&mut self, source: RowSource, kind: Switch) {
        let (step, part, stage) = (self.step, self.part, Stage::Velocity);
        self.one_sided.push(OneSided { step, part, source, kind, stage });
    }

    /// Adds a step that fell back to a fixed length.
    pub(crate) fn add_fall_back(&mut self) {
        self.fell_back.push(self.step);
    }

    /// Reverse mode meets the last step first; users read the first one first.
    pub(crate) fn end(&mut self) {
        self.one_sided.reverse();
        self.dependent_rows.reverse();
        self.gave_way.reverse();
        self.fell_back.reverse();
        self.undetermined_impulses.reverse();
        self.growth.reverse();
    }

    pub(crate) fn add_growth(&mut self, growth: f64) {
        self.growth.push(growth);
    }

    /// The greatest growth of the adjoint, and the state back to which it has so grown; `None` without a
    /// rollout.
    #[must_use]
    pub fn greatest_growth(&self) -> Option<(usize, f64)> {
        let growth = self.growth.iter().copied().enumerate();
        growth.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)))
    }
}

/// The questions are asked in the order of their cost.
fn at_bounce(context: &RowContext<'_>, source: RowSource) -> bool {
    let RowSource::Normal { contact } = source else { return false };
    let gap = context.contacts[contact as usize].gap;
    if gap <= 0.0 {
        return false;
    }
    let travel = context.dt * context.speed(&context.geometry(source));
    let [a, b] = context.contact_bodies(contact);
    (gap + travel).abs() <= WEAK_MARGIN * gap
        && gap > context.contact_slop(contact)
        && context.scene.pair_restitution(a, b).value != 0.0
}
