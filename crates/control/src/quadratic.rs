//! The cost of being away from a target.

use nalgebra::{DMatrix, DVector};

use crate::cost::{Cost, Expansion, LastExpansion, finite, size};
use crate::error::PlanError;

/// Half the weighted squares of how far states and controls are from a target:
///
/// ```text
///  l   = ½ (x − x*)ᵀ Q (x − x*) + ½ (u − u*)ᵀ R (u − u*)        l_T = ½ (x − x*)ᵀ Q_T (x − x*)
/// ```
///
/// Q and `Q_T` should be positive semidefinite and R positive definite; all must be symmetric.
#[derive(Clone, Debug, PartialEq)]
pub struct Quadratic {
    /// x*, n.
    pub target: DVector<f64>,
    /// u*, m.
    pub rest: DVector<f64>,
    /// Q, n × n.
    pub state: DMatrix<f64>,
    /// R, m × m.
    pub control: DMatrix<f64>,
    /// `Q_T`, n × n.
    pub last: DMatrix<f64>,
}

impl Quadratic {
    /// A cost of the control alone, R = `effort` times the identity, and target zero.
    #[must_use]
    pub fn of_effort(states: usize, controls: usize, effort: f64) -> Self {
        Self {
            target: DVector::zeros(states),
            rest: DVector::zeros(controls),
            state: DMatrix::zeros(states, states),
            control: DMatrix::from_diagonal_element(controls, controls, effort),
            last: DMatrix::zeros(states, states),
        }
    }

    /// Sets the target of one coordinate, and its weights during the motion and at its end.
    ///
    /// # Panics
    /// If there is no such coordinate.
    pub fn aim(&mut self, place: usize, target: f64, running: f64, last: f64) {
        self.target[place] = target;
        self.state[(place, place)] = running;
        self.last[(place, place)] = last;
    }
}

impl Cost for Quadratic {
    fn running(&self, _: usize, x: &DVector<f64>, u: &DVector<f64>) -> f64 {
        half_square(&self.state, &(x - &self.target))
            + half_square(&self.control, &(u - &self.rest))
    }

    fn running_expansion(&self, _: usize, x: &DVector<f64>, u: &DVector<f64>) -> Expansion {
        Expansion {
            x: &self.state * (x - &self.target),
            u: &self.control * (u - &self.rest),
            xx: self.state.clone(),
            ux: DMatrix::zeros(u.len(), x.len()),
            uu: self.control.clone(),
        }
    }

    fn last(&self, x: &DVector<f64>) -> f64 {
        half_square(&self.last, &(x - &self.target))
    }

    fn last_expansion(&self, x: &DVector<f64>) -> LastExpansion {
        LastExpansion { x: &self.last * (x - &self.target), xx: self.last.clone() }
    }

    fn check(&self, n: usize, m: usize) -> Result<(), PlanError> {
        size("the target of the cost", [n, 1], self.target.shape())?;
        size("the control at rest of the cost", [m, 1], self.rest.shape())?;
        finite("the target of the cost", 0, self.target.iter().chain(&self.rest))?;
        weights("the weights of states", n, &self.state)?;
        weights("the weights of controls", m, &self.control)?;
        weights("the weights of the last state", n, &self.last)
    }
}

/// ½ dᵀ W d.
fn half_square(weights: &DMatrix<f64>, d: &DVector<f64>) -> f64 {
    0.5 * d.dot(&(weights * d))
}

/// Refuses weights of another size, not finite or not symmetric.
fn weights(what: &'static str, n: usize, weights: &DMatrix<f64>) -> Result<(), PlanError> {
    size(what, [n, n], weights.shape())?;
    finite(what, 0, weights.iter())?;
    for row in 0..n {
        for column in 0..row {
            let [one, other] = [weights[(row, column)], weights[(column, row)]];
            if one != other {
                return Err(PlanError::NotSymmetric { what, row, column, one, other });
            }
        }
    }
    Ok(())
}
