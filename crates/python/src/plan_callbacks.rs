//! Costs and dynamics that are written in Python.

use std::cell::RefCell;

use nalgebra::{DMatrix, DVector};
use pyo3::prelude::*;
use tangency::control::{Cost, Dynamics, Expansion, LastExpansion, Linearisation};

use crate::arrays::{Numbers, vector};

/// The first exception that a callback raised.
pub(crate) type Failure = RefCell<Option<PyErr>>;

/// A cost with the methods `running`, `running_expansion`, `last` and `last_expansion`.
pub(crate) struct PythonCost<'a, 'py> {
    pub(crate) object: Bound<'py, PyAny>,
    pub(crate) failure: &'a Failure,
}

/// Matrices and vectors that a callback returned.
type Parts = Vec<Numbers>;

impl<'py> PythonCost<'_, 'py> {
    fn kept<T>(&self, found: PyResult<T>, otherwise: T) -> T {
        found.unwrap_or_else(|failure| {
            self.failure.borrow_mut().get_or_insert(failure);
            otherwise
        })
    }

    fn array(&self, x: &DVector<f64>) -> Bound<'py, PyAny> {
        vector(self.object.py(), x).into_any()
    }
}

/// A matrix that may be given as a vector or a number where that is the same.
fn matrix(numbers: &Numbers, rows: usize, columns: usize) -> DMatrix<f64> {
    if numbers.values.len() == rows * columns {
        return DMatrix::from_row_slice(rows, columns, &numbers.values);
    }
    let shape = |k: usize| numbers.shape.get(k).copied().unwrap_or(1);
    DMatrix::from_element(shape(0), shape(1), f64::NAN)
}

fn part(parts: &Parts, k: usize) -> PyResult<&Numbers> {
    let missing = || {
        let message = format!("an expansion of the cost has {} parts, too few", parts.len());
        pyo3::exceptions::PyValueError::new_err(message)
    };
    parts.get(k).ok_or_else(missing)
}

impl Cost for PythonCost<'_, '_> {
    fn running(&self, k: usize, x: &DVector<f64>, u: &DVector<f64>) -> f64 {
        let found = self.object.call_method1("running", (k, self.array(x), self.array(u)));
        self.kept(found.and_then(|value| value.extract()), f64::NAN)
    }

    fn running_expansion(&self, k: usize, x: &DVector<f64>, u: &DVector<f64>) -> Expansion {
        let (n, m) = (x.len(), u.len());
        let nothing = || Expansion {
            x: DVector::from_element(n, f64::NAN),
            u: DVector::zeros(m),
            xx: DMatrix::zeros(n, n),
            ux: DMatrix::zeros(m, n),
            uu: DMatrix::zeros(m, m),
        };
        let ask = || -> PyResult<Expansion> {
            let arguments = (k, self.array(x), self.array(u));
            let parts: Parts =
                self.object.call_method1("running_expansion", arguments)?.extract()?;
            Ok(Expansion {
                x: part(&parts, 0)?.vector(),
                u: part(&parts, 1)?.vector(),
                xx: matrix(part(&parts, 2)?, n, n),
                ux: matrix(part(&parts, 3)?, m, n),
                uu: matrix(part(&parts, 4)?, m, m),
            })
        };
        self.kept(ask(), nothing())
    }

    fn last(&self, x: &DVector<f64>) -> f64 {
        let found = self.object.call_method1("last", (self.array(x),));
        self.kept(found.and_then(|value| value.extract()), f64::NAN)
    }

    fn last_expansion(&self, x: &DVector<f64>) -> LastExpansion {
        let n = x.len();
        let nothing =
            || LastExpansion { x: DVector::from_element(n, f64::NAN), xx: DMatrix::zeros(n, n) };
        let ask = || -> PyResult<LastExpansion> {
            let parts: Parts =
                self.object.call_method1("last_expansion", (self.array(x),))?.extract()?;
            let (x, xx) = (part(&parts, 0)?.vector(), matrix(part(&parts, 1)?, n, n));
            Ok(LastExpansion { x, xx })
        };
        self.kept(ask(), nothing())
    }
}

/// Dynamics with `states`, `controls`, `step(x, u)` and `linearise(x, u)`.
pub(crate) struct PythonDynamics<'a, 'py> {
    pub(crate) object: Bound<'py, PyAny>,
    pub(crate) states: usize,
    pub(crate) controls: usize,
    pub(crate) failure: &'a Failure,
}

/// A step of such dynamics: its control, and the state after it.
pub(crate) struct PythonStep {
    control: DVector<f64>,
    after: DVector<f64>,
}

impl PythonDynamics<'_, '_> {
    fn ask<T>(&self, call: impl FnOnce(&Self) -> PyResult<T>) -> PyResult<T> {
        call(self).inspect_err(|failure| {
            let copy = failure.clone_ref(self.object.py());
            self.failure.borrow_mut().get_or_insert(copy);
        })
    }
}

impl Dynamics for PythonDynamics<'_, '_> {
    type State = DVector<f64>;
    type Step = PythonStep;
    type Error = PyErr;

    fn states(&self) -> usize {
        self.states
    }

    fn controls(&self) -> usize {
        self.controls
    }

    fn coordinates(&self, state: &DVector<f64>) -> DVector<f64> {
        state.clone()
    }

    fn step(
        &mut self,
        state: &DVector<f64>,
        _: Option<&PythonStep>,
        control: &[f64],
    ) -> PyResult<PythonStep> {
        self.ask(|it| {
            let (py, control) = (it.object.py(), DVector::from_column_slice(control));
            let arguments = (vector(py, state), vector(py, &control));
            let after: Numbers = it.object.call_method1("step", arguments)?.extract()?;
            after.expect("the state after `step`", "(states,)", &[it.states])?;
            Ok(PythonStep { control, after: after.vector() })
        })
    }

    fn after<'a>(&self, step: &'a PythonStep) -> &'a DVector<f64> {
        &step.after
    }

    fn linearise(&self, state: &DVector<f64>, step: &PythonStep) -> PyResult<Linearisation> {
        self.ask(|it| {
            let py = it.object.py();
            let arguments = (vector(py, state), vector(py, &step.control));
            let (a, b): (Numbers, Numbers) =
                it.object.call_method1("linearise", arguments)?.extract()?;
            a.expect("A of `linearise`", "(states, states)", &[it.states, it.states])?;
            b.expect("B of `linearise`", "(states, controls)", &[it.states, it.controls])?;
            Ok(Linearisation { state: a.matrix("A")?, control: b.matrix("B")? })
        })
    }
}
