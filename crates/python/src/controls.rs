//! Controls of a run: none, known beforehand, or decided step by step in Python.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use tangency::{Scene, State};

use crate::arrays::Numbers;
use crate::state;

/// Controls of one run.
pub(crate) enum Controls {
    /// Zero in every channel.
    Zero,
    /// (steps, channels), row-major.
    Planned(Vec<f64>),
    /// `policy(k, state)` returns the control of step k.
    Policy(Py<PyAny>),
}

impl Controls {
    /// Reads what was given, and how many steps there are.
    pub(crate) fn new(
        scene: &Scene,
        given: Option<&Bound<'_, PyAny>>,
        steps: Option<usize>,
        default: usize,
    ) -> PyResult<(Self, usize)> {
        let Some(given) = given else { return Ok((Self::Zero, steps.unwrap_or(default))) };
        if given.is_callable() {
            return Ok((Self::Policy(given.clone().unbind()), steps.unwrap_or(default)));
        }
        let numbers: Numbers = given.extract()?;
        let steps = steps.unwrap_or_else(|| numbers.shape.first().copied().unwrap_or(default));
        let channels = scene.controls().len();
        numbers.expect("controls", "(steps, channels)", &[steps, channels])?;
        Ok((Self::Planned(numbers.values), steps))
    }
}

/// A policy in Python, and what went wrong in it.
pub(crate) struct Policy {
    call: Py<PyAny>,
    channels: usize,
    pub(crate) failure: Option<PyErr>,
}

impl Policy {
    pub(crate) fn new(policy: Py<PyAny>, scene: &Scene) -> Self {
        Self { call: policy, channels: scene.controls().len(), failure: None }
    }

    /// The control of a step; not a number once the policy has failed, so that no step is taken.
    pub(crate) fn control(&mut self, step: usize, state: &State) -> Vec<f64> {
        Python::attach(|py| self.ask(py, step, state)).unwrap_or_else(|failure| {
            self.failure.get_or_insert(failure);
            vec![f64::NAN; self.channels.max(1)]
        })
    }

    fn ask(&self, py: Python<'_>, step: usize, state: &State) -> PyResult<Vec<f64>> {
        let state = state::to_python(py, state)?;
        let answer = self.call.bind(py).call1((step, state))?;
        if answer.is_none() {
            let message = format!("the policy returned None at step {step}; return its control");
            return Err(PyTypeError::new_err(message));
        }
        let numbers: Numbers = answer.extract()?;
        if numbers.values.len() != self.channels {
            let message = format!(
                "the policy gave {} numbers at step {step}; give one per control channel, {}",
                numbers.values.len(),
                self.channels
            );
            return Err(PyValueError::new_err(message));
        }
        Ok(numbers.values)
    }
}
