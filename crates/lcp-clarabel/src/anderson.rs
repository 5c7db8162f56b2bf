//! Anderson's acceleration of a fixed point s = g(s) (Walker & Ni 2011), with memory 5.
//!
//! ```text
//!  f_k = g(s_k) − s_k        min_γ |f_k − ΔF γ|        s_{k+1} = g(s_k) − (ΔS + ΔF) γ
//! ```
//!
//! A proposal further than ten plain steps away is not taken; s stays non-negative.

use nalgebra::{DMatrix, DVector};

/// Greatest number of differences that are remembered.
const MEMORY: usize = 5;
/// A proposal may be at most this many plain steps long.
const LONGEST: f64 = 10.0;

/// Remembers the last iterates.
#[derive(Debug, Default)]
pub(crate) struct Anderson {
    last: Option<(Vec<f64>, Vec<f64>)>,
    ds: Vec<Vec<f64>>,
    df: Vec<Vec<f64>>,
}

impl Anderson {
    /// The next s, from s and g(s).
    pub(crate) fn next(&mut self, s: &[f64], g: &[f64]) -> Vec<f64> {
        let f = difference(g, s);
        if let Some((last_s, last_f)) = self.last.replace((s.to_vec(), f.clone())) {
            if self.ds.len() == MEMORY {
                self.ds.remove(0);
                self.df.remove(0);
            }
            self.ds.push(difference(s, &last_s));
            self.df.push(difference(&f, &last_f));
        }
        let mut next = g.to_vec();
        for (gamma, (ds, df)) in self.weights(&f).into_iter().zip(self.ds.iter().zip(&self.df)) {
            for (next, (ds, df)) in next.iter_mut().zip(ds.iter().zip(df)) {
                *next -= gamma * (ds + df);
            }
        }
        let (step, plain) = (norm(&difference(&next, s)), norm(&f));
        if !step.is_finite() || step > LONGEST * plain {
            next = g.to_vec();
        }
        next.iter().map(|x| x.max(0.0)).collect()
    }

    /// Least squares by the normal equations with a small ridge; at most five unknowns.
    fn weights(&self, f: &[f64]) -> Vec<f64> {
        let m = self.df.len();
        let ridge = |i: usize, j: usize| if i == j { 1.0 + 1e-12 } else { 1.0 };
        let normal = DMatrix::from_fn(m, m, |i, j| dot(&self.df[i], &self.df[j]) * ridge(i, j));
        let right = DVector::from_fn(m, |i, _| dot(&self.df[i], f));
        normal.cholesky().map_or_else(Vec::new, |c| c.solve(&right).as_slice().to_vec())
    }
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// s = A s + c with spectral radius 0.8: the plain iteration needs about a hundred steps.
    #[test]
    fn a_linear_fixed_point_of_three_unknowns_is_found_in_a_few_steps() {
        let g = |s: &[f64]| {
            vec![0.8 * s[0] + 0.1 * s[1] + 0.1, 0.5 * s[1] + 0.2 * s[2] + 1.0, 0.3 * s[2] + 0.7]
        };
        // s₂ = 1, s₁ = 2.4, s₀ = 1.7
        let (mut anderson, mut s) = (Anderson::default(), vec![0.0; 3]);
        for _ in 0..8 {
            s = anderson.next(&s, &g(&s));
        }
        assert!(norm(&difference(&s, &[1.7, 2.4, 1.0])) < 1e-9, "{s:?}");
    }
}
