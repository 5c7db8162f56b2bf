//! What a search makes small, how it begins, and what it visits.

use std::error::Error;

use nalgebra::{DMatrix, DVector};

use crate::Bounds;

/// A loss as a function of n numbers.
pub trait Objective {
    /// Why there is no loss at a point.
    type Error: Error + Send + Sync + 'static;

    /// The loss and its gradient.
    ///
    /// # Errors
    /// Why there is none here.
    fn evaluate(&mut self, point: &[f64]) -> Result<Slope, Self::Error>;
}

/// A loss Σ rᵢ², as a function of n numbers.
pub trait LeastSquares {
    /// Why there are no residuals at a point.
    type Error: Error + Send + Sync + 'static;

    /// The residuals and their derivatives.
    ///
    /// # Errors
    /// Why there are none here.
    fn linearise(&mut self, point: &[f64]) -> Result<Residuals, Self::Error>;
}

/// A loss and its gradient at a point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Slope {
    /// The loss.
    pub loss: f64,
    /// By the n numbers.
    pub gradient: Vec<f64>,
}

/// Residuals and their derivatives at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Residuals {
    /// r.
    pub values: DVector<f64>,
    /// ∂r/∂p: one row per residual, n columns.
    pub jacobian: DMatrix<f64>,
}

impl Residuals {
    /// Σ rᵢ².
    #[must_use]
    pub fn loss(&self) -> f64 {
        self.values.norm_squared()
    }
}

/// A point that a search visited.
#[derive(Clone, Debug, PartialEq)]
pub struct Iterate {
    /// The numbers.
    pub point: Vec<f64>,
    /// The loss there.
    pub loss: f64,
}

/// Is called at every point that a search goes on from.
pub type Watch<'a> = &'a mut dyn FnMut(&Iterate);

/// A search that could not begin.
#[derive(Debug, thiserror::Error)]
pub enum SearchError<E: Error + 'static> {
    /// More or fewer bounds than numbers.
    #[error("{bounds} bounds for {numbers} numbers; give one for each")]
    Size {
        /// Bounds.
        bounds: usize,
        /// Numbers to begin with.
        numbers: usize,
    },
    /// A number on or outside of its bounds.
    #[error("number {index} begins at {value}; begin between its bounds, {lower} and {upper}")]
    Start {
        /// Which.
        index: usize,
        /// Its value.
        value: f64,
        /// Lower bound.
        lower: f64,
        /// Upper bound.
        upper: f64,
    },
    /// No loss at the first point.
    #[error(transparent)]
    Objective(#[from] E),
}

/// Refuses a start that does not lie between its bounds.
pub(crate) fn check_start<E: Error>(
    bounds: &[Bounds],
    start: &[f64],
) -> Result<(), SearchError<E>> {
    if bounds.len() != start.len() {
        return Err(SearchError::Size { bounds: bounds.len(), numbers: start.len() });
    }
    let outside = bounds.iter().zip(start).position(|(bounds, p)| !bounds.may_begin_at(*p));
    outside.map_or(Ok(()), |index| {
        let (value, Bounds { lower, upper }) = (start[index], bounds[index]);
        Err(SearchError::Start { index, value, lower, upper })
    })
}

/// Writes down a point.
pub(crate) fn push(trace: &mut Vec<Iterate>, point: Vec<f64>, loss: f64, watch: Watch<'_>) {
    let iterate = Iterate { point, loss };
    watch(&iterate);
    trace.push(iterate);
}
