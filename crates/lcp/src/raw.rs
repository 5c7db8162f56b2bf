//! Raw linear complementarity problems, of any dense matrix.
//!
//! ```text
//!  w = M z + q
//!  wᵢ = 0, zᵢ free        for i < free
//!  0 ≤ zᵢ ⟂ wᵢ ≥ 0        otherwise
//! ```
//!
//! Symmetric powers of two bring the entries near one. A backend offers approximate unknowns to
//! [`RawPolish`]; what no attempt brings below the acceptance is an error, never a solution.

#![expect(non_snake_case, reason = "matrices carry their names from the literature")]

use crate::{BandMatrix, BoxForm, BoxLaw, LcpError};
use nalgebra::{DMatrix, DVector};

mod friction;
mod polish;
mod solver;

pub use friction::RawFriction;
pub use polish::RawPolish;
pub use solver::RawSolver;

/// Greatest residual that counts as solved.
const ACCEPTANCE: f64 = 1e-10;

/// The problem.
#[derive(Clone, Debug, PartialEq)]
pub struct RawLcp {
    /// Number of leading unknowns that are free, with an equation each.
    pub free: usize,
    /// M, n × n.
    pub matrix: DMatrix<f64>,
    /// q, n.
    pub q: DVector<f64>,
}

/// A solution, confirmed by its residual.
#[derive(Clone, Debug, PartialEq)]
pub struct RawSolution {
    /// Unknowns, n.
    pub z: DVector<f64>,
    /// M z + q, n.
    pub w: DVector<f64>,
    /// max |min(z, w)| (|w| for free unknowns) over 1 + max |q|.
    pub residual: f64,
    /// Iterations of the solver: of its interior point, or pivots where it has no other.
    pub iterations: u32,
    /// Pivots of Lemke's method, 0 where it was not needed.
    pub pivots: u32,
    /// Unknowns with zᵢ > 0 or free, in order.
    pub active: Vec<usize>,
    /// Indices with zᵢ = wᵢ = 0, where derivatives are one-sided; counted as inactive.
    pub weak: Vec<usize>,
    /// Dependent columns among the active ones; above 0 the solution is not locally unique.
    pub rank_defect: u32,
}

impl RawSolution {
    /// Whether the solution is locally unique and differentiable in q.
    #[must_use]
    pub fn is_regular(&self) -> bool {
        self.rank_defect == 0 && self.weak.is_empty()
    }
}

impl RawLcp {
    /// max |min(z, w)| / (1 + max |q|), free rows counting |w|; infinite if not finite.
    #[must_use]
    pub fn residual(&self, z: &DVector<f64>) -> f64 {
        let w = &self.matrix * z + &self.q;
        let defect = |i: usize| if i < self.free { w[i] } else { z[i].min(w[i]) };
        let worst = (0..w.len()).fold(0.0_f64, |worst, i| {
            if z[i].is_finite() && w[i].is_finite() {
                worst.max(defect(i).abs())
            } else {
                f64::INFINITY
            }
        });
        worst / (1.0 + self.q.amax())
    }

    /// dz/dq on the active set of a solution, n × n: −M_AA⁻¹ on the active block, 0 elsewhere.
    ///
    /// # Errors
    /// [`LcpError::NotConverged`] with the solution's residual if the active block is singular.
    pub fn derivative(&self, solution: &RawSolution) -> Result<DMatrix<f64>, LcpError> {
        let n = self.q.len();
        let active = &solution.active;
        let block = self.matrix.select_rows(active).select_columns(active);
        let (iterations, residual) = (solution.iterations, solution.residual);
        let singular = LcpError::NotConverged { iterations, residual };
        if solution.rank_defect > 0 {
            return Err(singular);
        }
        let inverse = block.try_inverse().ok_or(singular)?;
        let mut derivative = DMatrix::zeros(n, n);
        for (i, &row) in active.iter().enumerate() {
            for (j, &column) in active.iter().enumerate() {
                derivative[(row, column)] = -inverse[(i, j)];
            }
        }
        Ok(derivative)
    }

