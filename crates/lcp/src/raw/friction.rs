//! Planar friction problems given by their local matrix.
//!
//! ```text
//!  u = W r + q       per contact (n, t):  0 ≤ uₙ ⟂ rₙ ≥ 0,   |r_t| ≤ μ rₙ,   uₜ ≷ 0 ⇒ r_t = ∓ μ rₙ
//! ```
//!
//! As a linear complementarity problem (Pfeiffer & Glocker 1996), with a = r_t + μ rₙ the distance
//! from one side of the cone, b = μ rₙ − r_t from the other, and uₜ = uₜ⁺ − uₜ⁻:
//!
//! ```text
//!  0 ≤ rₙ ⟂ uₙ ≥ 0      0 ≤ a ⟂ uₜ + uₜ⁻ ≥ 0      0 ≤ uₜ⁻ ⟂ 2 μ rₙ − a ≥ 0
//! ```

#![expect(non_snake_case, reason = "matrices carry their names from the literature")]

use nalgebra::{DMatrix, DVector};

use super::{ACCEPTANCE, RawLcp, RawSolution};
use crate::LcpError;
use crate::validate::{SIZES, finite};

/// The problem: k contacts, normal and tangent interleaved.
#[derive(Clone, Debug, PartialEq)]
pub struct RawFriction {
    /// W, 2k × 2k.
    pub matrix: DMatrix<f64>,
    /// q, 2k.
    pub q: DVector<f64>,
    /// μ per contact, k; not negative.
    pub mu: Vec<f64>,
}

/// √Wᵢᵢ per row, and the problem's scale.
struct Units {
    root: Vec<f64>,
    scale: f64,
}

/// Where the unknowns of one contact stand in the raw problem.
#[derive(Clone, Copy)]
struct Place {
    contact: usize,
    /// Index of rₙ; a and uₜ⁻ follow if there is friction.
    first: usize,
}

impl RawFriction {
    /// Checks sizes, signs, finiteness, and that squares do not over- or underflow.
    ///
    /// # Errors
    /// The first offence, with the entry.
    pub fn validate(&self) -> Result<(), LcpError> {
        let expected = 2 * self.mu.len();
        for (what, found) in [
            ("q", self.q.len()),
            ("matrix rows", self.matrix.nrows()),
            ("matrix columns", self.matrix.ncols()),
        ] {
            if found != expected {
                return Err(LcpError::DimensionMismatch { what, expected, found });
            }
        }
        for (index, &value) in self.mu.iter().enumerate() {
            finite("mu", index, value)?;
            if value != 0.0 && value < *SIZES.start() {
                return Err(LcpError::OutOfRange { what: "mu", index, value });
            }
        }
        for (index, &value) in self.q.iter().enumerate() {
            finite("q", index, value)?;
        }
        for (index, row) in self.matrix.row_iter().enumerate() {
            row.iter().try_for_each(|&value| finite("matrix row", index, value))?;
        }
        for (index, value) in self.matrix.diagonal().into_iter().copied().enumerate() {
            if value > 0.0 && value < *SIZES.start() {
                return Err(LcpError::OutOfRange { what: "matrix diagonal", index, value });
            }
        }
        Ok(())
    }

    /// The linear complementarity problem in (rₙ, a, uₜ⁻) per contact, rₙ alone where μ = 0, of the
    /// weighted problem: its residual is about that of [`residual`](Self::residual).
    #[must_use]
    pub fn to_raw(&self) -> RawLcp {
        self.weighted().to_raw_unweighted()
    }

    /// The problem in r √Wᵢᵢ / s and u / (√Wᵢᵢ s), with s the largest |qᵢ|/√Wᵢᵢ.
    #[must_use]
    pub fn weighted(&self) -> Self {
        let Units { root, scale } = self.units();
        let matrix = DMatrix::from_fn(root.len(), root.len(), |i, j| {
            self.matrix[(i, j)] / (root[i] * root[j])
        });
        let q = DVector::from_fn(root.len(), |i, _| self.q[i] / (root[i] * scale));
        let ratio = |(k, mu): (usize, &f64)| mu * root[2 * k + 1] / root[2 * k];
        Self { matrix, q, mu: self.mu.iter().enumerate().map(ratio).collect() }
    }

    fn units(&self) -> Units {
        let positive = |w: f64| if w > 0.0 { w.sqrt() } else { 1.0 };
        let root: Vec<f64> = self.matrix.diagonal().iter().map(|&w| positive(w)).collect();
        let largest =
            self.q.iter().zip(&root).fold(0.0_f64, |s, (q, root)| s.max((q / root).abs()));
        Units { root, scale: if largest > 0.0 { largest } else { 1.0 } }
    }

