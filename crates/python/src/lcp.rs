//! Raw linear complementarity problems.

use nalgebra::DMatrix;
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use tangency::lcp::{LcpError, RawLcp, RawSolution};

use crate::arrays::{Numbers, matrix, vector};
use crate::errors::{GradientError, SolveError};

/// A solution of a linear complementarity problem; `solve_lcp` finds them.
///
/// ::
///
///     w = M z + q,      0 ≤ z ⟂ w ≥ 0      (the first `free` entries of z have any sign and w = 0)
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

/// Solves a linear complementarity problem.
///
/// ::
///
///     w = M z + q,      0 ≤ z ⟂ w ≥ 0      (the first `free` entries of z have any sign and w = 0)
///
/// Parameters
/// ----------
/// matrix : array_like, shape (n, n)
///     M; symmetric or not.
/// q : array_like, shape (n,)
///     q.
/// free : int
///     How many of the first unknowns are free.
/// backend : str
///     The solver, one of `backends`.
///
/// Returns
/// -------
/// LcpSolution
///
/// Raises
/// ------
/// SolveError
///     If there is no solution, none was found, or the backend does not take such matrices.
/// ValueError
///     If a shape does not fit or a number is not finite.
#[pyfunction]
#[pyo3(signature = (matrix, q, *, free = 0, backend = "ipm"))]
pub(crate) fn solve_lcp(
    py: Python<'_>,
    matrix: Numbers,
    q: Numbers,
    free: usize,
    backend: &str,
) -> PyResult<LcpSolution> {
    let n = q.values.len();
    q.expect("q", "(n,)", &[n])?;
    matrix.expect("matrix", "(n, n)", &[n, n])?;
    if free > n {
        return Err(PyValueError::new_err(format!("free is {free}; give at most n = {n}")));
    }
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
            LcpError::NotConverged { .. } => GradientError::new_err(
                "the active columns depend on each other: the solution has no derivative",
            ),
            other => refused(&other),
        })
    }
}

#[pymethods]
impl LcpSolution {
    /// Unknowns, shape (n,).
    #[getter]
    fn z<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, &self.solution.z)
    }

    /// M z + q, shape (n,).
    #[getter]
    fn w<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, &self.solution.w)
    }

    /// max |min(z, w)| (|w| for free unknowns) over 1 + max |q|.
    #[getter]
    fn residual(&self) -> f64 {
        self.solution.residual
    }

    /// Iterations of the solver: of its interior point, or pivots where it has no other.
    #[getter]
    fn iterations(&self) -> u32 {
        self.solution.iterations
    }

    /// Indices with zᵢ > 0 or free, in order.
    #[getter]
    fn active(&self) -> Vec<usize> {
        self.solution.active.clone()
    }

    /// Indices with zᵢ = wᵢ = 0, where derivatives are one-sided; they count as inactive.
    #[getter]
    fn weak(&self) -> Vec<usize> {
        self.solution.weak.clone()
    }

    /// Whether the solution is locally unique and differentiable.
    #[getter]
    fn is_regular(&self) -> bool {
        self.solution.is_regular()
    }

    /// dz/dq: −(M_aa)⁻¹ in the rows and columns of `active`, zero elsewhere.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (n, n)
    ///
    /// Raises
    /// ------
    /// GradientError
    ///     If the active columns depend on each other, so that there is no derivative.
    fn jacobian<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        matrix(py, &self.derivative()?)
    }

    /// ∂L/∂M and ∂L/∂q from ∂L/∂z: q̄ = (dz/dq)ᵀ z̄ and M̄ = q̄ zᵀ.
    ///
    /// Parameters
    /// ----------
    /// z : array_like, shape (n,)
    ///     ∂L/∂z.
    ///
    /// Returns
    /// -------
    /// matrix : ndarray, shape (n, n)
    ///     ∂L/∂M.
    /// q : ndarray, shape (n,)
    ///     ∂L/∂q.
    ///
    /// Raises
    /// ------
    /// GradientError
    ///     If the active columns depend on each other, so that there is no derivative.
    /// ValueError
    ///     If `z` has another shape.
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

    /// The change of z along (dM, dq): dz/dq (dM z + dq).
    ///
    /// Parameters
    /// ----------
    /// matrix : array_like, shape (n, n), optional
    ///     dM. Zero unless given.
    /// q : array_like, shape (n,), optional
    ///     dq. Zero unless given.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (n,)
    ///
    /// Raises
    /// ------
    /// GradientError
    ///     If the active columns depend on each other, so that there is no derivative.
    /// ValueError
    ///     If an array has another shape.
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

    fn __repr__(&self) -> String {
        let (n, active) = (self.solution.z.len(), self.solution.active.len());
        format!(
            "<tangency.LcpSolution: {active} of {n} unknowns active, residual {:.1e}>",
            self.solution.residual
        )
    }
}
