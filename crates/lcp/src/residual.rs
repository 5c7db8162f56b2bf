//! How far a candidate is from solving the problem, free of units.
//!
//! ```text
//!  Wᵢᵢ = Jᵢ M⁻¹ Jᵢᵀ + cᵢ       ŷᵢ = λᵢ √Wᵢᵢ       ûᵢ = uᵢ / √Wᵢᵢ       ĥᵢ = hᵢ √Wᵢᵢ      √J each
//!  s* = max( max_k |p_k|/√M_kk , max_i |bᵢ|/√Wᵢᵢ )
//!
//!  momentum     max_k |M v − Jᵀ λ − p|_k / (√M_kk s* + 10⁻⁴ Σᵢ |Jᵢₖ λᵢ|)
//!  equality     |û| / s*
//!  unilateral   |min(ŷ, û)| / s*
//!  bounded      |ŷ − clip(ŷ − û, ±ĥ)| / s*
//! ```
//!
//! ŷ, û and s* are square roots of energies: the quotients do not change with the units of length,
//! mass or time, and no mass ratio weighs them. 0/0 counts as 0, and so does a defect too small for
//! normal numbers: what a sticking contact lets through gets there after some twenty steps.
//!
//! Masses are counted in the largest power of two that the greatest of them reaches, μ: a mass M is
//! M/μ, an impulse λ/μ, a weight μ Wᵢᵢ. Nothing else would make the square roots the same to the last
//! bit when the unit of mass changes by an odd power of two.
//!
//! Impulses of heavy neighbours on a light body cancel to the last digit only, which no candidate can
//! avoid: hence the share of 10⁻⁴, with which a residual of 10⁻¹⁰ allows their rounding and no more.

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
    /// √(μ Wᵢᵢ) per row.
    root: Vec<f64>,
    /// μ, the unit of mass.
    unit: f64,
    /// s*, the problem's own scale.
    pub scale: f64,
}

/// Share of the impulses on a body that its momentum defect is relative to.
const ROUNDING: f64 = 1e-4;

impl Metric {
    /// The metric of `problem`.
    #[must_use]
    pub fn new(problem: &Lcp) -> Self {
        let unit = power_of_two(problem.mass.iter().fold(0.0, |most: f64, m| most.max(m.x)));
        let root = |row| (problem.row_weight(row) * unit).sqrt();
        let root: Vec<f64> = (0..problem.rows.len()).map(root).collect();
        let mut metric = Self { root, unit, scale: 0.0 };
        for (p, m) in problem.momentum.iter().zip(&problem.mass) {
            for k in 0..3 {
                metric.scale = metric.scale.max(metric.momentum(p[k], m[k]).abs());
            }
        }
        for (row, b) in problem.rows.iter().enumerate() {
            metric.scale = metric.scale.max(metric.remainder(row, b.rhs).abs());
        }
        metric
    }

    /// √(μ Wᵢᵢ) of a row.
    #[must_use]
    pub fn root(&self, row: usize) -> f64 {
        self.root[row]
    }

    /// μ, the unit of mass, kg.
    #[must_use]
    pub fn unit(&self) -> f64 {
        self.unit
    }

    /// ŷ of a row's impulse.
    #[must_use]
    pub fn impulse(&self, row: usize, impulse: f64) -> f64 {
        impulse * self.root[row] / self.unit
    }

    /// The impulse of a row's ŷ, N·s or N·m·s.
    #[must_use]
    pub fn true_impulse(&self, row: usize, impulse: f64) -> f64 {
        impulse * self.unit / self.root[row]
    }

    /// û of a row's remainder.
    #[must_use]
    pub fn remainder(&self, row: usize, remainder: f64) -> f64 {
        remainder / self.root[row]
    }

    /// p/√M of one coordinate.
    #[must_use]
    pub fn momentum(&self, momentum: f64, mass: f64) -> f64 {
        momentum / (self.unit * mass).sqrt()
    }

    /// The velocity of one coordinate from √M v, m/s or rad/s.
    #[must_use]
    pub fn true_velocity(&self, velocity: f64, mass: f64) -> f64 {
        velocity * self.unit / (self.unit * mass).sqrt()
    }

    /// A defect divided by the scale; NaN counts as infinite, 0/0 as 0.
    pub(crate) fn relative(&self, defect: f64) -> f64 {
        quotient(defect, self.scale)
    }

    /// The bound ĥ of a bounded or friction row, from the impulses as they are.
    pub(crate) fn bound(&self, law: Law, row: usize, impulses: &[f64]) -> f64 {
        match law {
            Law::Bounded { max } => self.impulse(row, max),
            Law::Friction { normal, mu } => {
                self.impulse(row, mu * impulses[normal as usize].max(0.0))
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
                let defect = metric.momentum(m[k] * v[k] - balance[body][k], m[k]).abs();
                let acting = metric.momentum(impulses[body][k], m[k]);
                worst = worst.max(quotient(defect, metric.scale + ROUNDING * acting));
            }
        }
        worst
    }
}

/// The largest power of two up to a positive number; 1 where there is none.
fn power_of_two(x: f64) -> f64 {
    let exponent = f64::from_bits(x.to_bits() & f64::INFINITY.to_bits());
    if exponent.is_normal() { exponent } else { 1.0 }
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
