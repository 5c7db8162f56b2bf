//! x⁺ = A x + B u.

use nalgebra::{DMatrix, DVector};
use tangency_control::{Dynamics, Linearisation};

/// A linear system.
#[derive(Clone, Debug)]
pub(crate) struct Linear {
    pub(crate) state: DMatrix<f64>,
    pub(crate) control: DMatrix<f64>,
}

impl Linear {
    /// x⁺ = x + u.
    pub(crate) fn sum() -> Self {
        Self { state: DMatrix::identity(1, 1), control: DMatrix::identity(1, 1) }
    }

    /// A mass of 1 kg pushed for `dt`, its velocity first: x⁺ = x + dt v⁺.
    pub(crate) fn mass(dt: f64) -> Self {
        let state = DMatrix::from_row_slice(2, 2, &[1.0, dt, 0.0, 1.0]);
        Self { state, control: DMatrix::from_column_slice(2, 1, &[dt * dt, dt]) }
    }
}

/// It never fails.
#[derive(Debug)]
pub(crate) enum Never {}

impl std::fmt::Display for Never {
    fn fmt(&self, _: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match *self {}
    }
}

impl std::error::Error for Never {}

impl Dynamics for Linear {
    type State = DVector<f64>;
    type Step = DVector<f64>;
    type Error = Never;

    fn states(&self) -> usize {
        self.state.nrows()
    }

    fn controls(&self) -> usize {
        self.control.ncols()
    }

    fn coordinates(&self, state: &DVector<f64>) -> DVector<f64> {
        state.clone()
    }

    fn step(
        &mut self,
        state: &DVector<f64>,
        _: Option<&DVector<f64>>,
        control: &[f64],
    ) -> Result<DVector<f64>, Never> {
        Ok(&self.state * state + &self.control * DVector::from_column_slice(control))
    }

    fn after<'a>(&self, step: &'a DVector<f64>) -> &'a DVector<f64> {
        step
    }

    fn linearise(&self, _: &DVector<f64>, _: &DVector<f64>) -> Result<Linearisation, Never> {
        Ok(Linearisation { state: self.state.clone(), control: self.control.clone() })
    }
}
