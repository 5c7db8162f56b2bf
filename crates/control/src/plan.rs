//! What a planner found.

use nalgebra::{DMatrix, DVector};

use crate::ControlLimits;

/// Why a planner was content.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// No change of the controls within the limits promises anything more.
    Optimal,
    /// The last step brought next to nothing, though derivatives promised more: as happens at a switch,
    /// where a contact opens or begins to slide.
    Settled,
}

/// Controls of T steps, the motion that they make, and how to keep to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// u, T controls of m numbers.
    pub controls: Vec<Vec<f64>>,
    /// x, T + 1 states of n numbers.
    pub states: Vec<DVector<f64>>,
    /// K, T gains of m × n; zero where a control is at its limit. None if no iteration was done.
    pub gains: Vec<DMatrix<f64>>,
    /// The limits that the controls keep to.
    pub limits: ControlLimits,
    /// Cost of the motion.
    pub cost: f64,
    /// Cost of the first guess and after every iteration that improved it.
    pub history: Vec<f64>,
    /// Iterations done.
    pub iterations: usize,
    /// Why it ended; `None` inside an error.
    pub ending: Option<Ending>,
}

impl Plan {
    /// The control of step k in a state that is not quite that of the plan: u + K (x − x̄), within the
    /// limits.
    ///
    /// # Panics
    /// If the plan has no such step, or x another size.
    #[must_use]
    pub fn feedback(&self, k: usize, x: &DVector<f64>) -> Vec<f64> {
        let planned = DVector::from_column_slice(&self.controls[k]);
        let corrected = planned + &self.gains[k] * (x - &self.states[k]);
        self.limits.clamp(&corrected).as_slice().to_vec()
    }
}
