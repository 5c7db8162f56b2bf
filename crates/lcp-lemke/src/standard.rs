//! The box form as a standard complementarity problem for Lemke's method (Stewart & Trinkle 1996).
//!
//! ```text
//!  E free unknowns, N the others; W_EE⁺ the pseudo-inverse
//!  W' = W_NN − W_NE W_EE⁺ W_EN           q' = q_N − W_NE W_EE⁺ q_E           u_N = W' y_N + q'
//!
//!  positive    y ⟂ u
//!  box         y = y⁺ − y⁻;     y⁺ ⟂ γ + u,     y⁻ ⟂ γ − u,     γ ⟂ h − y⁺ − y⁻
//! ```
//!
//! With two non-negative parts per box unknown the matrix is copositive for mechanical problems, for
//! which Lemke's method ends in a solution if the constraints allow rest; and its entries stay
//! moderate where rows depend on each other.

#![expect(non_snake_case, reason = "matrices carry their names from the notes")]

use nalgebra::{DMatrix, DVector};
use tangency_lcp::{BoxForm, BoxLaw, pseudo_inverse};

use crate::tableau::{Outcome, lemke};

/// Singular values of W_EE below this count as zero.
const DEPENDENT: f64 = 1e-9;
/// Above this number of pairs a dense tableau costs too much.
const MOST_PAIRS: usize = 1200;
/// Above this number of rows, free ones included, their matrix does.
const MOST_ROWS: usize = 1500;
/// Covering vectors tried, and how many of them where a pivot costs much.
const ATTEMPTS: u64 = 8;
const FEW_ATTEMPTS: u64 = 3;
/// Above this number of pairs a pivot costs much.
const MANY_PAIRS: usize = 400;

/// Candidates y from Lemke's method, one per attempt that ended in a solution.
pub fn candidates(form: &BoxForm) -> impl Iterator<Item = (Vec<f64>, u32)> {
    let small = form.pairs() <= MOST_PAIRS && form.len() <= MOST_ROWS;
    let standard = small.then(|| Standard::new(form)).flatten();
    let attempts = if form.pairs() > MANY_PAIRS { FEW_ATTEMPTS } else { ATTEMPTS };
    (0..attempts).filter_map(move |attempt| standard.as_ref()?.attempt(attempt))
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
        let E = form.slots(|law| law == BoxLaw::Free);
        let N = form.slots(|law| law != BoxLaw::Free);
        let W = DMatrix::from_fn(n, n, |i, j| form.entry(i, j));
        let q = DVector::from_column_slice(&form.q);
        let block = |rows: &[usize], columns: &[usize]| W.select_rows(rows).select_columns(columns);
        let solve_E = if E.is_empty() {
            DMatrix::zeros(0, 0)
        } else {
            -pseudo_inverse(&block(&E, &E), DEPENDENT)?
        };
        let y_E = &solve_E * block(&E, &N);
        let y0_E = &solve_E * q.select_rows(&E);
        let u = block(&N, &N) + block(&N, &E) * &y_E;
        let u0 = q.select_rows(&N) + block(&N, &E) * &y0_E;

        let T = split(form, &N);
        let Y_N = &y_E * &T;
        let (mut Y, mut y0) = (DMatrix::zeros(n, T.ncols()), DVector::zeros(n));
        for (k, &slot) in E.iter().enumerate() {
            Y.row_mut(slot).copy_from(&Y_N.row(k));
            y0[slot] = y0_E[k];
        }
        for (k, &slot) in N.iter().enumerate() {
            Y.row_mut(slot).copy_from(&T.row(k));
        }
        let (M, q) = pairs(form, &N, &(u * T), &u0);
        Some(Self { M, q, Y, y0 })
    }

    fn attempt(&self, attempt: u64) -> Option<(Vec<f64>, u32)> {
        let n = self.q.len();
        let cover = DVector::from_fn(n, |i, _| 1.0 + covering(attempt, i));
        let limit = u32::try_from(8 * n + 200).unwrap_or(u32::MAX);
        match lemke(&self.M, &self.q, &cover, limit) {
            (Outcome::Solution(z), pivots) => {
                let y = &self.y0 + &self.Y * z;
                Some((y.as_slice().to_vec(), pivots))
            }
            (Outcome::Ray | Outcome::Unfinished, _) => None,
        }
    }
}

/// First pair of each slot of N: one per positive slot, three per box slot.
fn first_pairs<'a>(form: &'a BoxForm, N: &'a [usize]) -> impl Iterator<Item = usize> + 'a {
    N.iter().scan(0, |next, &slot| {
        let first = *next;
        *next += if form.laws[slot] == BoxLaw::Positive { 1 } else { 3 };
        Some(first)
    })
}

/// y_N = T z.
fn split(form: &BoxForm, N: &[usize]) -> DMatrix<f64> {
    let pairs: usize =
        N.iter().map(|&slot| if form.laws[slot] == BoxLaw::Positive { 1 } else { 3 }).sum();
    let mut T = DMatrix::zeros(N.len(), pairs);
    for ((k, &slot), pair) in N.iter().enumerate().zip(first_pairs(form, N)) {
        T[(k, pair)] = 1.0;
        if form.laws[slot] != BoxLaw::Positive {
            T[(k, pair + 1)] = -1.0;
        }
    }
    T
}

/// M and q of the pairs, from u = `along` z + `u0`.
fn pairs(
    form: &BoxForm,
    N: &[usize],
    along: &DMatrix<f64>,
    u0: &DVector<f64>,
) -> (DMatrix<f64>, DVector<f64>) {
    let count = along.ncols();
    let (mut M, mut q) = (DMatrix::zeros(count, count), DVector::zeros(count));
    let first: Vec<usize> = first_pairs(form, N).collect();
    for (k, &slot) in N.iter().enumerate() {
        let pair = first[k];
        M.row_mut(pair).copy_from(&along.row(k));
        q[pair] = u0[k];
        if form.laws[slot] == BoxLaw::Positive {
            continue;
        }
        M.row_mut(pair + 1).copy_from(&-along.row(k));
        q[pair + 1] = -u0[k];
        for part in [pair, pair + 1] {
            M[(part, pair + 2)] += 1.0;
            M[(pair + 2, part)] -= 1.0;
        }
        match form.laws[slot] {
            BoxLaw::Bounded { max } => q[pair + 2] = max,
            BoxLaw::Friction { normal, mu } => {
                let column = N.binary_search(&normal).map(|k| first[k]);
                M[(pair + 2, column.expect("normal rows are positive"))] += mu;
            }
            BoxLaw::Free | BoxLaw::Positive => {}
        }
    }
    (M, q)
}

/// A fixed irregular number in [0, 1); 0 for the first attempt.
fn covering(attempt: u64, index: usize) -> f64 {
    let golden = 0.618_033_988_749_894_9;
    (attempt as f64 * (index as f64 + 1.0) * golden).fract()
}
