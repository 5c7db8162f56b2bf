//! How much is added to the Hessians by the control: more where a step failed, less where one went
//! well, each time by a factor that grows (Tassa, Erez & Todorov 2012, section II.F).

use crate::Planner;

/// λ, in units of cost per squared control, and the factor of its next change.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Regularisation {
    lambda: f64,
    rate: f64,
    factor: f64,
    least: f64,
    greatest: f64,
}

impl Regularisation {
    /// None at first.
    pub(crate) fn new(planner: &Planner) -> Self {
        Self {
            lambda: 0.0,
            rate: 1.0,
            factor: planner.regularisation_factor,
            least: planner.least_regularisation,
            greatest: planner.greatest_regularisation,
        }
    }

    /// λ.
    pub(crate) fn lambda(&self) -> f64 {
        self.lambda
    }

    /// More; whether it is still within bounds.
    pub(crate) fn raise(&mut self) -> bool {
        self.rate = (self.rate * self.factor).max(self.factor);
        self.lambda = (self.lambda * self.rate).max(self.least);
        self.lambda <= self.greatest
    }

    /// Less, and none at all below the least.
    pub(crate) fn lower(&mut self) {
        self.rate = (self.rate / self.factor).min(1.0 / self.factor);
        self.lambda *= self.rate;
        if self.lambda < self.least {
            self.lambda = 0.0;
        }
    }
}
