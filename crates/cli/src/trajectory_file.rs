//! Trajectories as text: CSV or JSON lines, one row per body and frame, numbers exact.

use std::fmt;
use std::fs::File;
use std::io::{self, BufRead as _, BufReader, BufWriter, Write as _};
use std::path::Path;

use clap::ValueEnum;
use serde::{Deserialize, Serialize};
use tangency::Scene;
use tangency_view::Run;

use crate::Failure;

/// How a trajectory is written down.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// Comma-separated values under a line of names
    Csv,
    /// One JSON object per line
    Jsonl,
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Csv => "csv",
            Self::Jsonl => "jsonl",
        })
    }
}

/// One body at one time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// Time, s.
    pub time: f64,
    /// The body's name.
    pub body: String,
    /// Centre of mass, m.
    pub x: f64,
    /// Centre of mass, m.
    pub y: f64,
    /// Angle, rad.
    pub angle: f64,
    /// Velocity, m/s.
    pub vx: f64,
    /// Velocity, m/s.
    pub vy: f64,
    /// Angular velocity, rad/s.
    pub omega: f64,
}

/// The rows of a run: frame by frame, the bodies in the scene's order.
pub fn rows<'a>(scene: &'a Scene, run: &'a Run) -> impl Iterator<Item = Row> + 'a {
    run.frames.iter().flat_map(|frame| {
        let state = &frame.state;
        scene.bodies().iter().zip(state.q.iter().zip(&state.v)).map(|(body, (q, v))| Row {
            time: state.time,
            body: body.name.clone(),
            x: q.x,
            y: q.y,
            angle: q.z,
            vx: v.x,
            vy: v.y,
            omega: v.z,
        })
    })
}

/// Writes a run.
///
/// # Errors
/// [`Failure::Write`].
pub fn write_trajectory(
    file: &Path,
    format: Format,
    scene: &Scene,
    run: &Run,
) -> Result<(), Failure> {
    let write = || match format {
        Format::Csv => write_csv(File::create(file)?, rows(scene, run)),
        Format::Jsonl => write_jsonl(File::create(file)?, rows(scene, run)),
    };
    write().map_err(|source| Failure::Write { file: file.to_owned(), source })
}

fn write_csv(file: File, rows: impl Iterator<Item = Row>) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(BufWriter::new(file));
    for row in rows {
        writer.serialize(row)?;
    }
    writer.flush()
}

fn write_jsonl(file: File, rows: impl Iterator<Item = Row>) -> io::Result<()> {
    let mut writer = BufWriter::new(file);
    for row in rows {
        serde_json::to_writer(&mut writer, &row)?;
        writer.write_all(b"\n")?;
    }
    writer.flush()
}

/// Reads the rows of a trajectory; `.jsonl` files hold JSON lines, all others CSV.
///
/// # Errors
/// [`Failure::Read`], or [`Failure::Input`] with the line that is wrong.
pub fn read_rows(file: &Path) -> Result<Vec<Row>, Failure> {
    let opened = File::open(file).map_err(|source| Failure::Read { file: file.to_owned(), source });
    let wrong = |line, message| Failure::Input { file: file.to_owned(), line, message };
    let reader = BufReader::new(opened?);
    if file.extension().is_some_and(|extension| extension == "jsonl") {
        (1..).zip(reader.lines()).map(|(line, text)| parse_json_line(text, line, wrong)).collect()
    } else {
        csv::Reader::from_reader(reader)
            .into_deserialize()
            .map(|row| row.map_err(|error| csv_failure(&error, wrong)))
            .collect()
    }
}

fn parse_json_line(
    text: io::Result<String>,
    line: u64,
    wrong: impl Fn(u64, String) -> Failure,
) -> Result<Row, Failure> {
    let text = text.map_err(|error| wrong(line, error.to_string()))?;
    serde_json::from_str(&text).map_err(|error| wrong(line, error.to_string()))
}

fn csv_failure(error: &csv::Error, wrong: impl Fn(u64, String) -> Failure) -> Failure {
    let line = error.position().map_or(1, csv::Position::line);
    let message = match error.kind() {
        csv::ErrorKind::Deserialize { err, .. } => {
            let field = err.field().and_then(|index| COLUMNS.get(usize::try_from(index).ok()?));
            format!("{}{}", field.map(|name| format!("{name}: ")).unwrap_or_default(), err.kind())
        }
        _ => error.to_string(),
    };
    wrong(line, format!("{message}; the columns are {}", COLUMNS.join(", ")))
}

/// Names of the columns of a trajectory, in order.
pub const COLUMNS: [&str; 8] = ["time", "body", "x", "y", "angle", "vx", "vy", "omega"];
