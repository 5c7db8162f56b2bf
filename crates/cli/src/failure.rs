//! Why a command did not do what it was asked.

use std::io;
use std::path::PathBuf;
use std::process::ExitCode;

use tangency::{SceneError, SceneFileError, StepError};

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
    /// A solver that this build does not have.
    #[error("unknown backend `{name}`; this build has: {known}")]
    UnknownBackend {
        /// The name given.
        name: String,
        /// The names there are.
        known: String,
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
    /// A state has no answer.
    #[error(transparent)]
    State(#[from] StepError),
}

impl Failure {
    /// 2 if the fault is in what the user gave, 1 otherwise.
    #[must_use]
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::SceneFile(_)
            | Self::Scene(_)
            | Self::UnknownBackend { .. }
            | Self::Input { .. }
            | Self::Read { .. } => ExitCode::from(2),
            Self::Write { .. } | Self::Step { .. } | Self::State(_) => ExitCode::FAILURE,
        }
    }
}
