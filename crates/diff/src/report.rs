//! What was not smooth along a gradient.

use tangency_core::{IslandRecord, RowSource};

use crate::lcp::{LcpGradientReport, WeakKind};

/// A row that was exactly between two modes, so that its derivative is one-sided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneSided {
    /// The step.
    pub step: usize,
    /// The row.
    pub source: RowSource,
    /// Between which modes.
    pub kind: WeakKind,
}

/// What a gradient's user should know about it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GradientReport {
    /// Rows at a switch, by step.
    pub one_sided: Vec<OneSided>,
    /// Steps with dependent active rows: velocities and their derivatives are unique, impulses are
    /// not.
    pub dependent_rows: Vec<usize>,
    step: usize,
}

impl GradientReport {
    pub(crate) fn begin(&mut self, step: usize) {
        self.step = step;
    }

    pub(crate) fn add(&mut self, island: &IslandRecord, report: &LcpGradientReport) {
        let step = self.step;
        if report.rank_defect > 0 && self.dependent_rows.last() != Some(&step) {
            self.dependent_rows.push(step);
        }
        let row = |weak: &crate::lcp::WeakRow| OneSided {
            step,
            source: island.sources[weak.row as usize],
            kind: weak.kind,
        };
        self.one_sided.extend(report.weak.iter().map(row));
    }

    /// Reverse mode meets the last step first; users read the first one first.
    pub(crate) fn end(&mut self) {
        self.one_sided.reverse();
        self.dependent_rows.reverse();
    }
}