    /// Checks sizes and finiteness.
    ///
    /// # Errors
    /// The first offence, with the entry.
    pub fn validate(&self) -> Result<(), LcpError> {
        let n = self.q.len();
        for (what, found) in
            [("matrix rows", self.matrix.nrows()), ("matrix columns", self.matrix.ncols())]
        {
            if found != n {
                return Err(LcpError::DimensionMismatch { what, expected: n, found });
            }
        }
        if self.free > n {
            let (what, expected, found) = ("free", n, self.free);
            return Err(LcpError::DimensionMismatch { what, expected, found });
        }
        if let Some(index) = (0..n).find(|&i| !self.q[i].is_finite()) {
            return Err(LcpError::NotFinite { what: "q", index });
        }
        match (0..n).find(|&i| self.matrix.row(i).iter().any(|entry| !entry.is_finite())) {
            Some(index) => Err(LcpError::NotFinite { what: "matrix row", index }),
            None => Ok(()),
        }
    }

    /// The box form: rows and columns scaled by powers of two, q by its largest entry.
    #[must_use]
    pub fn box_form(&self) -> BoxForm {
        let n = self.q.len();
        let scale = equilibrate(&self.matrix);
        let mut matrix = BandMatrix::zeros(n, half_width(&self.matrix));
        for i in 0..n {
            for j in matrix.columns(i) {
                matrix.add(i, j, scale[i] * self.matrix[(i, j)] * scale[j]);
            }
        }
        let q: Vec<f64> = self.q.iter().zip(&scale).map(|(q, scale)| q * scale).collect();
        let largest = q.iter().fold(0.0_f64, |largest, q| largest.max(q.abs()));
        let size = if largest > 0.0 { power_of_two(largest) } else { 1.0 };
        let law = |i| if i < self.free { BoxLaw::Free } else { BoxLaw::Positive };
        BoxForm {
            matrix,
            q: q.iter().map(|q| q / size).collect(),
            laws: (0..n).map(law).collect(),
            unscale: scale.iter().map(|scale| scale * size).collect(),
            rows: (0..u32::try_from(n).unwrap_or(u32::MAX)).collect(),
        }
    }
}

/// Greatest distance of a non-zero entry from the diagonal.
fn half_width(M: &DMatrix<f64>) -> usize {
    let n = M.nrows();
    let entries = (0..n).flat_map(|j| (0..n).map(move |i| (i, j)));
    entries.filter(|&at| M[at] != 0.0).map(|(i, j)| i.abs_diff(j)).max().unwrap_or(0)
}

/// Symmetric scaling by powers of two towards largest entries of one in every row and column
/// (Ruiz 2001).
fn equilibrate(M: &DMatrix<f64>) -> Vec<f64> {
    let n = M.nrows();
    let mut scale = vec![1.0_f64; n];
    for _ in 0..20 {
        let largest = |i: usize| {
            (0..n).fold(0.0_f64, |largest, j| {
                largest.max(M[(i, j)].abs().max(M[(j, i)].abs()) * scale[i] * scale[j])
            })
        };
        let sizes: Vec<f64> = (0..n).map(largest).collect();
        for (scale, size) in scale.iter_mut().zip(sizes) {
            if size > 0.0 {
                *scale /= size.sqrt();
            }
        }
    }
    scale.into_iter().map(power_of_two).collect()
}

fn power_of_two(value: f64) -> f64 {
    value.log2().round().clamp(-500.0, 500.0).exp2()
}

impl RawSolution {
    /// The solution of a problem without unknowns.
    #[must_use]
    pub fn empty() -> Self {
        let (z, w) = (DVector::zeros(0), DVector::zeros(0));
        let (active, weak) = (Vec::new(), Vec::new());
        Self { z, w, residual: 0.0, iterations: 0, pivots: 0, active, weak, rank_defect: 0 }
    }
}
