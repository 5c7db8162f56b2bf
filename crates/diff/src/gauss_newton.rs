//! Gauss–Newton products over a rollout: for a residual r(x₀ … x_T) of its states, the change of r
//! along a direction, its transpose, and both together, without ever forming the matrix.
//!
//! ```text
//!  J = ∂r/∂(x₀, u, scene)      rᵢ sees x_k through the seed ∂rᵢ/∂x_k
//!
//!  J d    forward mode along d, one run for all entries of r
//!  Jᵀ w   reverse mode seeded with Σᵢ wᵢ ∂rᵢ/∂x_k, one run for all entries of r
//!  JᵀJ d  one of each: the Hessian of ½ |r|² without second derivatives
//! ```

use tangency_core::{Rollout, Scene, State};

use crate::error::DiffError;
use crate::rollout::{Gradient, gradient_adding, tangent};
use crate::sizes;
use crate::vector::{RolloutVector, StateVector};

/// How one entry of a residual depends on one state of a rollout.
#[derive(Clone, Debug, PartialEq)]
pub struct ResidualSeed {
    /// Which entry.
    pub entry: usize,
    /// Which state, 0 for the initial one.
    pub step: usize,
    /// ∂r_entry/∂x_step.
    pub gradient: StateVector,
}

/// The Jacobian of a residual over a rollout, as products with it.
#[derive(Clone, Debug)]
pub struct GaussNewton<'a> {
    scene: &'a Scene,
    rollout: &'a Rollout,
    entries: usize,
    /// By step.
    seeds: Vec<ResidualSeed>,
}

impl<'a> GaussNewton<'a> {
    /// Of a residual with so many entries. An entry may have seeds at any number of states, those it
    /// has none at do not matter to it.
    ///
    /// # Errors
    /// [`DiffError::Size`] or [`DiffError::NotFinite`] where the rollout or a seed does not fit the
    /// scene, or [`DiffError::Index`] where a seed names an entry or a state that there is not.
    pub fn new(
        scene: &'a Scene,
        rollout: &'a Rollout,
        entries: usize,
        mut seeds: Vec<ResidualSeed>,
    ) -> Result<Self, DiffError> {
        sizes::rollout(scene, rollout)?;
        for seed in &seeds {
            sizes::index("the entry of a seed", entries, seed.entry)?;
            sizes::index("the step of a seed", rollout.records.len() + 1, seed.step)?;
            sizes::state_vector("the seed of a residual", scene, &seed.gradient)?;
        }
        seeds.sort_by_key(|seed| seed.step);
        Ok(Self { scene, rollout, entries, seeds })
    }

    /// J d, one number per entry of the residual.
    ///
    /// # Errors
    /// As [`tangent`].
    pub fn push(&self, along: &RolloutVector) -> Result<Vec<f64>, DiffError> {
        let changes = tangent(self.scene, self.rollout, along)?;
        let mut change = vec![0.0; self.entries];
        for seed in &self.seeds {
            change[seed.entry] += seed.gradient.dot(&changes[seed.step]);
        }
        Ok(change)
    }

    /// Jᵀ w, for one weight per entry of the residual; with w = r the gradient of ½ |r|².
    ///
    /// # Errors
    /// [`DiffError::Size`] for another number of weights, and as
    /// [`gradient`](crate::gradient()).
    pub fn pull(&self, weights: &[f64]) -> Result<Gradient, DiffError> {
        sizes::length("the weights of a residual", self.entries, weights.len())?;
        sizes::finite("the weights of a residual", weights.iter().all(|w| w.is_finite()))?;
        gradient_adding(self.scene, self.rollout, |step, _: &State, bar| {
            for seed in self.at(step) {
                bar.add_scaled(weights[seed.entry], &seed.gradient);
            }
        })
    }

    /// JᵀJ d.
    ///
    /// # Errors
    /// As [`push`](Self::push) and [`pull`](Self::pull).
    pub fn product(&self, along: &RolloutVector) -> Result<RolloutVector, DiffError> {
        Ok(self.pull(&self.push(along)?)?.by)
    }

    /// The seeds at one state.
    fn at(&self, step: usize) -> &[ResidualSeed] {
        let first = self.seeds.partition_point(|seed| seed.step < step);
        let end = self.seeds.partition_point(|seed| seed.step <= step);
        &self.seeds[first..end]
    }
}
