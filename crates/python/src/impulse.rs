//! Impulses of single rows.

use pyo3::prelude::*;
use tangency::{RowImpulse, RowSource, Scene, StepRecord};

/// The impulse of one row of one step; `Rollout.impulses` and `Simulator.impulses` list them.
#[pyclass(frozen, module = "tangency")]
#[derive(Clone)]
pub(crate) struct Impulse {
    pub(crate) row: RowImpulse,
    /// Index of the step.
    #[pyo3(get)]
    pub(crate) step: usize,
    /// What pushes, as ``contact ball/floor`` or ``joint hinge``.
    #[pyo3(get)]
    source: String,
    /// Which of its rows: ``normal``, ``tangent``, ``held 0``, ``lower``, ``upper`` or ``motor``.
    #[pyo3(get)]
    kind: String,
}

#[pymethods]
impl Impulse {
    /// The impulse, N·s or N·m·s.
    #[getter]
    fn value(&self) -> f64 {
        self.row.value
    }

    /// Which part of a divided step; None for what was left of it, and where nothing divides it.
    #[getter]
    fn part(&self) -> Option<usize> {
        self.row.part
    }

    fn __repr__(&self) -> String {
        let Self { step, source, kind, row } = self;
        format!("<tangency.Impulse step {step}, {source}, {kind}: {}>", row.value)
    }
}

/// All impulses of a step, those of its parts first.
pub(crate) fn of_step(scene: &Scene, step: usize, record: &StepRecord) -> Vec<Impulse> {
    let parts = record.parts.iter().enumerate().map(|(part, it)| (Some(part), it));
    let all = parts.chain([(None, record)]);
    all.flat_map(|(part, it)| of_part(scene, step, part, it)).collect()
}

fn of_part(scene: &Scene, step: usize, part: Option<usize>, record: &StepRecord) -> Vec<Impulse> {
    let problems = record.problems().iter();
    let sources = problems.flat_map(|island| &island.sources);
    let impulse = |source: &RowSource| {
        let value = record.impulse(*source)?;
        let (name, kind) = names(scene, record, *source);
        let row = RowImpulse { part, source: *source, value };
        Some(Impulse { row, step, source: name, kind })
    };
    sources.filter_map(impulse).collect()
}

/// What pushes, and in which of its rows.
pub(crate) fn names(scene: &Scene, record: &StepRecord, source: RowSource) -> (String, String) {
    let joint = |joint: u32| format!("joint {}", scene.joints()[joint as usize].name);
    let contact = |contact: u32| {
        let [a, b] = record.contacts[contact as usize].feature.id.bodies;
        let name = |body: u32| &scene.bodies()[body as usize].name;
        format!("contact {}/{}", name(a), name(b))
    };
    match source {
        RowSource::Held { joint: j, row } => (joint(j), format!("held {row}")),
        RowSource::Lower { joint: j } => (joint(j), "lower".into()),
        RowSource::Upper { joint: j } => (joint(j), "upper".into()),
        RowSource::Motor { joint: j } => (joint(j), "motor".into()),
        RowSource::Normal { contact: c } => (contact(c), "normal".into()),
        RowSource::Tangent { contact: c } => (contact(c), "tangent".into()),
    }
}
