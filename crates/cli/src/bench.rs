//! `tangency bench`: time against error, of every backend and of other engines on the same scenes.
//!
//! Every number comes from one run on one machine and one pinned thread, in which the candidates take
//! turns; what is compared is in the `plan`, and what came out in the `outcome`. Tables (CSV), figures
//! and a page are written from that.

mod digits;
mod engines;
mod export;
mod figures;
mod goals;
mod gradient_rows;
mod markdown;
mod outcome;
mod page;
mod plan;
mod provenance;
mod row;
mod tables;
mod weigh;

use std::fs;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use self::outcome::Outcome;
use self::plan::Plan;
use self::provenance::Provenance;
use self::weigh::Weight;
use crate::{Console, Failure};

/// The options of `bench`.
#[derive(Args, Debug)]
pub struct Arguments {
    /// Fewer scenes, sizes and rounds; a minute at most
    #[arg(long)]
    pub quick: bool,
    /// Only these parts [default: all]
    #[arg(long, value_enum, value_delimiter = ',')]
    pub only: Vec<Part>,
    /// Results of further engines, in the columns of race.csv; see crates/bench/peers
    #[arg(long, value_name = "FILE.csv")]
    pub peers: Vec<PathBuf>,
    /// Folder of scene files whose problems are recorded for the solvers
    #[arg(long, default_value = "scenes")]
    pub scenes: PathBuf,
    /// Write the scenes of the race as JSON for other engines to this file, and end
    #[arg(long, value_name = "FILE.json")]
    pub export: Option<PathBuf>,
    /// Print the memory that something takes, and end: for processes that this one starts
    #[arg(long, hide = true, requires = "of")]
    weigh: Option<Weight>,
    /// The scene that is weighed
    #[arg(long, hide = true)]
    of: Option<String>,
    /// Folder for tables, figures and the page
    #[arg(long, default_value = "out/bench")]
    pub out: PathBuf,
}

/// The parts of the report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Part {
    /// Engines on the same scenes
    Race,
    /// Time against error over the time step
    Precision,
    /// Time per step over the size of the scene
    Growth,
    /// Solvers alone on recorded problems
    Solvers,
    /// Counts and ratios that must hold
    Lean,
    /// What gradients are by, how exact they are, and memory of tapes
    Gradients,
    /// Environments side by side, on one thread and on all
    Batch,
}

/// Runs the subcommand.
///
/// # Errors
/// A file that cannot be read or written, a scene or a step of ours that is refused.
pub fn run(arguments: &Arguments, console: &Console) -> Result<(), Failure> {
    if let Some(file) = &arguments.export {
        return export::write(file);
    }
    if let (Some(weight), Some(scene)) = (arguments.weigh, &arguments.of) {
        return weigh::run(weight, scene, console);
    }
    let guests = row::read_all(&arguments.peers)?;
    let provenance = Provenance::of_this_run();
    let plan = Plan::new(arguments);
    let mut outcome = Outcome::measure(&plan, &provenance.cores, console)?;
    outcome.add_guests(guests);

    let folder = &arguments.out;
    fs::create_dir_all(folder).map_err(|source| Failure::Write { file: folder.clone(), source })?;
    tables::save_all(&outcome, folder)?;
    let figures = figures::save_all(&outcome, folder)?;
    write(&folder.join("tables.md"), &markdown::markdown(&outcome, &provenance))?;
    let page = folder.join("bench.html");
    write(&page, &page::page(&outcome, &figures, &provenance, &plan))?;
    let (race, goals) = (tables::summary(&outcome), tables::judged(&outcome));
    console.say(format_args!("{race}\n\n{goals}\n\nthe report: {}", page.display()));
    Ok(())
}

fn write(file: &Path, text: &str) -> Result<(), Failure> {
    fs::write(file, text).map_err(|source| Failure::Write { file: file.to_owned(), source })
}