    fn to_raw_unweighted(&self) -> RawLcp {
        let places: Vec<Place> = self.places().collect();
        let n = self.size();
        let (mut M, mut q) = (DMatrix::zeros(n, n), DVector::zeros(n));
        // r = R z, then u = (W R) z + q.
        let mut R = DMatrix::zeros(self.q.len(), n);
        for &Place { contact, first } in &places {
            R[(2 * contact, first)] = 1.0;
            if self.mu[contact] > 0.0 {
                R[(2 * contact + 1, first)] = -self.mu[contact];
                R[(2 * contact + 1, first + 1)] = 1.0;
            }
        }
        let along = &self.matrix * R;
        for &Place { contact, first } in &places {
            M.row_mut(first).copy_from(&along.row(2 * contact));
            q[first] = self.q[2 * contact];
            if self.mu[contact] > 0.0 {
                M.row_mut(first + 1).copy_from(&along.row(2 * contact + 1));
                q[first + 1] = self.q[2 * contact + 1];
                M[(first + 1, first + 2)] = 1.0;
                M[(first + 2, first)] = 2.0 * self.mu[contact];
                M[(first + 2, first + 1)] = -1.0;
            }
        }
        RawLcp { free: 0, matrix: M, q }
    }

    /// r from the unknowns of [`to_raw`](Self::to_raw), 2k.
    #[must_use]
    pub fn reactions(&self, z: &DVector<f64>) -> DVector<f64> {
        let Units { root, scale } = self.units();
        let mut r = DVector::zeros(self.q.len());
        for Place { contact, first } in self.places() {
            let (n, t) = (2 * contact, 2 * contact + 1);
            r[n] = z[first] * scale / root[n];
            if self.mu[contact] > 0.0 {
                r[t] = z[first + 1] * scale / root[t] - self.mu[contact] * r[n];
            }
        }
        r
    }

    /// The unknowns (rₙ, a, uₜ⁻) of this problem as it stands, without weights.
    #[must_use]
    pub fn unknowns(&self, r: &DVector<f64>) -> DVector<f64> {
        let u = &self.matrix * r + &self.q;
        let mut z = DVector::zeros(self.size());
        for Place { contact, first } in self.places() {
            let (n, t) = (r[2 * contact], r[2 * contact + 1]);
            z[first] = n;
            if self.mu[contact] > 0.0 {
                z[first + 1] = t + self.mu[contact] * n;
                z[first + 2] = (-u[2 * contact + 1]).max(0.0);
            }
        }
        z
    }

    /// Natural residual of r in the units of [`Residual`](crate::Residual): √Wᵢᵢ weighs impulses,
    /// 1/√Wᵢᵢ velocities, and the largest |qᵢ|/√Wᵢᵢ is one.
    #[must_use]
    pub fn residual(&self, r: &DVector<f64>) -> f64 {
        let u = &self.matrix * r + &self.q;
        let Units { root, scale } = self.units();
        let scaled = |i: usize| (r[i] * root[i], u[i] / root[i]);
        let mut worst = 0.0_f64;
        for (contact, mu) in self.mu.iter().enumerate() {
            let (n, t) = (2 * contact, 2 * contact + 1);
            let (y, w) = scaled(n);
            let (yt, wt) = scaled(t);
            let bound = mu * r[n].max(0.0) * root[t];
            for defect in [y.min(w), yt - (yt - wt).max(-bound).min(bound)] {
                worst = if defect.is_finite() { worst.max(defect.abs()) } else { f64::INFINITY };
            }
        }
        let residual = worst / scale;
        if residual.is_nan() { f64::INFINITY } else { residual }
    }

    /// The solution of [`to_raw`](Self::to_raw), if [`residual`](Self::residual) confirms it: where W
    /// is of very different sizes, the raw problem's own residual is not enough.
    ///
    /// # Errors
    /// [`LcpError::Rejected`].
    pub fn judged(
        &self,
        solver: &'static str,
        solution: RawSolution,
    ) -> Result<RawSolution, LcpError> {
        let residual = self.residual(&self.reactions(&solution.z));
        if residual <= ACCEPTANCE {
            return Ok(solution);
        }
        Err(LcpError::Rejected { solver, residual, tolerance: ACCEPTANCE })
    }

    /// dr/dq at a solution of [`to_raw`](Self::to_raw), 2k × 2k.
    ///
    /// # Errors
    /// [`LcpError::NotConverged`] with the solution's residual if the active block is singular.
    pub fn derivative(&self, solution: &RawSolution) -> Result<DMatrix<f64>, LcpError> {
        let by = self.to_raw().derivative(solution)?;
        let weighted = self.weighted();
        let Units { root, .. } = self.units();
        let mut derivative = DMatrix::zeros(self.q.len(), self.q.len());
        for Place { contact: c, first } in self.places() {
            for Place { contact: d, first: column } in self.places() {
                for k in 0..if self.mu[d] > 0.0 { 2 } else { 1 } {
                    let normal = by[(first, column + k)];
                    derivative[(2 * c, 2 * d + k)] = normal;
                    if self.mu[c] > 0.0 {
                        let a = by[(first + 1, column + k)];
                        derivative[(2 * c + 1, 2 * d + k)] = a - weighted.mu[c] * normal;
                    }
                }
            }
        }
        derivative
            .iter_mut()
            .enumerate()
            .for_each(|(k, entry)| *entry /= root[k % root.len()] * root[k / root.len()]);
        Ok(derivative)
    }

    fn size(&self) -> usize {
        self.mu.iter().map(|&mu| if mu > 0.0 { 3 } else { 1 }).sum()
    }

    fn places(&self) -> impl Iterator<Item = Place> + '_ {
        self.mu.iter().enumerate().scan(0, |next, (contact, &mu)| {
            let first = *next;
            *next += if mu > 0.0 { 3 } else { 1 };
            Some(Place { contact, first })
        })
    }
}
