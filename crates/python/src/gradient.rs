//! Gradients of losses over runs.

use std::sync::Arc;

use numpy::{PyArray2, PyArray3, PyArrayDyn};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use tangency::{Parameter, RolloutVector};

use crate::arrays;
use crate::errors;
use crate::report::GradientReport;

/// The gradient of a loss over a run; `Rollout.gradient` makes them.
///
/// ``gradient["mass:ball"]`` is the derivative by any number of the scene, whether it was asked for or not.
#[pyclass(frozen, module = "tangency")]
pub(crate) struct Gradient {
    pub(crate) scene: Arc<tangency::Scene>,
    pub(crate) by: RolloutVector,
    /// What was asked for by name.
    pub(crate) wrt: Vec<Parameter>,
    /// What was not smooth, and how much the gradient grew: a `GradientReport`.
    #[pyo3(get)]
    pub(crate) report: Py<GradientReport>,
}

#[pymethods]
impl Gradient {
    /// ∂L/∂(initial poses), shape (bodies, 3).
    #[getter]
    fn q0<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        arrays::triples(py, &self.by.initial.q)
    }

    /// ∂L/∂(initial velocities), shape (bodies, 3).
    #[getter]
    fn v0<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        arrays::triples(py, &self.by.initial.v)
    }

    /// ∂L/∂(initial time), through forces that begin or end.
    #[getter]
    fn time0(&self) -> f64 {
        self.by.initial.time
    }

    /// ∂L/∂controls, shape (steps, channels).
    #[getter]
    fn controls<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let shape = [self.by.controls.len(), self.scene.controls().len()];
        arrays::array(py, self.by.controls.concat(), &shape)
    }

    /// ∂L/∂(number) for all names of `wrt`, a dictionary.
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let all = PyDict::new(py);
        for parameter in &self.wrt {
            all.set_item(&parameter.name, parameter.gradient(&self.scene, &self.by))?;
        }
        Ok(all)
    }

    fn __getitem__(&self, name: &str) -> PyResult<f64> {
        let parse = Parameter::parse(&self.scene, name);
        let parameter = parse.map_err(|error| PyKeyError::new_err(error.to_string()))?;
        Ok(parameter.gradient(&self.scene, &self.by))
    }

    fn __repr__(&self) -> String {
        let (steps, bodies) = (self.by.controls.len(), self.by.initial.q.len());
        format!("<tangency.Gradient over {steps} steps of {bodies} bodies>")
    }
}

/// Gradients of one loss per environment; `Rollouts.gradient` makes them.
///
/// ``gradient["mass:ball"]`` has the derivatives by any number of the scene, shape (environments,).
#[pyclass(frozen, module = "tangency")]
pub(crate) struct GradientBatch {
    pub(crate) scenes: Vec<Arc<tangency::Scene>>,
    pub(crate) by: Vec<RolloutVector>,
    pub(crate) wrt: Vec<String>,
    /// One `GradientReport` per environment.
    #[pyo3(get)]
    pub(crate) reports: Vec<Py<GradientReport>>,
}

impl GradientBatch {
    fn bodies(&self) -> usize {
        self.by.first().map_or(0, |by| by.initial.q.len())
    }

    /// ∂L/∂(a number) per environment.
    fn by_name(&self, name: &str) -> PyResult<Vec<f64>> {
        let of = |(scene, by): (&Arc<tangency::Scene>, &RolloutVector)| -> PyResult<f64> {
            let parameter = Parameter::parse(scene, name).map_err(errors::scene)?;
            Ok(parameter.gradient(scene, by))
        };
        self.scenes.iter().zip(&self.by).map(of).collect()
    }
}

#[pymethods]
impl GradientBatch {
    /// ∂L/∂(initial poses), shape (environments, bodies, 3).
    #[getter]
    fn q0<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let shape = [self.by.len(), self.bodies(), 3];
        arrays::tables(py, self.by.iter().map(|by| &by.initial.q[..]), shape)
    }

    /// ∂L/∂(initial velocities), shape (environments, bodies, 3).
    #[getter]
    fn v0<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let shape = [self.by.len(), self.bodies(), 3];
        arrays::tables(py, self.by.iter().map(|by| &by.initial.v[..]), shape)
    }

    /// ∂L/∂controls, shape (environments, steps, channels).
    #[getter]
    fn controls<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let steps = self.by.first().map_or(0, |by| by.controls.len());
        let channels = self.scenes.first().map_or(0, |scene| scene.controls().len());
        let values = self.by.iter().flat_map(|by| by.controls.iter().flatten().copied()).collect();
        arrays::array(py, values, &[self.by.len(), steps, channels])
    }

    /// ∂L/∂(number) for all names of `wrt`, a dictionary of arrays of shape (environments,).
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let all = PyDict::new(py);
        for name in &self.wrt {
            all.set_item(name, self.__getitem__(py, name)?)?;
        }
        Ok(all)
    }

    fn __getitem__<'py>(
        &self,
        py: Python<'py>,
        name: &str,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        arrays::array(py, self.by_name(name)?, &[self.by.len()])
    }

    fn __len__(&self) -> usize {
        self.by.len()
    }

    fn __repr__(&self) -> String {
        let steps = self.by.first().map_or(0, |by| by.controls.len());
        let (count, bodies) = (self.by.len(), self.bodies());
        format!("<tangency.GradientBatch: {count} gradients over {steps} steps of {bodies} bodies>")
    }
}
