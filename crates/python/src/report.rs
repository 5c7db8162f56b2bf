//! What the user of a gradient should know about it.

use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use tangency::diff::Switch;
use tangency::{Rollout, Scene, Stage};

use crate::impulse::names;

/// (step, what pushes, row, between which pieces).
type OneSided = (usize, String, String, &'static str);

/// What the user of a gradient should know about it.
#[pyclass(frozen, module = "tangency")]
pub(crate) struct GradientReport {
    /// Rows between two pieces of their law, as (step, what pushes, row, between which pieces).
    ///
    /// The pieces are "touching" (open and closed), "slipping" (sticking and sliding), "saturating" (below and
    /// at a motor's maximum), "bouncing" (reaching the other body in the step, or just not), "together" (several
    /// gaps that close at once) and "grazing" (closing so slowly that the time of the impact is ill-conditioned).
    #[pyo3(get)]
    one_sided: Vec<OneSided>,
    /// Steps with dependent active rows: velocities and their derivatives are unique, impulses are not.
    #[pyo3(get)]
    dependent_rows: Vec<usize>,
    /// Islands in which restitution or position corrections gave way, as (step, how much).
    #[pyo3(get)]
    gave_way: Vec<(usize, &'static str)>,
    /// Steps with more impacts than the scene divides a step for: their rest was one of fixed length.
    #[pyo3(get)]
    fell_back: Vec<usize>,
    /// Steps at which the loss sees impulses that dependent rows share by convention only.
    #[pyo3(get)]
    undetermined_impulses: Vec<usize>,
    growth: Vec<f64>,
    greatest_growth: Option<(usize, f64)>,
}

impl GradientReport {
    /// With names for the rows of the run.
    pub(crate) fn new(scene: &Scene, run: &Rollout, report: &tangency::GradientReport) -> Self {
        let one_sided = |it: &tangency::diff::OneSided| {
            let record = &run.records[it.step];
            let record = it.part.map_or(record, |part| &record.parts[part]);
            let (source, row) = names(scene, record, it.source);
            (it.step, source, row, switch(it.kind))
        };
        Self {
            one_sided: report.one_sided.iter().map(one_sided).collect(),
            dependent_rows: report.dependent_rows.clone(),
            gave_way: report.gave_way.iter().map(|it| (it.step, stage(it.stage))).collect(),
            fell_back: report.fell_back.clone(),
            undetermined_impulses: report.undetermined_impulses.clone(),
            growth: report.growth.clone(),
            greatest_growth: report.greatest_growth(),
        }
    }
}

#[pymethods]
impl GradientReport {
    /// How much the adjoint has grown back to each state, without unit, shape (steps + 1,); nothing is clipped.
    #[getter]
    fn growth<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.growth.clone().into_pyarray(py)
    }

    /// The state with the greatest growth, and that growth; None for an empty gradient.
    #[getter]
    fn greatest_growth(&self) -> Option<(usize, f64)> {
        self.greatest_growth
    }

    /// Whether the loss is differentiable where the gradient was taken, and all its numbers are unique.
    #[getter]
    fn is_smooth(&self) -> bool {
        self.one_sided.is_empty()
            && self.fell_back.is_empty()
            && self.undetermined_impulses.is_empty()
    }

    fn __repr__(&self) -> String {
        let growth = self.greatest_growth.map_or(1.0, |(_, growth)| growth);
        format!(
            "<tangency.GradientReport: {} one-sided rows, {} steps with dependent rows, {} islands gave way, \
             {} steps fell back, greatest growth {growth:.3e}>",
            self.one_sided.len(),
            self.dependent_rows.len(),
            self.gave_way.len(),
            self.fell_back.len()
        )
    }
}

fn switch(kind: Switch) -> &'static str {
    match kind {
        Switch::Touching => "touching",
        Switch::Slipping => "slipping",
        Switch::Saturating => "saturating",
        Switch::Bouncing => "bouncing",
        Switch::Together => "together",
        Switch::Grazing => "grazing",
    }
}

fn stage(stage: Stage) -> &'static str {
    match stage {
        Stage::Velocity => "velocity",
        Stage::Post => "post",
        Stage::Plastic => "plastic",
        Stage::Loose => "loose",
        Stage::SoftPost => "soft post",
    }
}
