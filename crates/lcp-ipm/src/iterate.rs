//! The interior point's iterate.

use tangency_lcp::{BoxLaw, Scratch};

/// Unknowns y, and per row the pairs (x⁺, z⁺, x⁻, z⁻), 0 ≤ x ⟂ z ≥ 0: of a box row (s⁺, w⁺, s⁻, w⁻), of a
/// positive row (y, u, 1, 0), of a free row (1, 0, 1, 0).
#[derive(Debug)]
pub(crate) struct Iterate {
    pub(crate) y: Vec<f64>,
    pub(crate) pairs: Vec<[f64; 4]>,
}

impl Iterate {
    /// Zeros.
    pub(crate) fn zeros(len: usize, scratch: &mut Scratch) -> Self {
        Self { y: scratch.floats.filled(len, 0.0), pairs: scratch.quads.filled(len, [0.0; 4]) }
    }

    /// Gives its memory back.
    pub(crate) fn give(self, scratch: &mut Scratch) {
        scratch.floats.give(self.y);
        scratch.quads.give(self.pairs);
    }

    /// Impulses of `size`, slacks of about one.
    pub(crate) fn start(&mut self, laws: &[BoxLaw], q: &[f64], size: f64) {
        for (slot, law) in laws.iter().enumerate() {
            let u = q[slot];
            (self.y[slot], self.pairs[slot]) = match *law {
                BoxLaw::Free => (0.0, [1.0, 0.0, 1.0, 0.0]),
                BoxLaw::Positive => (size, [size, u.abs().max(1.0), 1.0, 0.0]),
                BoxLaw::Bounded { max: bound } | BoxLaw::Friction { mu: bound, .. } => {
                    let s = bound.max(0.01);
                    (0.0, [s, 1.0 + (-u).max(0.0), s, 1.0 + u.max(0.0)])
                }
            };
        }
    }

    /// Sum of the products of the pairs.
    pub(crate) fn products(&self) -> f64 {
        self.pairs.iter().fold(0.0, |sum, [x, z, s, w]| sum + x * z + s * w)
    }

    /// The same after `length` times the step.
    pub(crate) fn products_after(&self, step: &Self, length: f64) -> f64 {
        self.pairs.iter().zip(&step.pairs).fold(0.0, |sum, (pair, step)| {
            let at = |k: usize| pair[k] + length * step[k];
            sum + at(0) * at(1) + at(2) * at(3)
        })
    }

    /// The longest step up to `limit` that keeps every pair positive.
    pub(crate) fn longest(&self, step: &Self, limit: f64) -> f64 {
        // 0/0 of what is not in use is NaN, which `max` passes over.
        let mut most = [0.0_f64; 4];
        for (pair, step) in self.pairs.iter().zip(&step.pairs) {
            for k in 0..4 {
                most[k] = most[k].max(-step[k] / pair[k]);
            }
        }
        let steepest = most.into_iter().fold(0.0, f64::max);
        if steepest * limit > 1.0 { steepest.recip() } else { limit }
    }

    /// A step becomes the point that it leads to; of the pairs only.
    pub(crate) fn add(&mut self, from: &Self) {
        for (pair, from) in self.pairs.iter_mut().zip(&from.pairs) {
            for k in 0..4 {
                pair[k] += from[k];
            }
        }
    }

    /// Whether the same member of each pair is the greater in both.
    pub(crate) fn agrees(&self, other: &Self) -> bool {
        self.pairs
            .iter()
            .zip(&other.pairs)
            .all(|([x, z, s, w], [ox, oz, os, ow])| (x > z) == (ox > oz) && (s > w) == (os > ow))
    }

    /// The iterate plus `length` times the step.
    pub(crate) fn advance(&mut self, laws: &[BoxLaw], step: &Self, length: f64) {
        for (pair, step) in self.pairs.iter_mut().zip(&step.pairs) {
            for k in 0..4 {
                pair[k] += length * step[k];
            }
        }
        for (slot, law) in laws.iter().enumerate() {
            self.y[slot] = match law {
                BoxLaw::Positive => self.pairs[slot][0],
                _ => self.y[slot] + length * step.y[slot],
            };
        }
    }
}
