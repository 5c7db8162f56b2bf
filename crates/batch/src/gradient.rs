//! Gradients side by side.

use tangency_core::{Rollout, State};
use tangency_diff::{Gradient, StateVector, checkpointed_gradient, gradient_adding};

use crate::{Batch, BatchError, Controls, Failure, Outcomes};

/// The loss of one environment's rollout, and its gradient.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluation {
    /// The loss.
    pub value: f64,
    /// Its gradient by initial state, controls and the scene's numbers.
    pub gradient: Gradient,
}

impl Batch {
    /// Reverse mode over the rollouts of all environments, as [`Batch::rollout`] left them; an
    /// environment without one fails with [`Failure::NoRollout`].
    ///
    /// `add_seed(environment, k, state, bar)` adds ∂L/∂(state k) of that environment's loss to `bar`,
    /// which already holds what comes through later states; k = 0 is the initial state. The numbers of
    /// the scenes must be those of the rollouts.
    ///
    /// # Errors
    /// [`BatchError::Rollouts`] if there is not one place per environment. Failures of single
    /// environments are among the outcomes.
    pub fn gradient(
        &self,
        rollouts: &[Option<Rollout>],
        add_seed: impl Fn(usize, usize, &State, &mut StateVector) + Sync,
    ) -> Result<Outcomes<Gradient>, BatchError> {
        let (expected, found) = (self.len(), rollouts.len());
        if found != expected {
            return Err(BatchError::Rollouts { expected, found });
        }
        Ok(self.look_ahead(|environment, _| {
            let run = rollouts[environment].as_ref().ok_or(Failure::NoRollout { environment })?;
            self.differentiate(environment, run, |k, state, bar| {
                add_seed(environment, k, state, bar);
            })
        }))
    }

    /// Value and gradient of a loss that is a sum over states, for every environment from where it is;
    /// the environments stay there.
    ///
    /// `loss(environment, k, state, bar)` returns the loss's term of state k (k = 0 is the initial
    /// state) and adds ∂L/∂(state k) to `bar`, which already holds what comes through later states. It
    /// is asked for the last state first. Holds one tape per thread at a time.
    ///
    /// # Errors
    /// [`BatchError::ControlSize`]. Failures of single environments are among the outcomes.
    pub fn value_and_gradient(
        &self,
        steps: usize,
        controls: Controls<'_>,
        loss: impl Fn(usize, usize, &State, &mut StateVector) -> f64 + Sync,
    ) -> Result<Outcomes<Evaluation>, BatchError> {
        self.try_map_rollouts(steps, controls, |environment, run| {
            let mut value = 0.0;
            let term = |k, state: &_, bar: &mut _| value += loss(environment, k, state, bar);
            let gradient = self.differentiate(environment, run, term)?;
            evaluation(environment, value, gradient)
        })
    }

    /// As [`value_and_gradient`](Self::value_and_gradient), to the last bit, for long rollouts: in memory
    /// that grows with the root of the number of steps, for the price of one more run.
    ///
    /// # Errors
    /// As [`value_and_gradient`](Self::value_and_gradient).
    pub fn checkpointed_value_and_gradient(
        &self,
        steps: usize,
        controls: Controls<'_>,
        loss: impl Fn(usize, usize, &State, &mut StateVector) -> f64 + Sync,
    ) -> Result<Outcomes<Evaluation>, BatchError> {
        controls.check(self.len(), steps, self.channels)?;
        Ok(self.look_ahead(|environment, workspace| {
            let run = self.roll_checkpointed(environment, steps, &controls, workspace)?;
            let mut value = 0.0;
            let term = |k, state: &_, bar: &mut _| value += loss(environment, k, state, bar);
            let scene = self.scene(environment);
            let gradient = checkpointed_gradient(scene, &*self.solver, &run, self.mode, term)
                .map_err(|source| Failure::Gradient { environment, source })?;
            evaluation(environment, value, gradient)
        }))
    }

    fn differentiate(
        &self,
        environment: usize,
        run: &Rollout,
        add_seed: impl FnMut(usize, &State, &mut StateVector),
    ) -> Result<Gradient, Failure> {
        gradient_adding(self.scene(environment), run, add_seed)
            .map_err(|source| Failure::Gradient { environment, source })
    }
}

/// Refuses a loss that is not finite.
fn evaluation(environment: usize, value: f64, gradient: Gradient) -> Result<Evaluation, Failure> {
    if value.is_finite() {
        Ok(Evaluation { value, gradient })
    } else {
        Err(Failure::Loss { environment, value })
    }
}
