//! A row of race.csv: one engine at one scene. Other engines' rows are read from files.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use tangency_bench::race::{Entry, Gradient};

use crate::Failure;

/// One engine at one scene. Empty where a number does not exist.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Row {
    /// The engine with its settings in short.
    pub(super) engine: String,
    pub(super) scene: String,
    /// Time step, s.
    pub(super) dt: f64,
    /// Steps per run.
    pub(super) steps: Option<usize>,
    /// Median time per step, µs, and the quartiles about it, and the least.
    pub(super) us_per_step: Option<f64>,
    pub(super) us_lower: Option<f64>,
    pub(super) us_upper: Option<f64>,
    pub(super) us_least: Option<f64>,
    /// Deepest penetration, m.
    pub(super) penetration: Option<f64>,
    /// Largest joint error, m or rad.
    pub(super) drift: Option<f64>,
    /// Worst residual of all steps.
    pub(super) residual: Option<f64>,
    /// Per step.
    pub(super) factorisations: Option<f64>,
    /// Per step.
    pub(super) iterations: Option<f64>,
    /// Value and gradient over value.
    pub(super) gradient: Option<f64>,
    /// Least time of value and gradient of 200 steps, µs.
    #[serde(default)]
    pub(super) gradient_us: Option<f64>,
    /// What a reader must know.
    pub(super) note: String,
}

impl From<&Entry> for Row {
    fn from(entry: &Entry) -> Self {
        let (engine, scene, dt) = (entry.engine.clone(), entry.heat.clone(), entry.dt);
        let blank = Self { engine, scene, dt, ..Self::default() };
        let done = match &entry.result {
            Ok(done) => done,
            Err(refusal) => return Self { note: refusal.to_string(), ..blank },
        };
        let (gradient, note) = match done.gradient {
            Gradient::Known(cost) => (Some(cost), ""),
            Gradient::None => (None, "no gradient"),
            Gradient::Refused => (None, "gradient refused"),
            Gradient::NotAsked => (None, ""),
        };
        let us = done.step.scaled(1e6);
        let per_step = |count: fn(&tangency_bench::paths::Paths) -> usize| {
            done.paths.map(|paths| paths.per_step(count(&paths)))
        };
        Self {
            steps: Some(done.steps),
            us_per_step: Some(us.median),
            us_lower: Some(us.lower),
            us_upper: Some(us.upper),
            us_least: Some(us.least),
            penetration: Some(done.penetration),
            drift: Some(done.drift),
            residual: done.paths.map(|paths| paths.residual),
            factorisations: per_step(|paths| paths.factorisations),
            iterations: per_step(|paths| paths.iterations),
            gradient: gradient.map(|cost| cost.multiple()),
            gradient_us: gradient.map(|cost| 1e6 * cost.both.least),
            note: note.into(),
            ..blank
        }
    }
}

/// Writes rows with their heading.
pub(super) fn write_all(rows: &[Row], file: &Path) -> Result<(), Failure> {
    let write = || {
        let mut writer = csv::Writer::from_path(file)?;
        rows.iter().try_for_each(|row| writer.serialize(row))?;
        writer.flush().map_err(csv::Error::from)
    };
    write().map_err(|error| Failure::Write { file: file.to_owned(), source: error.into() })
}

/// The rows of some files.
pub(super) fn read_all(files: &[PathBuf]) -> Result<Vec<Row>, Failure> {
    let mut rows = Vec::new();
    for file in files {
        rows.extend(read(file)?);
    }
    Ok(rows)
}

/// Not from the process of the other rows.
fn separate(row: Row) -> Row {
    let note = match row.note.as_str() {
        "" | "no gradient" => "separate process".to_owned(),
        note => format!("separate process; {note}"),
    };
    Row { note, ..row }
}

fn read(file: &Path) -> Result<Vec<Row>, Failure> {
    let mut reader = csv::Reader::from_path(file)
        .map_err(|error| Failure::Read { file: file.to_owned(), source: error.into() })?;
    let row = |(index, row): (usize, Result<Row, csv::Error>)| {
        row.map(separate).map_err(|error| Failure::Input {
            file: file.to_owned(),
            line: index as u64 + 2,
            message: format!("{error}; the columns are those of race.csv"),
        })
    };
    reader.deserialize().enumerate().map(row).collect()
}
