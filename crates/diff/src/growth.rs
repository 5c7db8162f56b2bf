//! How much an adjoint grows on its way back.
//!
//! ```text
//!  |x̄|² = T² Σ q̄ᵢᵀ Mᵢ⁻¹ q̄ᵢ + Σ v̄ᵢᵀ Mᵢ⁻¹ v̄ᵢ         dynamic bodies; T: how long the run lasts
//!
//!  growth_k = |x̄_k| / Σ_{j ≥ k} |∂L/∂x_j|
//! ```
//!
//! A change of velocity counts for what it does in the time T. The growth at state k has no unit, is 1
//! where nothing happens, and is never more than the most that a change of state k is amplified by any
//! later state.

use tangency_core::Scene;

use crate::vector::StateVector;

/// The norms of an adjoint that goes back, and of what was added to it.
#[derive(Debug)]
pub(crate) struct Growth {
    /// T, s.
    span: f64,
    /// Σ |∂L/∂x_j| of the states so far.
    seeded: f64,
    /// |x̄| at the state before.
    norm: f64,
    /// What is measured without copies: x̄ before a seed is added.
    before: StateVector,
}

impl Growth {
    /// Of a run of so many steps.
    pub(crate) fn new(scene: &Scene, steps: usize) -> Self {
        let span = scene.dt() * steps.max(1) as f64;
        Self { span, seeded: 0.0, norm: 0.0, before: StateVector::default() }
    }

    /// Remembers x̄ before ∂L/∂x is added.
    pub(crate) fn hold(&mut self, bar: &StateVector) {
        self.before.clone_from(bar);
    }

    /// The growth at a state whose ∂L/∂x is now in `bar`. What impulses of the step after it added
    /// (`by_impulses`) is not known by itself: all by which the adjoint grew in that step counts as theirs.
    pub(crate) fn measure(&mut self, scene: &Scene, bar: &StateVector, by_impulses: bool) -> f64 {
        if by_impulses {
            self.seeded += (self.norm(scene, &self.before) - self.norm).max(0.0);
        }
        self.before.add_scaled(-1.0, bar);
        self.seeded += self.norm(scene, &self.before);
        self.norm = self.norm(scene, bar);
        if self.norm == 0.0 { 0.0 } else { self.norm / self.seeded }
    }

    fn norm(&self, scene: &Scene, bar: &StateVector) -> f64 {
        let of = |i: usize| {
            let mass = &scene.bodies()[i].mass;
            let (q, v) = (bar.q[i] * self.span, bar.v[i]);
            q.dot(&q.component_div(mass)) + v.dot(&v.component_div(mass))
        };
        let dynamic = (0..bar.q.len()).filter(|i| scene.is_dynamic(*i));
        dynamic.map(of).sum::<f64>().sqrt()
    }
}
