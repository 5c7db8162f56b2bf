//! The engine's errors as Python's exceptions.

use pyo3::create_exception;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::fmt::Display;
use tangency::diff::DiffError;

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
    "A step that could not be taken; `failures` lists (environment, message) where a batch could not."
);
create_exception!(
    tangency,
    GradientError,
    PyRuntimeError,
    "A derivative that could not be taken; `failures` lists (environment, message) where a batch could not."
);
create_exception!(
    tangency,
    PlanError,
    PyRuntimeError,
    "A plan that could not be made; `plan` is the best one so far, or None."
);

/// Gives the exceptions the attributes that only some of their instances fill.
pub(crate) fn complete(py: Python<'_>) -> PyResult<()> {
    py.get_type::<StepError>().setattr("failures", PyTuple::empty(py))?;
    py.get_type::<GradientError>().setattr("failures", PyTuple::empty(py))?;
    py.get_type::<PlanError>().setattr("plan", py.None())
}

/// Turns an error of the engine into a `ValueError`: the caller gave what does not fit.
pub(crate) fn value(error: impl Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// Turns an error into a `SceneError`.
pub(crate) fn scene(error: impl Display) -> PyErr {
    SceneError::new_err(error.to_string())
}

/// Turns the refusal of a named number into a `SceneError`.
pub(crate) fn number(name: &str, error: impl Display) -> PyErr {
    SceneError::new_err(format!("{name:?}: {error}"))
}

/// Turns an error into a `StepError`.
pub(crate) fn step(error: impl Display) -> PyErr {
    StepError::new_err(error.to_string())
}

/// Turns an error into a `GradientError`.
pub(crate) fn gradient(error: impl Display) -> PyErr {
    GradientError::new_err(error.to_string())
}

/// The derivatives of all environments, or a `GradientError` with its `failures`.
pub(crate) fn all<T>(py: Python<'_>, found: Vec<Result<T, DiffError>>) -> PyResult<Vec<T>> {
    let of = found.len();
    let (mut good, mut failures) = (Vec::with_capacity(of), Vec::new());
    for (k, one) in found.into_iter().enumerate() {
        match one {
            Ok(one) => good.push(one),
            Err(error) => failures.push((k, format!("environment {k}: {error}"))),
        }
    }
    let Some((_, first)) = failures.first() else { return Ok(good) };
    let failed = failures.len();
    let exception = gradient(format!("{failed} of {of} environments failed; the first: {first}"));
    Err(with(py, exception, "failures", failures))
}

/// An exception with an attribute.
pub(crate) fn with<'py>(
    py: Python<'py>,
    exception: PyErr,
    name: &str,
    value: impl IntoPyObject<'py>,
) -> PyErr {
    match exception.value(py).setattr(name, value) {
        Ok(()) => exception,
        Err(other) => other,
    }
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
    with(py, exception, "failures", list)
}
