//! `tangency experiment`: the paper's experiments and ours.

mod chain_mass;
mod filmstrip;

use clap::Subcommand;

use crate::{Console, Failure};

/// The experiments, each in the file of its name.
#[derive(Debug, Subcommand)]
pub enum Experiment {
    /// Infer the mass of a chain from its motion after a ball hits it (the paper's section 4.1)
    ChainMass(chain_mass::Arguments),
}

impl Experiment {
    /// Runs the experiment.
    ///
    /// # Errors
    /// A [`Failure`] that knows its exit code.
    pub fn run(&self, console: &Console) -> Result<(), Failure> {
        match self {
            Self::ChainMass(arguments) => chain_mass::run(arguments, console),
        }
    }
}
