//! Plain gradient descent.

use crate::objective::{Iterate, Objective, Slope, Watch, push};

/// p ← p − rate · gradient, each component of the gradient clipped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GradientDescent {
    /// Step per gradient.
    pub rate: f64,
    /// Greatest size of a component of the gradient; infinite to clip nothing.
    pub clip: f64,
    /// How many updates.
    pub iterations: usize,
}

impl GradientDescent {
    /// All points from `start` on, the start first.
    ///
    /// # Errors
    /// Where there is no loss at a point.
    pub fn minimise<O: Objective>(
        &self,
        objective: &mut O,
        start: &[f64],
        watch: Watch<'_>,
    ) -> Result<Vec<Iterate>, O::Error> {
        let (mut point, mut trace) = (start.to_vec(), Vec::new());
        for _ in 0..self.iterations {
            let Slope { loss, gradient } = objective.evaluate(&point)?;
            push(&mut trace, point.clone(), loss, watch);
            for (p, slope) in point.iter_mut().zip(&gradient) {
                *p -= self.rate * slope.clamp(-self.clip, self.clip);
            }
        }
        let loss = objective.evaluate(&point)?.loss;
        push(&mut trace, point, loss, watch);
        Ok(trace)
    }
}
