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
pub(crate) const ROUNDING: f64 = 1e-4;

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
        let mut slacks = scratch.floats.take();
        let (v, impulses) = (&solution.velocities, &solution.impulses);
        let residual = self.assess(metric, v, impulses, &mut slacks, scratch);
        scratch.floats.give(slacks);
        residual
    }

    /// The residual of velocities and impulses, and the remainder of every row.
    pub(crate) fn assess(
        &self,
        metric: &Metric,
        v: &[Vector3<f64>],
        impulses: &[f64],
        slacks: &mut Vec<f64>,
        scratch: &mut Scratch,
    ) -> Residual {
        assert_eq!(v.len(), self.mass.len(), "a velocity per body");
        assert_eq!(impulses.len(), self.rows.len(), "an impulse per row");
        slacks.clear();
        let momentum = self.momentum_defect(metric, v, impulses, scratch);
        let mut residual = Residual { momentum, ..Residual::default() };
        for (i, row) in self.rows.iter().enumerate() {
            let remainder = row.velocity(v) + row.compliance * impulses[i] - row.rhs;
            slacks.push(remainder);
            let u = metric.remainder(i, remainder);
            let (part, defect) = match row.law {
                Law::Equality => (&mut residual.equality, u),
                Law::Unilateral => {
                    let y = metric.impulse(i, impulses[i]);
                    (&mut residual.unilateral, if y.is_nan() { y } else { y.min(u) })
                }
                Law::Bounded { .. } => {
                    (&mut residual.bounded, self.clip_defect(metric, i, u, impulses))
                }
                Law::Friction { .. } => {
                    (&mut residual.friction, self.clip_defect(metric, i, u, impulses))
                }
            };
            // The greatest, and NaN once there is one.
            let defect = if u.is_nan() { u } else { defect.abs() };
            *part = if defect > *part || defect.is_nan() { defect } else { *part };
        }
        for part in [
            &mut residual.equality,
            &mut residual.unilateral,
            &mut residual.bounded,
            &mut residual.friction,
        ] {
            *part = metric.relative(*part);
        }
        residual
    }

    fn clip_defect(&self, metric: &Metric, row: usize, u: f64, impulses: &[f64]) -> f64 {
        let y = metric.impulse(row, impulses[row]);
        clip_defect(y, u, metric.bound(self.rows[row].law, row, impulses))
    }

    fn momentum_defect(
        &self,
        metric: &Metric,
        v: &[Vector3<f64>],
        impulses: &[f64],
        scratch: &mut Scratch,
    ) -> f64 {
        let mut balance = scratch.vectors.take();
        balance.extend_from_slice(&self.momentum);
        balance.push(Vector3::zeros());
        let mut acting = scratch.vectors.filled(balance.len(), Vector3::zeros());
        for ((row, weighted), impulse) in self.rows.iter().zip(&metric.equations.rows).zip(impulses)
        {
            for (body, J) in weighted.bodies.into_iter().zip(&row.jacobian) {
                let change = J * *impulse;
                balance[body as usize] += change;
                acting[body as usize] += change.abs();
            }
        }
        let mut worst = 0.0_f64;
        for (body, (m, v)) in self.mass.iter().zip(v).enumerate() {
            let defect = metric.weighted_momentum(body, &(m.component_mul(v) - balance[body]));
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
