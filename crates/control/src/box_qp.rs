//! A quadratic within a box, by projected Newton steps.
//!
//! ```text
//!  minimise ½ dᵀ H d + gᵀ d     lower ≤ d ≤ upper
//!
//!  clamped   dᵢ at a limit and the slope ∇ = g + H d points out of the box      free: all others
//!  d_f ← d_f − H_ff⁻¹ ∇_f, clamped, shortened until it pays
//! ```
//!
//! Bertsekas 1982; Tassa, Mansard & Todorov 2014, algorithm 1. A full step that leaves the clamped set
//! as it was ends at the solution itself.

#![expect(non_snake_case, reason = "matrices carry their names from the paper")]

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use crate::ControlLimits;

const MAX_STEPS: usize = 100;
/// Part of the promised decrease that a step must bring.
const ARMIJO: f64 = 0.1;
const SHORTEN: f64 = 0.6;
const SHORTEST: f64 = 1e-12;

/// A quadratic within a box.
#[derive(Clone, Debug)]
pub struct BoxQp<'a> {
    /// H, m × m, symmetric.
    pub hessian: &'a DMatrix<f64>,
    /// g, m.
    pub gradient: &'a DVector<f64>,
    /// The box.
    pub limits: &'a ControlLimits,
}

/// Where it is least.
#[derive(Clone, Debug)]
pub struct BoxQpSolution {
    /// d, m.
    pub minimum: DVector<f64>,
    /// The indices that are free to move.
    pub free: Vec<usize>,
    /// Of `H_ff`.
    factor: Option<Cholesky<f64, Dyn>>,
}

impl BoxQp<'_> {
    /// The minimum, sought from `start`; `None` if H is not positive definite on what is free, or its
    /// numbers are not finite.
    #[must_use]
    pub fn solve(&self, start: &DVector<f64>) -> Option<BoxQpSolution> {
        let mut d = self.limits.clamp(start);
        let mut found = self.at(&d)?;
        for _ in 0..MAX_STEPS {
            let Some(newton) = found.newton(&self.slope(&d)) else { break };
            let Some(next) = self.search(&d, &newton) else { break };
            let whole = next == &d + &newton;
            d = next;
            let before = std::mem::replace(&mut found, self.at(&d)?);
            if whole && found.free == before.free {
                break;
            }
        }
        found.minimum = d;
        found.minimum.iter().all(|d| d.is_finite()).then_some(found)
    }

    fn value(&self, d: &DVector<f64>) -> f64 {
        0.5 * d.dot(&(self.hessian * d)) + d.dot(self.gradient)
    }

    fn slope(&self, d: &DVector<f64>) -> DVector<f64> {
        self.gradient + self.hessian * d
    }

    /// What is free at d, and its factored Hessian.
    fn at(&self, d: &DVector<f64>) -> Option<BoxQpSolution> {
        let (slope, lower, upper) = (self.slope(d), self.limits.lower(), self.limits.upper());
        let free = |i: &usize| {
            let (d, slope) = (d[*i], slope[*i]);
            !(d == lower[*i] && slope > 0.0 || d == upper[*i] && slope < 0.0)
        };
        let free: Vec<usize> = (0..d.len()).filter(free).collect();
        let factor = if free.is_empty() {
            None
        } else {
            let H_ff = self.hessian.select_rows(&free).select_columns(&free);
            Some(Cholesky::new(H_ff)?)
        };
        Some(BoxQpSolution { minimum: d.clone(), free, factor })
    }

    /// The step along `newton` that pays, clamped; `None` if none does: d is the minimum to rounding.
    ///
    /// What a step must bring is measured by how far it goes once clamped, −∇ᵀ(d⁺ − d): a step that a
    /// near limit cuts short cannot bring what all of it promised.
    fn search(&self, d: &DVector<f64>, newton: &DVector<f64>) -> Option<DVector<f64>> {
        let (value, slope) = (self.value(d), self.slope(d));
        let mut length = 1.0;
        while newton.dot(&slope) < 0.0 && length > SHORTEST {
            let next = self.limits.clamp(&(d + newton * length));
            let promised = slope.dot(&(d - &next));
            if promised > 0.0 && value - self.value(&next) >= ARMIJO * promised {
                return Some(next);
            }
            length *= SHORTEN;
        }
        None
    }
}

impl BoxQpSolution {
    /// −H_ff⁻¹ ∇_f, zero elsewhere; `None` if nothing is free.
    fn newton(&self, slope: &DVector<f64>) -> Option<DVector<f64>> {
        let step = self.factor.as_ref()?.solve(&slope.select_rows(&self.free));
        let mut all = DVector::zeros(slope.len());
        self.free.iter().zip(&step).for_each(|(i, d)| all[*i] = -d);
        Some(all)
    }

    /// −H_ff⁻¹ G_f: how the minimum moves with a gradient G x, m × n; zero in what is not free.
    #[must_use]
    pub fn sensitivity(&self, G: &DMatrix<f64>) -> DMatrix<f64> {
        let mut all = DMatrix::zeros(G.nrows(), G.ncols());
        if let Some(factor) = &self.factor {
            let moved = factor.solve(&G.select_rows(&self.free));
            for (row, i) in moved.row_iter().zip(&self.free) {
                all.row_mut(*i).copy_from(&(-row));
            }
        }
        all
    }
}
