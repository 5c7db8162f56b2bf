//! Why a command did not do what it was asked.

use std::io;
use std::path::PathBuf;
use std::process::ExitCode;

use tangency::diff::{DiffError, ParameterError};
use tangency::{SceneError, SceneFileError, StepError};
use tangency_bench::engine::Refusal;

use crate::formula::FormulaError;
use crate::lcp::LcpFileError;
use crate::simulate::MOST_STEPS;

/// Why a command did not do what it was asked.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Failure {
    /// The scene file is wrong.
    #[error(transparent)]
    SceneFile(#[from] SceneFileError),
    /// A scene changed by options is wrong.
    #[error("with these options the scene cannot be built: {0}")]
    Scene(#[from] SceneError),
    /// The file of a complementarity problem is wrong.
    #[error(transparent)]
    LcpFile(#[from] LcpFileError),
    /// No backend solved a problem.
    #[error("{}: no backend of this build solved it", file.display())]
    Unsolved {
        /// The problem's file.
        file: PathBuf,
    },
    /// A solver that this build does not have.
    #[error("unknown backend `{name}`; this build has: {known}")]
    UnknownBackend {
        /// The name given.
        name: String,
        /// The names there are.
        known: String,
    },
    /// A validation case that does not exist.
    #[error("unknown case `{name}`; there are: {known}")]
    UnknownCase {
        /// The name given.
        name: String,
        /// The names there are.
        known: String,
    },
    /// A part of the benchmark that our own engine could not run.
    #[error("the part `{part}` of the benchmark was refused")]
    Bench {
        /// The part.
        part: &'static str,
        /// Why.
        source: Refusal,
    },
    /// Threads that the system does not give.
    #[error("no pool of threads")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// Figures outside their tolerances.
    #[error("{failed} figures are outside their tolerance; the table names them")]
    Invalid {
        /// How many.
        failed: usize,
    },
    /// A file of observations or the like is wrong.
    #[error("{}:{line}: {message}", file.display())]
    Input {
        /// The file.
        file: PathBuf,
        /// Line, from 1.
        line: u64,
        /// What is wrong and what to do.
        message: String,
    },
    /// A file cannot be read.
    #[error("{}: cannot be read", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A file cannot be written.
    #[error("{}: cannot be written", file.display())]
    Write {
        /// The file.
        file: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A step could not be taken.
    #[error("step {step} failed; a smaller --dt may help")]
    Step {
        /// The step, from 1.
        step: usize,
        /// Why.
        source: StepError,
    },
    /// A run that nobody could wait for.
    #[error(
        "{steps:e} steps of {dt} s are more than {MOST_STEPS}; give a shorter time or a longer --dt"
    )]
    TooManySteps {
        /// The steps asked for.
        steps: f64,
        /// The time step, s.
        dt: f64,
    },
    /// A state has no answer.
    #[error(transparent)]
    State(#[from] StepError),
    /// A parameter that the scene does not have.
    #[error("parameter {0}")]
    Parameter(#[from] ParameterError),
    /// A parameter's value that the scene refuses.
    #[error("parameter {name:?} cannot have this value")]
    Value {
        /// The parameter.
        name: String,
        /// What is wrong with the value.
        source: SceneError,
    },
    /// A formula is wrong.
    #[error("--loss {:?} is no file, and as a formula wrong at {source}", excerpt(text))]
    Loss {
        /// The formula.
        text: String,
        /// What is wrong with it.
        source: FormulaError,
    },
    /// A search cannot begin on or outside of a parameter's bounds.
    #[error("parameter {name:?} begins at {value}; give a start between {lower} and {upper}")]
    Start {
        /// The parameter.
        name: String,
        /// Its first value.
        value: f64,
        /// Lower bound.
        lower: f64,
        /// Upper bound.
        upper: f64,
    },
    /// As many starts as parameters are needed.
    #[error("--start has {found} numbers, --learn {expected} parameters; give one for each")]
    StartCount {
        /// Parameters.
        expected: usize,
        /// Numbers given.
        found: usize,
    },
    /// Parameters that set the same number.
    #[error("--learn {:?} and {:?} set the same number; learn one of them", names[0], names[1])]
    Overlap {
        /// The parameters.
        names: [String; 2],
    },
    /// A derivative could not be taken.
    #[error(transparent)]
    Derivative(#[from] DiffError),
    /// A gradient and its finite difference disagree.
    #[error(
        "{name}: gradient and difference disagree by {relative_error:.1e}, more than \
         {tolerance:.1e}; either a contact changes between the points of the difference, or the \
         gradient is wrong"
    )]
    Check {
        /// The parameter.
        name: String,
        /// The disagreement.
        relative_error: f64,
        /// What was allowed.
        tolerance: f64,
    },
    /// A figure could not be drawn.
    #[error("{}: cannot be drawn: {message}", file.display())]
    Draw {
        /// The file.
        file: PathBuf,
        /// What the drawing library says.
        message: String,
    },
}

/// The start of a text that may be very long.
fn excerpt(text: &str) -> String {
    const SHOWN: usize = 200;
    let start: String = text.chars().take(SHOWN).collect();
    if start.len() < text.len() { start + " …" } else { start }
}

impl Failure {
    /// 2 if the fault is in what the user gave, 1 otherwise.
    #[must_use]
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::SceneFile(_)
            | Self::Scene(_)
            | Self::LcpFile(_)
            | Self::UnknownBackend { .. }
            | Self::UnknownCase { .. }
            | Self::Input { .. }
            | Self::Read { .. }
            | Self::Parameter(_)
            | Self::Value { .. }
            | Self::TooManySteps { .. }
            | Self::Loss { .. }
            | Self::Start { .. }
            | Self::StartCount { .. }
            | Self::Overlap { .. } => ExitCode::from(2),
            Self::Write { .. }
            | Self::Step { .. }
            | Self::Bench { .. }
            | Self::Threads(_)
            | Self::Invalid { .. }
            | Self::Unsolved { .. }
            | Self::State(_)
            | Self::Derivative(_)
            | Self::Check { .. }
            | Self::Draw { .. } => ExitCode::FAILURE,
        }
    }
}
