//! A run and its derivatives along directions that move several numbers of a scene at once.

use tangency_core::{Param, Rollout, Scene, State, StepRecord};
use tangency_diff::{DiffError, Gradient, RolloutVector, StateVector, gradient, tangent};

/// Numbers of a scene and the rates at which they change.
pub type Direction<'a> = &'a [(Param, f64)];

/// What a derivative is by, how that changes the scene, and what it should be.
pub(crate) type Slope<'a> = (&'a str, Direction<'a>, f64);

/// A scene and its rollout.
#[derive(Clone, Debug)]
pub struct Run {
    /// The scene.
    pub scene: Scene,
    /// What it did.
    pub tape: Rollout,
}

impl Run {
    /// The state at the end.
    #[must_use]
    pub fn last(&self) -> &State {
        self.tape.last()
    }

    /// The record of the last step.
    ///
    /// # Panics
    /// If the run has no steps.
    #[must_use]
    pub fn end(&self) -> &StepRecord {
        self.tape.records.last().expect("a run has steps")
    }

    /// Everything that the run consists of, in the order of time: steps, or the parts of those that events
    /// divide.
    #[must_use]
    pub fn parts(&self) -> impl DoubleEndedIterator<Item = &StepRecord> {
        self.tape.records.iter().flat_map(|record| record.parts.iter().chain([record]))
    }

    /// The initial state and those at the ends of all parts.
    pub fn moments(&self) -> impl Iterator<Item = &State> {
        std::iter::once(&self.tape.initial).chain(self.parts().map(|part| &part.after))
    }

    /// State at a time, rounded to whole steps.
    #[must_use]
    pub fn at(&self, time: f64) -> &State {
        self.tape.state(crate::lab::steps(time, self.scene.dt()))
    }

    /// The first step after which a state satisfies `holds`.
    #[must_use]
    pub fn first(&self, holds: impl FnMut(&State) -> bool) -> Option<usize> {
        self.tape.states().position(holds)
    }

    /// Times at which a quantity changes sign, between two states in proportion, s.
    #[must_use]
    pub fn crossings(&self, quantity: impl Fn(&State) -> f64) -> Vec<f64> {
        let points: Vec<_> = self.tape.states().map(|s| (s.time, quantity(s))).collect();
        let changes = points.windows(2).filter(|p| p[0].1 != 0.0 && p[0].1 * p[1].1 <= 0.0);
        changes.map(|p| p[0].0 + (p[1].0 - p[0].0) * p[0].1 / (p[0].1 - p[1].1)).collect()
    }

    /// The worst of a quantity over all states; NaN if it is that anywhere.
    #[must_use]
    pub fn worst(&self, quantity: impl FnMut(&State) -> f64) -> f64 {
        self.tape
            .states()
            .map(quantity)
            .fold(0.0, |worst: f64, x| if x > worst || x.is_nan() { x } else { worst })
    }

    /// The coefficients that pick one number of the last state.
    #[must_use]
    pub fn pick(&self, write: impl FnOnce(&mut StateVector)) -> StateVector {
        let mut seed = StateVector::zeros(self.scene.bodies().len());
        write(&mut seed);
        seed
    }

    /// The gradient of a linear function of the last state, given by its coefficients.
    ///
    /// # Errors
    /// [`DiffError`] where a step has no derivative.
    pub fn gradient(&self, seed: &StateVector) -> Result<Gradient, DiffError> {
        let last = self.tape.records.len();
        gradient(&self.scene, &self.tape, |k, _| (k == last).then(|| seed.clone()))
    }

    /// The derivative along a direction in reverse mode.
    ///
    /// # Errors
    /// [`DiffError`] where a step has no derivative.
    pub fn slope(&self, seed: &StateVector, direction: Direction<'_>) -> Result<f64, DiffError> {
        let by = self.gradient(seed)?.by;
        Ok(direction.iter().map(|(param, rate)| rate * by.by(&self.scene, *param)).sum())
    }

    /// The change of every state along a direction, in forward mode.
    ///
    /// # Errors
    /// [`DiffError`] where a step has no derivative.
    pub fn tangent(&self, direction: Direction<'_>) -> Result<Vec<StateVector>, DiffError> {
        let mut along = RolloutVector::zeros(&self.scene, self.tape.records.len());
        for (param, rate) in direction {
            along.add(&self.scene, *param, *rate);
        }
        tangent(&self.scene, &self.tape, &along)
    }
}

/// The numbers that a pair's friction comes from: with equal coefficients √(μμ) = μ changes at rate
/// one when both do.
#[must_use]
pub(crate) fn by_friction(a: usize, b: usize) -> [(Param, f64); 2] {
    [(Param::Friction(a), 1.0), (Param::Friction(b), 1.0)]
}

/// The same for restitution, whose mean changes at rate one when both do.
#[must_use]
pub(crate) fn by_restitution(a: usize, b: usize) -> [(Param, f64); 2] {
    [(Param::Restitution(a), 1.0), (Param::Restitution(b), 1.0)]
}
