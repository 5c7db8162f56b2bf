//! Raw linear complementarity problems.

use nalgebra::DMatrix;
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use tangency::lcp::{LcpError, RawLcp, RawSolution};

use crate::arrays::{Numbers, matrix, vector};
use crate::errors::SolveError;

/// A solution of w = M z + q, 0 ≤ z ⟂ w ≥ 0.
#[pyclass(frozen, module = "tangency")]
pub(crate) struct LcpSolution {
    problem: RawLcp,
    solution: RawSolution,
}

fn refused(error: &LcpError) -> PyErr {
    match error {
        LcpError::NotFinite { .. }
        | LcpError::DimensionMismatch { .. }
        | LcpError::OutOfRange { .. } => PyValueError::new_err(error.to_string()),
        _ => SolveError::new_err(error.to_string()),
    }
}

/// See `tangency/_native.pyi`.
#[pyfunction]
#[pyo3(signature = (matrix, q, *, free = 0, backend = "ipm"))]
pub(crate) fn solve_lcp(
    py: Python<'_>,
    matrix: Numbers,
    q: Numbers,
    free: usize,
    backend: &str,
) -> PyResult<LcpSolution> {
    q.expect("q", "(n,)", &[q.values.len()])?;
    let problem = RawLcp { free, matrix: matrix.matrix("matrix")?, q: q.vector() };
    let known = tangency::BACKENDS;
    let unknown = || {
        let known = known.join(", ");
        PyValueError::new_err(format!("backend is {backend:?}; give one of {known}"))
    };
    let place = known.iter().position(|name| *name == backend).ok_or_else(unknown)?;
    let solver = tangency::raw_solvers().swap_remove(place);
    let solution = py.detach(|| solver.solve_raw(&problem)).map_err(|error| refused(&error))?;
    Ok(LcpSolution { problem, solution })
}

impl LcpSolution {
    fn derivative(&self) -> PyResult<DMatrix<f64>> {
        self.problem.derivative(&self.solution).map_err(|error| match error {
            LcpError::NotConverged { .. } => PyRuntimeError::new_err(
                "the active columns depend on each other: the solution has no derivative",
            ),
            other => refused(&other),
        })
    }
}

#[pymethods]
impl LcpSolution {
    #[getter]
    fn z<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, &self.solution.z)
    }

    #[getter]
    fn w<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, &self.solution.w)
    }

    #[getter]
    fn residual(&self) -> f64 {
        self.solution.residual
    }

    #[getter]
    fn iterations(&self) -> u32 {
        self.solution.iterations
    }

    #[getter]
    fn active(&self) -> Vec<usize> {
        self.solution.active.clone()
    }

    #[getter]
    fn weak(&self) -> Vec<usize> {
        self.solution.weak.clone()
    }

    #[getter]
    fn is_regular(&self) -> bool {
        self.solution.is_regular()
    }

    /// dz/dq, (n, n).
    fn jacobian<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        matrix(py, &self.derivative()?)
    }

    /// (∂L/∂M, ∂L/∂q) from ∂L/∂z: q̄ = (dz/dq)ᵀ z̄, M̄ = q̄ zᵀ.
    #[expect(clippy::type_complexity, reason = "a matrix and a vector")]
    fn vjp<'py>(
        &self,
        py: Python<'py>,
        z: Numbers,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>)> {
        z.expect("z", "(n,)", &[self.solution.z.len()])?;
        let q_bar = self.derivative()?.tr_mul(&z.vector());
        let m_bar = &q_bar * self.solution.z.transpose();
        Ok((matrix(py, &m_bar)?, vector(py, &q_bar)))
    }

    /// dz from (dM, dq): dz/dq (dM z + dq).
    #[pyo3(signature = (matrix = None, q = None))]
    fn jvp<'py>(
        &self,
        py: Python<'py>,
        matrix: Option<Numbers>,
        q: Option<Numbers>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let n = self.solution.z.len();
        let mut change = nalgebra::DVector::zeros(n);
        if let Some(dm) = matrix {
            dm.expect("matrix", "(n, n)", &[n, n])?;
            change += dm.matrix("matrix")? * &self.solution.z;
        }
        if let Some(dq) = q {
            dq.expect("q", "(n,)", &[n])?;
            change += dq.vector();
        }
        Ok(vector(py, &(self.derivative()? * change)))
    }
}
