//! Nearly dependent rows: the reduced system as one dense saddle matrix and its pseudo-inverse.
//!
//! S squares the rows' condition: two pins 10⁻⁸ of a rod's length apart are one pin to it. In
//!
//! ```text
//!  ⎡ α I   −Ĉᵀ ⎤ ⎡ v̂   ⎤   ⎡ α p̂ ⎤        v̂ = √M v,  Ĉ = R C /√M,  B̂ = R B /√M,  R = diag(1/√Wᵢᵢ)
//!  ⎣ B̂    ĉ/α  ⎦ ⎣ α ŷ ⎦ = ⎣ b̂   ⎦
//! ```
//!
//! with α ≪ 1 they are two. Costs O((3n + m)³): the second attempt, for small problems.

#![expect(non_snake_case, reason = "matrices carry their names from the notes")]

use nalgebra::{DMatrix, DVector};

use crate::delassus::Scaling;
use crate::{Fold, Lcp, pseudo_inverse};

const ALPHA: f64 = 1e-7;
/// Singular values below this count as zero.
const DEPENDENT: f64 = 1e-12;
/// Above this many unknowns there is no second attempt.
const MOST_UNKNOWNS: usize = 200;

/// Pseudo-inverse in mass-weighted unknowns (v̂, ŷ).
pub(crate) struct Saddle {
    inverse: DMatrix<f64>,
    unknowns: usize,
}

impl Saddle {
    /// `None` if the problem is too large or the decomposition fails.
    pub(crate) fn new(
        problem: &Lcp,
        rows: &[u32],
        folds: &[Fold],
        scaling: &Scaling,
    ) -> Option<Self> {
        let (n, m) = (3 * problem.mass.len(), rows.len());
        if n + m > MOST_UNKNOWNS {
            return None;
        }
        let mut K = DMatrix::zeros(n + m, n + m);
        K.view_mut((0, 0), (n, n)).fill_diagonal(ALPHA);
        let mut add = |row: u32, slot: usize, coefficient: f64, in_B: bool| {
            for (body, J) in problem.rows[row as usize].blocks() {
                for k in 0..3 {
                    let root = (scaling.unit * problem.mass[body][k]).sqrt();
                    let scaled = scaling.to_impulse[slot] * J[k] / root;
                    K[(3 * body + k, n + slot)] -= coefficient * scaled;
                    if in_B {
                        K[(n + slot, 3 * body + k)] += scaled;
                    }
                }
            }
        };
        for (slot, &row) in rows.iter().enumerate() {
            add(row, slot, 1.0, true);
        }
        for fold in folds {
            add(fold.row, fold.column as usize, fold.coefficient, false);
        }
        for (slot, &row) in rows.iter().enumerate() {
            let compliance = problem.rows[row as usize].compliance
                * scaling.of_remainder[slot]
                * scaling.to_impulse[slot];
            K[(n + slot, n + slot)] += compliance / ALPHA;
        }
        Some(Self { inverse: pseudo_inverse(&K, DEPENDENT)?, unknowns: n })
    }

    /// (v̂, ŷ) from (p̂, b̂).
    pub(crate) fn solve(&self, right: &DVector<f64>) -> DVector<f64> {
        let mut right = right.clone();
        right.rows_mut(0, self.unknowns).scale_mut(ALPHA);
        self.unscale_impulses(&self.inverse * right)
    }

    /// (v̂, ŷ) of the transposed system, M v + Bᵀ y = p, −C v + c y = b.
    ///
    /// ```text
    ///  K = L K₀ D with L = diag(α, 1), D = diag(1, 1/α):   K₀⁻ᵀ = L K⁻ᵀ D
    /// ```
    pub(crate) fn solve_transpose(&self, right: &DVector<f64>) -> DVector<f64> {
        let scaled = {
            let mut right = right.clone();
            let impulses = right.len() - self.unknowns;
            right.rows_mut(self.unknowns, impulses).scale_mut(1.0 / ALPHA);
            right
        };
        let mut found = self.inverse.tr_mul(&scaled);
        found.rows_mut(0, self.unknowns).scale_mut(ALPHA);
        found
    }

    fn unscale_impulses(&self, mut found: DVector<f64>) -> DVector<f64> {
        let impulses = found.len() - self.unknowns;
        found.rows_mut(self.unknowns, impulses).scale_mut(1.0 / ALPHA);
        found
    }
}
