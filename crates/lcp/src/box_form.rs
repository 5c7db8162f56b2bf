//! The problem without its velocities: one signed unknown per row, and bounds. What interior point
//! and pivoting work on, for rows of a mechanical problem and for raw ones.
//!
//! ```text
//!  u = W y + q
//!
//!  free        u = 0
//!  positive    0 ≤ y ⟂ u ≥ 0
//!  box         u = w⁻ − w⁺,    s± = h ∓ y,    0 ≤ s± ⟂ w± ≥ 0,    h constant or μ y_n
//! ```

use crate::modes::piece;
use crate::{BandMatrix, Delassus, Law, Lcp, Metric, Mode};

/// The law of one unknown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BoxLaw {
    /// u = 0.
    Free,
    /// 0 ≤ y ⟂ u ≥ 0.
    Positive,
    /// |y| ≤ max.
    Bounded {
        /// Bound, positive.
        max: f64,
    },
    /// |y| ≤ μ y_n.
    Friction {
        /// Slot n of the normal unknown.
        normal: usize,
        /// μ, positive.
        mu: f64,
    },
}

impl BoxLaw {
    /// Of a row whose unknown is its ŷ in units of `scale`; the slots are the rows.
    pub(crate) fn of_row(problem: &Lcp, metric: &Metric, row: usize, scale: f64) -> Self {
        match problem.rows[row].law {
            Law::Equality => Self::Free,
            Law::Unilateral => Self::Positive,
            Law::Bounded { max } => Self::Bounded { max: metric.impulse(row, max) / scale },
            Law::Friction { normal, mu } => {
                let normal = normal as usize;
                let mu = mu * metric.root(row) / metric.root(normal);
                Self::Friction { normal, mu }
            }
        }
    }

    /// Bound of a box unknown, infinite for others.
    #[must_use]
    pub fn bound(self, y: &[f64]) -> f64 {
        match self {
            Self::Bounded { max } => max,
            Self::Friction { normal, mu } => mu * y[normal],
            Self::Free | Self::Positive => f64::INFINITY,
        }
    }

    /// What the law leaves over at unknowns y, of which this is `y_i`, and u_i: the natural map.
    #[must_use]
    pub fn defect(self, y_i: f64, u_i: f64, y: &[f64]) -> f64 {
        match self {
            Self::Free => u_i,
            Self::Positive => y_i.min(u_i),
            Self::Bounded { .. } | Self::Friction { .. } => {
                let bound = self.bound(y).max(0.0);
                y_i - (y_i - u_i).max(-bound).min(bound)
            }
        }
    }

    /// The mode that unknowns y and u = W y + q show for the one at `slot`: the natural map's piece.
    /// A contact that is about to close counts with the impulse that would close it alone.
    #[must_use]
    pub fn mode(self, slot: usize, y: &[f64], u: &[f64]) -> Mode {
        let ahead = y[slot] - u[slot];
        match self {
            Self::Free => Mode::Active,
            Self::Positive => {
                if ahead > 0.0 {
                    Mode::Active
                } else {
                    Mode::Open
                }
            }
            Self::Bounded { max } => piece(ahead, max),
            Self::Friction { normal, .. } if y[normal] <= u[normal] => Mode::Open,
            Self::Friction { normal, mu } => {
                piece(ahead, mu * y[normal].max(y[normal] - u[normal]).max(0.0))
            }
        }
    }

    /// Number of complementary pairs.
    #[must_use]
    pub fn pairs(self) -> usize {
        match self {
            Self::Free => 0,
            Self::Positive => 1,
            Self::Bounded { .. } | Self::Friction { .. } => 2,
        }
    }
}

/// Matrix, right-hand side and laws, scaled to numbers around one.
#[derive(Clone, Debug)]
pub struct BoxForm {
    /// W, with room for the couplings of friction and normal.
    pub matrix: BandMatrix,
    /// q.
    pub q: Vec<f64>,
    /// Laws.
    pub laws: Vec<BoxLaw>,
    /// Unknown `i` times `unscale[i]` is the impulse of row `rows[i]`.
    pub unscale: Vec<f64>,
    /// Row of the problem per unknown.
    pub rows: Vec<u32>,
}

impl BoxForm {
    /// Row i of the mixed problem, scaled: y = λ √Wᵢᵢ / s, u = u / (√Wᵢᵢ s), with s the largest
    /// |qᵢ| / √Wᵢᵢ.
    #[must_use]
    pub fn of_rows(problem: &Lcp, metric: &Metric) -> Self {
        let Delassus { rows, matrix } = Delassus::new(problem, metric);
        let free = problem.free_velocities();
        let mut q: Vec<f64> = Vec::with_capacity(rows.len());
        let mut position = vec![0; rows.len()];
        for (slot, &row) in rows.iter().enumerate() {
            let row = row as usize;
            position[row] = slot;
            let u = problem.row_velocity(row, &free) - problem.rows[row].rhs;
            q.push(metric.remainder(row, u));
        }
        let largest = q.iter().fold(0.0_f64, |largest, q| largest.max(q.abs()));
        let scale = if largest > 0.0 { largest } else { 1.0 };
        for q in &mut q {
            *q /= scale;
        }
        let law = |&row: &u32| match BoxLaw::of_row(problem, metric, row as usize, scale) {
            BoxLaw::Friction { normal, mu } => BoxLaw::Friction { normal: position[normal], mu },
            law => law,
        };
        let laws = rows.iter().map(law).collect();
        let unscale = rows.iter().map(|&row| metric.true_impulse(row as usize, scale)).collect();
        Self { matrix, q, laws, unscale, rows }
    }

    /// Number of unknowns.
    #[must_use]
    pub fn len(&self) -> usize {
        self.q.len()
    }

    /// Whether there are no unknowns.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.q.is_empty()
    }

    /// Impulses per row of the problem.
    #[must_use]
    pub fn impulses(&self, y: &[f64]) -> Vec<f64> {
        let mut impulses = vec![0.0; y.len()];
        for ((&row, unscale), y) in self.rows.iter().zip(&self.unscale).zip(y) {
            impulses[row as usize] = unscale * y;
        }
        impulses
    }

    /// u = W y + q.
    #[must_use]
    pub fn remainders(&self, y: &[f64]) -> Vec<f64> {
        let mut u = self.matrix.times(y);
        u.iter_mut().zip(&self.q).for_each(|(u, q)| *u += q);
        u
    }
}

impl BoxForm {
    /// Slots whose law is of a kind, in order.
    #[must_use]
    pub fn slots(&self, kind: impl Fn(BoxLaw) -> bool) -> Vec<usize> {
        (0..self.len()).filter(|&slot| kind(self.laws[slot])).collect()
    }

    /// Entry of W, zero outside the band.
    #[must_use]
    pub fn entry(&self, i: usize, j: usize) -> f64 {
        if self.matrix.columns(i).contains(&j) { self.matrix.get(i, j) } else { 0.0 }
    }

    /// Number of complementary pairs.
    #[must_use]
    pub fn pairs(&self) -> usize {
        self.laws.iter().map(|&law| law.pairs()).sum()
    }
}
