//! States as Python knows them: `tangency.State(q, v, time)`, or any such tuple.

use pyo3::exceptions::PyValueError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyList, PyTuple};
use tangency::{Scene, State};

use crate::arrays::{Numbers, triples};

static CLASS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();

/// A state for Python.
pub(crate) fn to_python<'py>(py: Python<'py>, state: &State) -> PyResult<Bound<'py, PyAny>> {
    let class = CLASS.get_or_try_init(py, || {
        let module = py.import(intern!(py, "tangency.state"))?;
        Ok::<_, PyErr>(module.getattr(intern!(py, "State"))?.unbind())
    })?;
    class.bind(py).call1((triples(py, &state.q)?, triples(py, &state.v)?, state.time))
}

/// A state from Python; the scene's own where there is none.
pub(crate) fn from_python(scene: &Scene, given: Option<&Bound<'_, PyAny>>) -> PyResult<State> {
    let Some(given) = given else { return Ok(scene.initial_state()) };
    let listed = given.is_instance_of::<PyTuple>() || given.is_instance_of::<PyList>();
    let length = if listed { given.len()? } else { 0 };
    if !(2..=3).contains(&length) {
        let message = "a state is a tangency.State, or a tuple (q, v) or (q, v, time)";
        return Err(PyValueError::new_err(message));
    }
    let part = |name: &str, k: usize| -> PyResult<_> {
        let numbers: Numbers = given.get_item(k)?.extract()?;
        numbers.expect(name, "(bodies, 3)", &[scene.bodies().len(), 3])?;
        Ok(numbers.triples())
    };
    let (q, v) = (part("q", 0)?, part("v", 1)?);
    let time = if length == 3 { given.get_item(2)?.extract()? } else { 0.0 };
    let state = State { time, q, v };
    state.check(scene.bodies().len()).map_err(crate::errors::value)?;
    Ok(state)
}
