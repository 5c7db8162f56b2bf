//! Lemke's complementary pivoting on a dense tableau, with the lexicographic ratio test.
//!
//! ```text
//!  w − M z − d z₀ = q,     w, z, z₀ ≥ 0,     zᵀ w = 0
//! ```
//!
//! From z₀ large enough, along the path of almost complementary bases, until z₀ leaves (a solution)
//! or nothing bounds the entering variable (a ray). Cottle, Pang & Stone 1992, section 4.4. The last
//! resort: O(n²) per pivot, and rounding grows with the pivots, so that the answer is polished.

#![expect(non_snake_case, reason = "matrices carry their names from the literature")]

use nalgebra::{DMatrix, DVector};

/// Entries below this, relative to the scaled matrix, are no pivots.
const LEAST_PIVOT: f64 = 1e-11;
/// Ratios closer than this are ties, broken lexicographically.
const TIE: f64 = 1e-13;

/// How a run of pivots ended.
#[derive(Clone, Debug)]
pub(crate) enum Outcome {
    /// z ≥ 0, not yet checked.
    Solution(DVector<f64>),
    /// A ray: the problem is infeasible or outside the classes that Lemke's method solves.
    Ray,
    /// The bound on pivots was reached.
    Unfinished,
}

/// Basis tableau: n rows; columns w (n), z (n), z₀, right side.
struct Tableau {
    n: usize,
    width: usize,
    entries: Vec<f64>,
    basis: Vec<usize>,
}

/// Solves w = M z + q with covering vector `d` > 0.
pub(crate) fn lemke(
    M: &DMatrix<f64>,
    q: &DVector<f64>,
    d: &DVector<f64>,
    max_pivots: u32,
) -> (Outcome, u32) {
    let n = q.len();
    if q.iter().all(|&q| q >= 0.0) {
        return (Outcome::Solution(DVector::zeros(n)), 0);
    }
    let mut tableau = Tableau::new(M, q, d);
    let artificial = 2 * n;
    let mut row = tableau.first_row(d);
    let mut entering = artificial;
    for pivots in 1..=max_pivots {
        let leaving = tableau.pivot(row, entering);
        if leaving == artificial {
            return (Outcome::Solution(tableau.solution()), pivots);
        }
        entering = if leaving < n { leaving + n } else { leaving - n };
        match tableau.ratio_test(entering, artificial) {
            Some(next) => row = next,
            None => return (Outcome::Ray, pivots),
        }
    }
    (Outcome::Unfinished, max_pivots)
}

impl Tableau {
    fn new(M: &DMatrix<f64>, q: &DVector<f64>, d: &DVector<f64>) -> Self {
        let n = q.len();
        let width = 2 * n + 2;
        let mut entries = vec![0.0; n * width];
        for (i, row) in entries.chunks_exact_mut(width).enumerate() {
            row[i] = 1.0;
            for j in 0..n {
                row[n + j] = -M[(i, j)];
            }
            row[2 * n] = -d[i];
            row[2 * n + 1] = q[i];
        }
        Self { n, width, entries, basis: (0..n).collect() }
    }

    fn row(&self, i: usize) -> &[f64] {
        &self.entries[i * self.width..(i + 1) * self.width]
    }

    fn rhs(&self, i: usize) -> f64 {
        self.row(i)[self.width - 1]
    }

    /// The row whose w becomes zero last as z₀ grows: lexicographic least (q, e)/d.
    fn first_row(&self, d: &DVector<f64>) -> usize {
        (1..self.n).fold(0, |best, i| if self.precedes(i, d[i], best, d[best]) { i } else { best })
    }

    fn ratio_test(&self, entering: usize, artificial: usize) -> Option<usize> {
        let mut best: Option<usize> = None;
        for i in 0..self.n {
            let entry = self.row(i)[entering];
            if entry <= LEAST_PIVOT {
                continue;
            }
            let replace = best.is_none_or(|b| {
                let other = self.row(b)[entering];
                let (ours, theirs) = (self.rhs(i) / entry, self.rhs(b) / other);
                let tie = (ours - theirs).abs() <= TIE * (1.0 + theirs.abs());
                if tie && self.basis[i] == artificial {
                    true
                } else if tie && self.basis[b] == artificial {
                    false
                } else {
                    self.precedes(i, entry, b, other)
                }
            });
            if replace {
                best = Some(i);
            }
        }
        best
    }

    /// Whether row i over `entry` comes lexicographically before row j over `other`, in the order
    /// right side, then the columns of w.
    fn precedes(&self, i: usize, entry: f64, j: usize, other: f64) -> bool {
        let columns = std::iter::once(self.width - 1).chain(0..self.n);
        for column in columns {
            let difference = self.row(i)[column] / entry - self.row(j)[column] / other;
            if difference.abs() > TIE * (1.0 + (self.row(j)[column] / other).abs()) {
                return difference < 0.0;
            }
        }
        false
    }

    /// Brings `entering` into the basis at `row`; returns the variable that leaves.
    fn pivot(&mut self, row: usize, entering: usize) -> usize {
        let inverse = self.row(row)[entering].recip();
        let pivot: Vec<f64> = self.row(row).iter().map(|entry| entry * inverse).collect();
        for (i, target) in self.entries.chunks_exact_mut(self.width).enumerate() {
            let factor = target[entering];
            if i == row {
                target.copy_from_slice(&pivot);
            } else if factor != 0.0 {
                target.iter_mut().zip(&pivot).for_each(|(t, p)| *t -= factor * p);
                target[entering] = 0.0;
            }
        }
        std::mem::replace(&mut self.basis[row], entering)
    }

    fn solution(&self) -> DVector<f64> {
        let mut z = DVector::zeros(self.n);
        for (i, &variable) in self.basis.iter().enumerate() {
            if (self.n..2 * self.n).contains(&variable) {
                z[variable - self.n] = self.rhs(i).max(0.0);
            }
        }
        z
    }
}
