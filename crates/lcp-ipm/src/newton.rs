//! Newton's equations at an iterate, and their solution.
//!
//! Eliminating the pairs leaves one equation per row. With d± = w±/s±, a target t for the products and
//! the second-order terms o = Δx Δz of the predictor,
//!
//! ```text
//!  positive    (W Δy)ᵢ + (z/y) Δyᵢ                           = −uᵢ + (t − o)/y
//!  box         (W Δy)ᵢ + (d⁺ + d⁻) Δyᵢ + μ (d⁻ − d⁺) Δy_n    = −uᵢ − (t − o⁺)/s⁺ + (t − o⁻)/s⁻ + d⁺ r⁺ − d⁻ r⁻
//!  free        (W Δy)ᵢ                                       = −uᵢ
//! ```
//!
//! where u = W y + q and r± = h ∓ y − s±. Only the coupling of friction to its normal makes the
//! matrix non-symmetric.

use tangency_lcp::{Added, BoxLaw, Scratch};

use crate::iterate::Iterate;
use crate::system::System;

/// Right-hand side and matrix; kept from iteration to iteration for their memory.
#[derive(Debug)]
pub(crate) struct Newton {
    /// (1/x⁺, d⁺, 1/x⁻, d⁻) per row.
    quotients: Vec<[f64; 4]>,
    /// d⁺ + d⁻.
    diagonal: Vec<f64>,
    /// μ (d⁻ − d⁺).
    coupling: Vec<f64>,
    rhs: Vec<f64>,
}

impl Newton {
    pub(crate) fn new(len: usize, scratch: &mut Scratch) -> Self {
        Self {
            quotients: scratch.quads.filled(len, [0.0; 4]),
            diagonal: scratch.floats.filled(len, 0.0),
            coupling: scratch.floats.filled(len, 0.0),
            rhs: scratch.floats.filled(len, 0.0),
        }
    }

    /// Gives its memory back.
    pub(crate) fn give(self, scratch: &mut Scratch) {
        scratch.quads.give(self.quotients);
        for floats in [self.diagonal, self.coupling, self.rhs] {
            scratch.floats.give(floats);
        }
    }

    /// Factors the matrix at an iterate.
    pub(crate) fn factor<S: System>(
        &mut self,
        system: &mut S,
        at: &Iterate,
        scratch: &mut Scratch,
    ) {
        for (slot, law) in system.laws().iter().enumerate() {
            let [x, z, s, w] = at.pairs[slot];
            let (x, s) = (x.recip(), s.recip());
            let (plus, minus) = (z * x, w * s);
            self.quotients[slot] = [x, plus, s, minus];
            self.diagonal[slot] = plus + minus;
            self.coupling[slot] = match law {
                BoxLaw::Friction { mu, .. } => mu * (minus - plus),
                _ => 0.0,
            };
        }
        system.factor(self.added(), scratch);
    }

    /// The step towards products `target`, with the second-order terms of `predictor` if given; false
    /// if the equations could not be solved.
    pub(crate) fn step<S: System>(
        &mut self,
        system: &mut S,
        (at, u): (&Iterate, &[f64]),
        target: f64,
        predictor: Option<&Iterate>,
        step: &mut Iterate,
    ) -> bool {
        self.ask(target, predictor, &mut step.pairs);
        for (slot, law) in system.laws().iter().enumerate() {
            let [_, plus, _, minus] = self.quotients[slot];
            let [_, to, _, from] = step.pairs[slot];
            self.rhs[slot] = match law {
                BoxLaw::Free => -u[slot],
                BoxLaw::Positive => to - u[slot],
                BoxLaw::Bounded { .. } | BoxLaw::Friction { .. } => {
                    let (bound, y, [x, _, s, _]) = (law.bound(&at.y), at.y[slot], at.pairs[slot]);
                    from - to - u[slot] + plus * (bound - y - x) - minus * (bound + y - s)
                }
            };
        }
        let solved = system.solve(self.added(), &self.rhs, &mut step.y);
        self.complete(system.laws(), at, step);
        solved
    }

    fn added(&self) -> Added<'_> {
        Added { d: &self.diagonal, e: &self.coupling }
    }

    /// Puts (t − o)/x in the place of Δz.
    fn ask(&self, target: f64, predictor: Option<&Iterate>, steps: &mut [[f64; 4]]) {
        for (slot, (step, quotients)) in steps.iter_mut().zip(&self.quotients).enumerate() {
            let [x, z, s, w] = predictor.map_or([0.0; 4], |predictor| predictor.pairs[slot]);
            step[1] = (target - x * z) * quotients[0];
            step[3] = (target - s * w) * quotients[2];
        }
    }

    /// The steps of the pairs: Δz = (t − o)/x − z − (z/x) Δx.
    fn complete(&self, laws: &[BoxLaw], at: &Iterate, step: &mut Iterate) {
        for (slot, law) in laws.iter().enumerate() {
            let ([x, z, s, w], [_, plus, _, minus]) = (at.pairs[slot], self.quotients[slot]);
            let ([_, to, _, from], dy) = (step.pairs[slot], step.y[slot]);
            step.pairs[slot] = match law {
                BoxLaw::Free => [0.0; 4],
                BoxLaw::Positive => [dy, to - z - plus * dy, 0.0, 0.0],
                BoxLaw::Bounded { .. } | BoxLaw::Friction { .. } => {
                    let y = at.y[slot] + dy;
                    let bound = match law {
                        BoxLaw::Friction { normal, mu } => mu * (at.y[*normal] + step.y[*normal]),
                        law => law.bound(&at.y),
                    };
                    let (dx, ds) = (bound - y - x, bound + y - s);
                    [dx, to - z - plus * dx, ds, from - w - minus * ds]
                }
            };
        }
    }
}
