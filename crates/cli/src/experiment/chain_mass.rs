//! The mass of a chain from its motion: the paper's section 4.1, and what it leaves open.
//!
//! A chain of n links hangs from a hook and is hit by a ball; its poses are observed for 10 s. The
//! total mass of the links (7, shared equally) is unknown and starts at 1. The loss is the mean
//! squared error of all poses (x, y and angle of links and ball, the initial ones included) at
//! equal times; its gradient is clipped to ±100 and followed at a rate of 0.01.
//!
//! 100 · 0.01 makes steps of exactly 1, so that from 1 the paper's recipe stands on 7 by
//! arithmetic. Hence the rest: other starts, better optimisers, noise, a mass for every link.

mod figures;
mod results;
mod setup;
mod study;

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use tangency_view::{Run, replay_html};

use self::results::Results;
use self::setup::Setup;
use crate::simulate::find_solver;
use crate::{Console, Failure};

/// The options of `experiment chain-mass`.
#[derive(Args, Debug)]
pub struct Arguments {
    /// Links of the chain
    #[arg(long, default_value = "10", value_parser = clap::value_parser!(u16).range(1..=200))]
    pub links: u16,
    /// Fewer seeds, sizes and repetitions
    #[arg(long)]
    pub quick: bool,
    /// Folder for figures and tables
    #[arg(long, default_value = "out/chain-mass")]
    pub out: PathBuf,
    /// Of the noise; repetitions take the following ones
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Solver of the complementarity problems
    #[arg(long, default_value = "ipm")]
    pub backend: String,
}

/// Runs the experiment and writes everything.
///
/// # Errors
/// A step that failed, or a file that cannot be written.
pub(super) fn run(arguments: &Arguments, console: &Console) -> Result<(), Failure> {
    let solver = find_solver(&arguments.backend)?;
    let setup = Setup::new(usize::from(arguments.links), solver.as_ref())?;
    let results = study::study(&setup, arguments, console)?;

    let folder = &arguments.out;
    fs::create_dir_all(folder).map_err(|source| Failure::Write { file: folder.clone(), source })?;
    figures::save_all(&setup, &results, folder)?;
    results.table().write_csv(&folder.join("results.csv"))?;
    write(&folder.join("results.json"), &results.json())?;
    write(&folder.join("report.md"), &results.report())?;
    write(&folder.join("replay.html"), &replay(&setup, &results)?)?;
    console.say(format_args!("{}\n\nwritten to {}", results.table(), folder.display()));
    Ok(())
}

/// The true motion, the learned one over it, and the one that learning began with.
fn replay(setup: &Setup<'_>, results: &Results) -> Result<String, Failure> {
    let objective = setup.objective();
    let mut runs = Vec::new();
    let masses = [
        ("true", setup::TRUE_MASS),
        ("learned", results.plain_mass()),
        ("at the start", setup::START),
    ];
    for (name, mass) in masses {
        let (scene, rollout) = objective.rollout(&[mass])?;
        runs.push(Run::from_rollout(name, &scene, &rollout));
    }
    Ok(replay_html("The mass of a chain", &setup.truth, &runs))
}

fn write(file: &Path, text: &str) -> Result<(), Failure> {
    fs::write(file, text).map_err(|source| Failure::Write { file: file.to_owned(), source })
}
