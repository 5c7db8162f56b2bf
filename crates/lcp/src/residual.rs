//! How far a candidate is from solving the problem, free of units.
//!
//! ```text
//!  Wᵢᵢ = Jᵢ M⁻¹ Jᵢᵀ + cᵢ       ŷᵢ = λᵢ √Wᵢᵢ       ûᵢ = uᵢ / √Wᵢᵢ       ĥᵢ = hᵢ √Wᵢᵢ      √(N·m·s⁻¹·s) each
//!  s* = max( max_k |p_k|/√M_kk , max_i |bᵢ|/√Wᵢᵢ )
//!
//!  momentum     max_k |M v − Jᵀ λ − p|_k / (√M_kk s* + Σᵢ |Jᵢₖ λᵢ|)
//!  equality     |û| / s*
//!  unilateral   |min(ŷ, û)| / s*
//!  bounded      |ŷ − clip(ŷ − û, ±ĥ)| / s*
//! ```
//!
//! ŷ, û and s* are square roots of energies: the quotients do not change with the units of length,
//! mass or time, and no mass ratio weighs them. 0/0 counts as 0, and so does a defect too small for
//! normal numbers: what a sticking contact lets through gets there after some twenty steps.
//!
//! A momentum defect is relative to the impulses that act on the body, too: between two heavy
//! bodies, impulses on a light one cancel to the last digit only, which no candidate can avoid.

#![expect(non_snake_case, reason = "matrices carry their names from the notes")]

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::{Law, Lcp, LcpSolution};

/// The natural residual, part by part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Residual {
    /// Momentum balance.
    pub momentum: f64,
    /// Equality rows.
    pub equality: f64,
    /// Unilateral rows.
    pub unilateral: f64,
    /// Bounded rows.
    pub bounded: f64,
    /// Friction rows.
    pub friction: f64,
}

impl Residual {
    /// The greatest part; the figure that decides.
    #[must_use]
    pub fn max(&self) -> f64 {
        [self.momentum, self.equality, self.unilateral, self.bounded, self.friction]
            .into_iter()
            .fold(0.0, f64::max)
    }
}

/// The mass-weighted units of one problem: computed once, used by every residual and mode reading.
#[derive(Clone, Debug)]
pub struct Metric {
    /// √Wᵢᵢ per row.
    pub root: Vec<f64>,
    /// s*, the problem's own scale.
    pub scale: f64,
}

impl Metric {
    /// The metric of `problem`.
    #[must_use]
    pub fn new(problem: &Lcp) -> Self {
        let root: Vec<f64> =
            (0..problem.rows.len()).map(|row| problem.row_weight(row).sqrt()).collect();
        let mut scale = 0.0_f64;
        for (p, m) in problem.momentum.iter().zip(&problem.mass) {
            for k in 0..3 {
                scale = scale.max(p[k].abs() / m[k].sqrt());
            }
        }
        for (row, root) in problem.rows.iter().zip(&root) {
            scale = scale.max(row.rhs.abs() / root);
        }
        Self { root, scale }
    }

    /// A defect divided by the scale; NaN counts as infinite, 0/0 as 0.
    pub(crate) fn relative(&self, defect: f64) -> f64 {
        quotient(defect, self.scale)
    }

    /// The bound ĥ of a bounded or friction row, from the impulses as they are.
    pub(crate) fn bound(&self, law: Law, row: usize, impulses: &[f64]) -> f64 {
        match law {
            Law::Bounded { max } => max * self.root[row],
            Law::Friction { normal, mu } => {
                mu * impulses[normal as usize].max(0.0) * self.root[row]
            }
            Law::Equality | Law::Unilateral => f64::INFINITY,
        }
    }
}

impl Lcp {
    /// Natural residual of a candidate. Uses its velocities and impulses only: slacks and modes are
    /// not trusted.
    ///
    /// # Panics
    /// If the candidate's lists are not as long as the problem's.
    #[must_use]
    pub fn residual(&self, solution: &LcpSolution) -> Residual {
        self.residual_in(&Metric::new(self), solution)
    }

    /// The same with the metric at hand.
    ///
    /// # Panics
    /// If the candidate's lists are not as long as the problem's.
    #[must_use]
    pub fn residual_in(&self, metric: &Metric, solution: &LcpSolution) -> Residual {
        let (v, impulses) = (&solution.velocities, &solution.impulses);
        assert_eq!(v.len(), self.mass.len(), "a velocity per body");
        assert_eq!(impulses.len(), self.rows.len(), "an impulse per row");
        let mut residual =
            Residual { momentum: self.momentum_defect(metric, solution), ..Residual::default() };
        for (i, row) in self.rows.iter().enumerate() {
            let remainder = row.velocity(v) + row.compliance * impulses[i] - row.rhs;
            let (y, u) = (impulses[i] * metric.root[i], remainder / metric.root[i]);
            let (part, defect) = match row.law {
                Law::Equality => (&mut residual.equality, u),
                Law::Unilateral => (&mut residual.unilateral, y.min(u)),
                Law::Bounded { .. } => {
                    (&mut residual.bounded, clip_defect(y, u, metric.bound(row.law, i, impulses)))
                }
                Law::Friction { .. } => {
                    (&mut residual.friction, clip_defect(y, u, metric.bound(row.law, i, impulses)))
                }
            };
            let unfit = u.is_nan() || y.is_nan();
            *part = part.max(metric.relative(if unfit { f64::NAN } else { defect.abs() }));
        }
        residual
    }

    fn momentum_defect(&self, metric: &Metric, solution: &LcpSolution) -> f64 {
        let mut balance = self.momentum.clone();
        let mut impulses = vec![Vector3::zeros(); balance.len()];
        for (row, impulse) in self.rows.iter().zip(&solution.impulses) {
            for (body, J) in row.blocks() {
                balance[body] += J * *impulse;
                impulses[body] += (J * *impulse).abs();
            }
        }
        let mut worst = 0.0_f64;
        for (body, (m, v)) in self.mass.iter().zip(&solution.velocities).enumerate() {
            for k in 0..3 {
                let root = m[k].sqrt();
                let defect = (m[k] * v[k] - balance[body][k]).abs() / root;
                worst = worst.max(quotient(defect, metric.scale + impulses[body][k] / root));
            }
        }
        worst
    }
}

/// Defect over scale; NaN counts as infinite, 0/0 and what is too small for normal numbers as 0.
fn quotient(defect: f64, scale: f64) -> f64 {
    if defect < f64::MIN_POSITIVE {
        0.0
    } else if defect.is_finite() {
        defect / scale
    } else {
        f64::INFINITY
    }
}

/// ŷ − clip(ŷ − û, ±ĥ).
fn clip_defect(y: f64, u: f64, bound: f64) -> f64 {
    if bound.is_nan() { f64::NAN } else { y - (y - u).clamp(-bound, bound) }
}
