//! All derivatives of one step.

use numpy::PyArray2;
use pyo3::prelude::*;

use crate::arrays::matrix;

/// All derivatives of one step, x = (q, v) the coordinates of the dynamic bodies as in `Scene.coordinates`.
#[pyclass(frozen, module = "tangency")]
pub(crate) struct StepJacobian {
    pub(crate) found: tangency::diff::StepJacobian,
    /// Names of the columns of `parameters`.
    #[pyo3(get)]
    pub(crate) wrt: Vec<String>,
}

#[pymethods]
impl StepJacobian {
    /// A = ∂x⁺/∂x, shape (states, states).
    #[getter]
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        matrix(py, &self.found.state)
    }

    /// B = ∂x⁺/∂u, shape (states, channels).
    #[getter]
    fn control<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        matrix(py, &self.found.control)
    }

    /// P = ∂x⁺/∂p, shape (states, len(wrt)).
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        matrix(py, &self.found.parameters)
    }

    /// Whether no row was between two pieces of its law: else these are derivatives of one side.
    #[getter]
    fn is_smooth(&self) -> bool {
        self.found.report.one_sided.is_empty()
    }

    fn __repr__(&self) -> String {
        let ((n, m), p) = (self.found.control.shape(), self.wrt.len());
        format!("<tangency.StepJacobian: {n} states by {m} controls and {p} numbers>")
    }
}
