//! The box form as a standard complementarity problem for Lemke's method.
//!
//! ```text
//!  free unknowns    y of equalities and of box rows       equations  u = 0,   u + w⁺ − w⁻ = 0
//!  pairs            y ⟂ u of positive rows;   w⁺ ⟂ s⁺,   w⁻ ⟂ s⁻ of box rows,   s± = h ∓ y
//! ```
//!
//! The free unknowns are eliminated, (W_FF + δ I) y_F = −(q_F + W_FP z), which leaves pairs only.

#![expect(non_snake_case, reason = "matrices carry their names from the notes")]

use nalgebra::{DMatrix, DVector};

use crate::box_form::{BoxForm, BoxLaw};
use crate::lemke::{Outcome, lemke};

/// δ, relative to the unit diagonal of W.
const PROXIMAL: f64 = 1e-10;
/// Above this number of pairs a dense tableau costs too much.
const MOST_PAIRS: usize = 700;
/// Covering vectors tried.
const ATTEMPTS: u64 = 4;

/// Candidates y from Lemke's method, one per attempt that ended in a solution.
pub(crate) fn candidates(form: &BoxForm) -> impl Iterator<Item = (Vec<f64>, u32)> {
    let standard = (form.pairs() <= MOST_PAIRS).then(|| Standard::new(form)).flatten();
    (0..ATTEMPTS).filter_map(move |attempt| standard.as_ref()?.attempt(attempt))
}

/// w = M z + q over pairs, and y = y₀ + Y z.
struct Standard {
    M: DMatrix<f64>,
    q: DVector<f64>,
    Y: DMatrix<f64>,
    y0: DVector<f64>,
}

impl Standard {
    fn new(form: &BoxForm) -> Option<Self> {
        let n = form.len();
        let positive: Vec<usize> = form.slots(|law| law == BoxLaw::Positive);
        let free: Vec<usize> = form.slots(|law| law != BoxLaw::Positive);
        let boxes: Vec<usize> =
            form.slots(|law| !matches!(law, BoxLaw::Positive | BoxLaw::Free));
        let W = DMatrix::from_fn(n, n, |i, j| form.entry(i, j));
        let q = DVector::from_column_slice(&form.q);
        let pairs = positive.len() + 2 * boxes.len();

        // y_F = −(W_FF + δ I)⁻¹ (q_F + W_FN y_N + (w⁺ − w⁻)), columns for y_N, w⁺, w⁻.
        let W_FF = W.select_rows(&free).select_columns(&free)
            + DMatrix::identity(free.len(), free.len()) * PROXIMAL;
        let mut drive = DMatrix::zeros(free.len(), pairs);
        drive
            .columns_mut(0, positive.len())
            .copy_from(&W.select_rows(&free).select_columns(&positive));
        for (k, slot) in boxes.iter().enumerate() {
            let row = free.binary_search(slot).ok()?;
            drive[(row, positive.len() + 2 * k)] = 1.0;
            drive[(row, positive.len() + 2 * k + 1)] = -1.0;
        }
        let factor = W_FF.lu();
        let Y_F = -factor.solve(&drive)?;
        let y0_F = -factor.solve(&DVector::from_iterator(free.len(), free.iter().map(|&i| q[i])))?;

        let (mut Y, mut y0) = (DMatrix::zeros(n, pairs), DVector::zeros(n));
        for (k, &slot) in free.iter().enumerate() {
            Y.row_mut(slot).copy_from(&Y_F.row(k));
            y0[slot] = y0_F[k];
        }
        for (k, &slot) in positive.iter().enumerate() {
            Y[(slot, k)] = 1.0;
        }
        let (mut M, mut q_pairs) = (DMatrix::zeros(pairs, pairs), DVector::zeros(pairs));
        let (u, u0) = (&W * &Y, &W * &y0 + q);
        for (k, &slot) in positive.iter().enumerate() {
            M.row_mut(k).copy_from(&u.row(slot));
            q_pairs[k] = u0[slot];
        }
        for (k, &slot) in boxes.iter().enumerate() {
            let at = positive.len() + 2 * k;
            for (row, sign) in [(at, -1.0), (at + 1, 1.0)] {
                M.row_mut(row).copy_from(&(sign * Y.row(slot)));
                q_pairs[row] = sign * y0[slot];
                match form.laws[slot] {
                    BoxLaw::Bounded { max } => q_pairs[row] += max,
                    BoxLaw::Friction { normal, mu } => {
                        let column = positive.binary_search(&normal).ok()?;
                        M[(row, column)] += mu;
                    }
                    BoxLaw::Free | BoxLaw::Positive => {}
                }
            }
        }
        Some(Self { M, q: q_pairs, Y, y0 })
    }

    fn attempt(&self, attempt: u64) -> Option<(Vec<f64>, u32)> {
        let n = self.q.len();
        let cover = DVector::from_fn(n, |i, _| 1.0 + covering(attempt, i));
        let limit = u32::try_from(20 * n + 100).unwrap_or(u32::MAX);
        match lemke(&self.M, &self.q, &cover, limit) {
            (Outcome::Solution(z), pivots) => {
                let y = &self.y0 + &self.Y * z;
                Some((y.as_slice().to_vec(), pivots))
            }
            (Outcome::Ray | Outcome::Unfinished, _) => None,
        }
    }
}

/// A fixed irregular number in [0, 1); 0 for the first attempt.
pub(crate) fn covering(attempt: u64, index: usize) -> f64 {
    let golden = 0.618_033_988_749_894_9;
    (attempt as f64 * (index as f64 + 1.0) * golden).fract()
}
