//! The engine's errors as Python's exceptions.

use pyo3::create_exception;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use std::fmt::Display;

create_exception!(
    tangency,
    SceneError,
    PyValueError,
    "A scene, or a number of it, that cannot be: the message names field, value and remedy."
);
create_exception!(
    tangency,
    SolveError,
    PyRuntimeError,
    "A complementarity problem without a solution, or one that no attempt found."
);
create_exception!(
    tangency,
    StepError,
    PyRuntimeError,
    "A step that could not be taken; for batches `failures` lists (environment, message)."
);
create_exception!(tangency, GradientError, PyRuntimeError, "A derivative that could not be taken.");
create_exception!(
    tangency,
    PlanError,
    PyRuntimeError,
    "A plan that could not be made; `plan` is the best one so far, if there is one."
);

/// Turns an error of the engine into a `ValueError`: the caller gave what does not fit.
pub(crate) fn value(error: impl Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// Turns an error into a `SceneError`.
pub(crate) fn scene(error: impl Display) -> PyErr {
    SceneError::new_err(error.to_string())
}

/// Turns an error into a `StepError`.
pub(crate) fn step(error: impl Display) -> PyErr {
    StepError::new_err(error.to_string())
}

/// Turns an error into a `GradientError`.
pub(crate) fn gradient(error: impl Display) -> PyErr {
    GradientError::new_err(error.to_string())
}

/// Turns an error of a batch into a `StepError` with its `failures`, or a `ValueError` where the input does
/// not fit.
pub(crate) fn batch(py: Python<'_>, error: &tangency::batch::BatchError) -> PyErr {
    use tangency::batch::BatchError::Failed;
    let Failed { failures, .. } = error else { return value(error) };
    let list: Vec<(usize, String)> =
        failures.iter().map(|failure| (failure.environment(), failure.to_string())).collect();
    let derivative = matches!(failures[0], tangency::batch::Failure::Gradient { .. });
    let exception = if derivative { gradient(error) } else { step(error) };
    match exception.value(py).setattr("failures", list) {
        Ok(()) => exception,
        Err(other) => other,
    }
}
