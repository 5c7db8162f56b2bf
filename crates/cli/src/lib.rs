//! The `tangency` command: simulates, inspects, differentiates and fits planar scenes.
//!
//! [`main`] parses the arguments and hands them to one file per subcommand. Those share four
//! nouns: a [`Run`](tangency_view::Run) is what was simulated, its [trajectory file](trajectory_file) and its
//! [replay page](tangency_view::replay_html) are how it leaves the program, and a [`Failure`] is why it did not.
//!
//! What learns from motion ([`gradient`], [`fit`], [`experiment`]) shares four more: a [`Loss`] over a
//! rollout, [observations] that one is made of, the [objective] that a loss is as a
//! function of parameters, and the [minimisers](optimise) of that.
//!
//! [`Loss`]: loss::Loss
//!
//! A new subcommand is a file with a `clap::Args` struct and its `run`, a variant of
//! [`args::Command`] and a line in [`args::Command::run`].

pub mod args;
pub mod bench;
pub mod experiment;
pub mod fit;
pub mod gradient;
pub mod inspect;
pub mod lcp;
pub mod simulate;
pub mod validate;

mod console;
mod failure;
mod formula;
mod grid;
pub mod growth;
pub mod impulse;
pub mod loss;
pub mod objective;
pub mod observations;
pub mod optimise;
pub mod plot;
mod summary;
mod table;
pub mod tape;
pub mod trajectory_file;

use std::process::ExitCode;

use clap::Parser as _;

pub use console::Console;
pub use failure::Failure;
pub use formula::{Formula, FormulaError};
pub use grid::Grid;
pub use summary::Summary;
pub use table::Table;

/// Runs the command line of this process. Exit codes: 0 done, 1 failed, 2 wrong usage or input.
#[must_use]
pub fn main() -> ExitCode {
    let arguments = args::Arguments::parse();
    let console = Console { quiet: arguments.quiet };
    match arguments.command.run(&console) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            console.report(&failure);
            failure.exit_code()
        }
    }
}
