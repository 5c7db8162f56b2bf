//! How far a candidate is from solving the problem, free of units.
//!
//! ```text
//!  momentum     max_k |M v − Jᵀ λ − p|_k / (√M_kk s* + 10⁻⁴ Σᵢ |Jᵢₖ λᵢ|)
//!  equality     |û| / s*
//!  unilateral   |min(ŷ, û)| / s*
//!  bounded      |ŷ − clip(ŷ − û, ±ĥ)| / s*
//! ```
//!
//! in the units of [`Metric`]. 0/0 counts as 0, and so does a defect too small for normal numbers: what
//! a sticking contact lets through gets there after some twenty steps.
//!
//! Impulses of heavy neighbours on a light body cancel to the last digit only, which no candidate can
//! avoid: hence the share of 10⁻⁴, with which a residual of 10⁻¹⁰ allows their rounding and no more.

#![expect(non_snake_case, reason = "matrices carry their names from the notes")]

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::metric::quotient;
use crate::{Law, Lcp, LcpSolution, Metric, Scratch};

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

/// Share of the impulses on a body that its momentum defect is relative to.
const ROUNDING: f64 = 1e-4;

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
        self.residual_with(metric, solution, &mut Scratch::default())
    }

    pub(crate) fn residual_with(
        &self,
        metric: &Metric,
        solution: &LcpSolution,
        scratch: &mut Scratch,
    ) -> Residual {
        let (v, impulses) = (&solution.velocities, &solution.impulses);
        assert_eq!(v.len(), self.mass.len(), "a velocity per body");
        assert_eq!(impulses.len(), self.rows.len(), "an impulse per row");
        let momentum = self.momentum_defect(metric, solution, scratch);
        let mut residual = Residual { momentum, ..Residual::default() };
        for (i, row) in self.rows.iter().enumerate() {
            let remainder = row.velocity(v) + row.compliance * impulses[i] - row.rhs;
            let (y, u) = (metric.impulse(i, impulses[i]), metric.remainder(i, remainder));
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

    fn momentum_defect(
        &self,
        metric: &Metric,
        solution: &LcpSolution,
        scratch: &mut Scratch,
    ) -> f64 {
        let mut balance = scratch.vectors.take();
        balance.extend_from_slice(&self.momentum);
        let mut acting = scratch.vectors.filled(balance.len(), Vector3::zeros());
        for (row, impulse) in self.rows.iter().zip(&solution.impulses) {
            for (body, J) in row.blocks() {
                let change = J * *impulse;
                balance[body] += change;
                acting[body] += change.abs();
            }
        }
        let mut worst = 0.0_f64;
        for (body, (m, v)) in self.mass.iter().zip(&solution.velocities).enumerate() {
            let defect = m.component_mul(v) - balance[body];
            let defect = metric.weighted_momentum(body, &defect);
            let acting = metric.weighted_momentum(body, &acting[body]);
            for k in 0..3 {
                let scale = metric.scale + ROUNDING * acting[k];
                worst = worst.max(quotient(defect[k].abs(), scale));
            }
        }
        scratch.vectors.give(balance);
        scratch.vectors.give(acting);
        worst
    }
}

/// ŷ − clip(ŷ − û, ±ĥ).
fn clip_defect(y: f64, u: f64, bound: f64) -> f64 {
    if bound.is_nan() { f64::NAN } else { y - (y - u).clamp(-bound, bound) }
}
