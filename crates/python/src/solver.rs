//! Backends by name.

use std::sync::Arc;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use tangency::LcpSolver;

/// Names of the backends, the first of which is used unless told otherwise.
///
/// Returns
/// -------
/// list of str
#[pyfunction]
pub(crate) fn backends() -> Vec<&'static str> {
    tangency::BACKENDS.to_vec()
}

/// A backend and how exactly it solves; what a pickle keeps of it.
#[derive(Clone)]
pub(crate) struct Solver {
    pub(crate) name: String,
    pub(crate) tolerance: Option<f64>,
    pub(crate) backend: Arc<dyn LcpSolver>,
}

impl Solver {
    /// By name, at its own tolerance or another one.
    pub(crate) fn new(name: &str, tolerance: Option<f64>) -> PyResult<Self> {
        let unknown = || {
            let known = tangency::BACKENDS.join(", ");
            PyValueError::new_err(format!("backend is {name:?}; give one of {known}"))
        };
        let backend = match tolerance {
            None => tangency::backend(name).ok_or_else(unknown)?,
            Some(tolerance) => at_tolerance(name, tolerance)?.ok_or_else(unknown)?,
        };
        Ok(Self { name: name.to_owned(), tolerance, backend: backend.into() })
    }
}

fn at_tolerance(name: &str, tolerance: f64) -> PyResult<Option<Box<dyn LcpSolver>>> {
    if !(tolerance > 0.0 && tolerance < 1.0) {
        let message = format!("tolerance is {tolerance}; give a number in (0, 1)");
        return Err(PyValueError::new_err(message));
    }
    if tangency::BACKENDS.contains(&name) && !["ipm", "clarabel"].contains(&name) {
        let message =
            format!("backend {name:?} pivots and has no tolerance; leave `tolerance` out");
        return Err(PyValueError::new_err(message));
    }
    let all = tangency::BACKENDS.iter().zip(tangency::solvers_at(tolerance));
    Ok(all.into_iter().find(|(known, _)| **known == name).map(|(_, solver)| solver))
}
