//! Limits of the controls.

use nalgebra::DVector;

use crate::PlanError;

/// lower ≤ u ≤ upper, the same at every step; infinite where there is no limit.
#[derive(Clone, Debug, PartialEq)]
pub struct ControlLimits {
    lower: DVector<f64>,
    upper: DVector<f64>,
}

impl ControlLimits {
    /// Limits per number of the control.
    ///
    /// # Errors
    /// [`PlanError::Size`] for lists of different lengths, [`PlanError::Limits`] for a lower limit that
    /// is not below or at its upper one.
    pub fn new(lower: Vec<f64>, upper: Vec<f64>) -> Result<Self, PlanError> {
        let (lower, upper) = (DVector::from_vec(lower), DVector::from_vec(upper));
        crate::cost::size("the upper limits of the control", [lower.len(), 1], upper.shape())?;
        for (channel, (&lower, &upper)) in lower.iter().zip(&upper).enumerate() {
            let room = lower <= upper && lower < f64::INFINITY && upper > f64::NEG_INFINITY;
            if !room {
                return Err(PlanError::Limits { channel, lower, upper });
            }
        }
        Ok(Self { lower, upper })
    }

    /// None, for controls of m numbers.
    #[must_use]
    pub fn none(controls: usize) -> Self {
        let all = |limit: f64| DVector::from_element(controls, limit);
        Self { lower: all(f64::NEG_INFINITY), upper: all(f64::INFINITY) }
    }

    /// Lower limits, m.
    #[must_use]
    pub fn lower(&self) -> &DVector<f64> {
        &self.lower
    }

    /// Upper limits, m.
    #[must_use]
    pub fn upper(&self) -> &DVector<f64> {
        &self.upper
    }

    /// The nearest control within the limits.
    #[must_use]
    pub fn clamp(&self, control: &DVector<f64>) -> DVector<f64> {
        control.zip_zip_map(&self.lower, &self.upper, f64::clamp)
    }

    /// How far a control may change.
    pub(crate) fn around(&self, control: &DVector<f64>) -> Self {
        Self { lower: &self.lower - control, upper: &self.upper - control }
    }

    /// Refuses a control of another size, one that is not finite, or one outside.
    pub(crate) fn check(&self, step: usize, control: &[f64]) -> Result<(), PlanError> {
        let what = "a control of the first guess";
        crate::cost::size(what, [self.lower.len(), 1], (control.len(), 1))?;
        crate::cost::finite(what, step, control.iter())?;
        for (channel, &value) in control.iter().enumerate() {
            let (lower, upper) = (self.lower[channel], self.upper[channel]);
            if value < lower || value > upper {
                return Err(PlanError::Outside { step, channel, value, lower, upper });
            }
        }
        Ok(())
    }
}
