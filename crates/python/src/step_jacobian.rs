//! All derivatives of one step.

use numpy::PyArray2;
use pyo3::prelude::*;

use crate::arrays::matrix;

/// A = ∂x⁺/∂x, B = ∂x⁺/∂u, P = ∂x⁺/∂p.
#[pyclass(frozen, module = "tangency")]
pub(crate) struct StepJacobian {
    pub(crate) found: tangency::diff::StepJacobian,
    /// Names of p.
    #[pyo3(get)]
    pub(crate) wrt: Vec<String>,
}

#[pymethods]
impl StepJacobian {
    #[getter]
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        matrix(py, &self.found.state)
    }

    #[getter]
    fn control<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        matrix(py, &self.found.control)
    }

    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        matrix(py, &self.found.parameters)
    }

    /// Whether no row is between two pieces of its law.
    #[getter]
    fn is_smooth(&self) -> bool {
        self.found.report.one_sided.is_empty()
    }
}
