//! Derivatives of a loss by states: what reverse mode begins with.

use nalgebra::Vector3;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use tangency::StateVector;

use crate::arrays::{Numbers, tuple};

/// ∂L/∂q or ∂L/∂v of one run.
pub(crate) struct Bars {
    /// Of all states, the first one first, or of the last one alone.
    values: Vec<f64>,
    every: bool,
    bodies: usize,
    steps: usize,
}

impl Bars {
    /// Of all runs of a batch (of one run: `batch` is empty): (batch, steps + 1, bodies, 3), or
    /// (batch, bodies, 3) for the last states alone.
    pub(crate) fn read(
        what: &str,
        given: Option<Numbers>,
        batch: &[usize],
        steps: usize,
        bodies: usize,
    ) -> PyResult<Vec<Self>> {
        let count: usize = batch.iter().product();
        let Some(Numbers { shape, values }) = given else {
            let none = || Self { values: vec![0.0; 3 * bodies], every: false, bodies, steps };
            return Ok((0..count).map(|_| none()).collect());
        };
        let all = [batch, &[steps + 1, bodies, 3]].concat();
        let last = [batch, &[bodies, 3]].concat();
        let every = shape == all;
        if !every && shape != last {
            let (found, all, last) = (tuple(&shape), tuple(&all), tuple(&last));
            let message = format!(
                "{what} has shape {found}; give {all} for all states, or {last} for the last ones alone"
            );
            return Err(PyValueError::new_err(message));
        }
        let size = if every { (steps + 1) * bodies * 3 } else { bodies * 3 };
        let chunk = |k: usize| values[k * size..(k + 1) * size].to_vec();
        Ok((0..count).map(|k| Self { values: chunk(k), every, bodies, steps }).collect())
    }

    /// Those of state k, if it has any.
    fn of(&self, k: usize) -> Option<impl Iterator<Item = Vector3<f64>>> {
        if !self.every && k != self.steps {
            return None;
        }
        let from = if self.every { 3 * self.bodies * k } else { 0 };
        let part = &self.values[from..from + 3 * self.bodies];
        Some(part.chunks_exact(3).map(Vector3::from_column_slice))
    }
}

/// Adds the derivatives by state k.
pub(crate) fn add(q: &Bars, v: &Bars, k: usize, bar: &mut StateVector) {
    for (bars, to) in [(q, &mut bar.q), (v, &mut bar.v)] {
        for (to, add) in to.iter_mut().zip(bars.of(k).into_iter().flatten()) {
            *to += add;
        }
    }
}
