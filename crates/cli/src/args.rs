//! The command line as clap reads it, and which file runs which subcommand.

use clap::{Parser, Subcommand};
use tangency::GradientMode;

use crate::{Console, Failure, bench, experiment, fit, gradient, inspect, lcp, simulate, validate};

/// Differentiable planar physics from the shell.
#[derive(Debug, Parser)]
#[command(
    name = "tangency",
    version,
    about,
    after_help = "Exit codes: 0 done, 1 failed, 2 wrong usage or bad input."
)]
pub struct Arguments {
    /// Print nothing but errors
    #[arg(short, long, global = true)]
    pub quiet: bool,
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The subcommands, each in the file of its name.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a scene; write its trajectory and a replay page; print a summary
    Simulate(simulate::Arguments),
    /// Check a scene file and show what one step from a state models
    Inspect(inspect::Arguments),
    /// The value of a loss over a run, and its gradient by parameters of the scene
    Gradient(gradient::Arguments),
    /// Learn parameters of a scene from an observed motion
    Fit(fit::Arguments),
    /// Solve a linear complementarity or planar friction problem from a file
    Lcp(lcp::Arguments),
    /// Measure physics with known answers; write the table of all figures
    Validate(validate::Arguments),
    /// Time against error, beside other engines; write tables, figures and a page
    Bench(bench::Arguments),
    /// The paper's experiments and ours, with figures and tables under out/
    #[command(subcommand)]
    Experiment(experiment::Experiment),
}

impl Command {
    /// Runs the subcommand.
    ///
    /// # Errors
    /// A [`Failure`] that knows its exit code.
    pub fn run(&self, console: &Console) -> Result<(), Failure> {
        match self {
            Self::Simulate(arguments) => simulate::run(arguments, console),
            Self::Inspect(arguments) => inspect::run(arguments, console),
            Self::Gradient(arguments) => gradient::run(arguments, console),
            Self::Fit(arguments) => fit::run(arguments, console),
            Self::Lcp(arguments) => lcp::run(arguments, console),
            Self::Validate(arguments) => validate::run(arguments, console),
            Self::Bench(arguments) => bench::run(arguments, console),
            Self::Experiment(experiment) => experiment.run(console),
        }
    }
}

/// Parses a positive, finite number.
///
/// # Errors
/// What is wrong with it and what to give.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number > 0.0 && number.is_finite() => Ok(number),
        Ok(_) => Err("give a positive, finite number of seconds".into()),
        Err(_) => Err("give a number of seconds, such as 0.01".into()),
    }
}

/// Parses κ, how widely derivatives are smoothed.
///
/// # Errors
/// What is wrong with it and what to give.
pub fn smoothing(text: &str) -> Result<f64, String> {
    let kappa = text.parse::<f64>().ok().filter(|kappa| *kappa > 0.0 && kappa.is_finite());
    kappa.ok_or_else(|| "give a positive, finite number, such as 1e-4".into())
}

/// The mode of derivatives that `--smoothed` asks for.
#[must_use]
pub fn gradient_mode(smoothed: Option<f64>) -> GradientMode {
    smoothed.map_or(GradientMode::Exact, |kappa| GradientMode::Smoothed { kappa })
}

/// Parses a number that is not negative, and finite.
///
/// # Errors
/// What is wrong with it and what to give.
pub fn not_negative(text: &str) -> Result<f64, String> {
    if text.parse::<f64>() == Ok(0.0) { Ok(0.0) } else { positive(text) }
}
