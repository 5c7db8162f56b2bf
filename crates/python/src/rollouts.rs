//! Runs of a batch, and their derivatives, over all cores.

use std::collections::BTreeMap;
use std::sync::Arc;

use numpy::{IntoPyArray, PyArray1, PyArray4, PyArrayDyn, PyArrayMethods};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use rayon::prelude::*;
use tangency::diff::DiffError;
use tangency::{State, StateVector};

use crate::arrays::{self, Numbers};
use crate::errors;
use crate::gradient::GradientBatch;
use crate::report::GradientReport;
use crate::rollout::direction;
use crate::scene::Scene;
use crate::seeds::{self, Bars};
use crate::threads;

/// Runs of all environments of a batch, all of the same number of steps; `Batch.rollout` makes them.
#[pyclass(frozen, module = "tangency")]
pub(crate) struct Rollouts {
    scene: Py<Scene>,
    scenes: Vec<Arc<tangency::Scene>>,
    runs: Vec<Arc<tangency::Rollout>>,
    /// Number of steps.
    #[pyo3(get)]
    steps: usize,
    /// Where derivatives are smoothed, how much; otherwise None.
    #[pyo3(get)]
    kappa: Option<f64>,
}

/// Two arrays of (environments, steps + 1, bodies, 3).
type Pair<'py> = (Bound<'py, PyArray4<f64>>, Bound<'py, PyArray4<f64>>);

impl Rollouts {
    pub(crate) fn new(
        scene: Py<Scene>,
        scenes: Vec<Arc<tangency::Scene>>,
        runs: Vec<tangency::Rollout>,
        steps: usize,
        kappa: Option<f64>,
    ) -> Self {
        let runs = runs.into_iter().map(Arc::new).collect();
        Self { scene, scenes, runs, steps, kappa }
    }

    fn shape(&self) -> [usize; 4] {
        [self.runs.len(), self.steps + 1, self.scene.get().scene.bodies().len(), 3]
    }

    fn table<'a, 'py>(
        &self,
        py: Python<'py>,
        lists: impl Iterator<Item = &'a [nalgebra::Vector3<f64>]>,
    ) -> PyResult<Bound<'py, PyArray4<f64>>> {
        let mut values = Vec::with_capacity(self.shape().iter().product());
        lists.for_each(|list| values.extend(list.iter().flat_map(|v| [v.x, v.y, v.z])));
        values.into_pyarray(py).reshape(self.shape())
    }

    fn states(&self) -> impl Iterator<Item = &State> {
        self.runs.iter().flat_map(|run| run.states())
    }
}

/// One entry of an array whose first dimension is the environments.
fn row(given: Option<&Numbers>, k: usize, count: usize) -> Option<Numbers> {
    let Numbers { shape, values } = given?;
    let size = values.len() / count.max(1);
    let part = values[k * size..(k + 1) * size].to_vec();
    Some(Numbers { shape: shape.get(1..).unwrap_or_default().to_vec(), values: part })
}

#[pymethods]
impl Rollouts {
    /// The scene that all environments began with.
    #[getter]
    fn scene<'py>(&self, py: Python<'py>) -> Bound<'py, Scene> {
        self.scene.bind(py).clone()
    }

    fn __len__(&self) -> usize {
        self.runs.len()
    }

    /// Poses (m, m, rad), shape (environments, steps + 1, bodies, 3); the initial ones first.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray4<f64>>> {
        self.table(py, self.states().map(|state| &state.q[..]))
    }

    /// Velocities (m/s, m/s, rad/s), shape (environments, steps + 1, bodies, 3); the initial ones first.
    #[getter]
    fn v<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray4<f64>>> {
        self.table(py, self.states().map(|state| &state.v[..]))
    }

    /// The runs of some environments, in any order and as often as they are named; not copied.
    ///
    /// Parameters
    /// ----------
    /// environments : sequence of int
    ///     Which.
    ///
    /// Returns
    /// -------
    /// Rollouts
    ///
    /// Raises
    /// ------
    /// IndexError
    ///     If there is no such environment.
    fn take(&self, py: Python<'_>, environments: Vec<usize>) -> PyResult<Self> {
        let count = self.runs.len();
        if let Some(it) = environments.iter().find(|it| **it >= count) {
            let message = format!("there is no environment {it}; there are {count}");
            return Err(PyIndexError::new_err(message));
        }
        Ok(Self {
            scene: self.scene.clone_ref(py),
            scenes: environments.iter().map(|k| self.scenes[*k].clone()).collect(),
            runs: environments.iter().map(|k| self.runs[*k].clone()).collect(),
            ..*self
        })
    }

    /// Times of the states, s, shape (environments, steps + 1).
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let times = self.states().map(|state| state.time).collect();
        arrays::array(py, times, &self.shape()[..2])
    }

    /// Controls of the steps, shape (environments, steps, channels).
    #[getter]
    fn controls<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let records = self.runs.iter().flat_map(|run| &run.records);
        let values = records.flat_map(|record| record.control.clone()).collect();
        let channels = self.scene.get().scene.controls().len();
        arrays::array(py, values, &[self.runs.len(), self.steps, channels])
    }

    /// Worst scaled residual per environment, shape (environments,).
    #[getter]
    fn residual<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.runs.iter().map(|run| run.residual()).collect::<Vec<_>>().into_pyarray(py)
    }

    /// The gradients of one loss per environment, by reverse mode over all cores.
    ///
    /// Parameters
    /// ----------
    /// q, v : array_like, shape (environments, bodies, 3) or (environments, steps + 1, bodies, 3), optional
    ///     ∂L/∂q and ∂L/∂v: of the last states alone, or of all states. Zero unless given.
    /// wrt : list of str
    ///     Names of numbers, as of `Scene.value`, that ``values`` of the result will have.
    ///
    /// Returns
    /// -------
    /// GradientBatch
    ///
    /// Raises
    /// ------
    /// GradientError
    ///     If a seed is not finite, or a linear system of the way back is singular; ``failures`` lists
    ///     (environment, message).
    /// SceneError
    ///     If the scene has no number of a name.
    /// ValueError
    ///     If a seed has another shape.
    #[pyo3(
        signature = (q = None, v = None, *, wrt = Vec::new()),
        text_signature = "($self, q=None, v=None, *, wrt=())"
    )]
    fn gradient(
        &self,
        py: Python<'_>,
        q: Option<Numbers>,
        v: Option<Numbers>,
        wrt: Vec<String>,
    ) -> PyResult<GradientBatch> {
        self.scene.get().parameters(&wrt)?;
        let [count, _, bodies, _] = self.shape();
        let q = Bars::read("q", q, &[count], self.steps, bodies)?;
        let v = Bars::read("v", v, &[count], self.steps, bodies)?;
        let one = |k: usize| {
            let add = |step, _: &State, bar: &mut StateVector| seeds::add(&q[k], &v[k], step, bar);
            tangency::gradient_adding(&self.scenes[k], &self.runs[k], add)
        };
        let found: Vec<Result<_, DiffError>> =
            threads::side_by_side(py, || (0..count).into_par_iter().map(one).collect())?;
        let (mut by, mut reports) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for (k, found) in errors::all(py, found)?.into_iter().enumerate() {
            let report = GradientReport::new(&self.scenes[k], &self.runs[k], &found.report);
            by.push(found.by);
            reports.push(Py::new(py, report)?);
        }
        Ok(GradientBatch { scenes: self.scenes.clone(), by, wrt, reports })
    }

    /// How all states change along one direction per environment, by forward mode over all cores.
    ///
    /// Parameters
    /// ----------
    /// q0, v0 : array_like, shape (environments, bodies, 3), optional
    ///     Change of the initial states. Zero unless given.
    /// controls : array_like, shape (environments, steps, channels), optional
    ///     Change of the controls. Zero unless given.
    /// values : dict of str to array_like of shape (environments,), optional
    ///     Rates of named numbers, as of `Scene.value`.
    ///
    /// Returns
    /// -------
    /// dq, dv : ndarray, shape (environments, steps + 1, bodies, 3)
    ///     Change of all poses and velocities per unit along the direction.
    ///
    /// Raises
    /// ------
    /// GradientError
    ///     If a direction is not finite, or a linear system on the way is singular; ``failures`` lists
    ///     (environment, message).
    /// SceneError
    ///     If the scene has no number of a name.
    /// ValueError
    ///     If an array has another shape.
    #[pyo3(signature = (*, q0 = None, v0 = None, controls = None, values = None))]
    fn tangent<'py>(
        &self,
        py: Python<'py>,
        q0: Option<Numbers>,
        v0: Option<Numbers>,
        controls: Option<Numbers>,
        values: Option<BTreeMap<String, Numbers>>,
    ) -> PyResult<Pair<'py>> {
        let [count, _, bodies, _] = self.shape();
        let channels = self.scene.get().scene.controls().len();
        for (what, given) in [("q0", &q0), ("v0", &v0)] {
            let Some(given) = given else { continue };
            given.expect(what, "(environments, bodies, 3)", &[count, bodies, 3])?;
        }
        if let Some(given) = &controls {
            let shape = [count, self.steps, channels];
            given.expect("controls", "(environments, steps, channels)", &shape)?;
        }
        let values = values.unwrap_or_default();
        for (name, rates) in &values {
            rates.expect(name, "(environments,)", &[count])?;
        }
        let along = |k: usize| {
            let part = |given: &Option<Numbers>| row(given.as_ref(), k, count);
            let rates =
                values.iter().map(|(name, rates)| (name.clone(), rates.values[k])).collect();
            direction(&self.scenes[k], self.steps, part(&q0), part(&v0), part(&controls), &rates)
        };
        let along: Vec<_> = (0..count).map(along).collect::<PyResult<_>>()?;
        let one = |k: usize| tangency::tangent(&self.scenes[k], &self.runs[k], &along[k]);
        let found: Vec<Result<Vec<StateVector>, DiffError>> =
            threads::side_by_side(py, || (0..count).into_par_iter().map(one).collect())?;
        let found = errors::all(py, found)?;
        let q = self.table(py, found.iter().flatten().map(|change| &change.q[..]))?;
        let v = self.table(py, found.iter().flatten().map(|change| &change.v[..]))?;
        Ok((q, v))
    }

    /// A number that an environment ran with.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     Of the number, as of `Scene.value`.
    /// environment : int
    ///     Which environment.
    ///
    /// Returns
    /// -------
    /// float
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     If the scene has no such number.
    /// IndexError
    ///     If there is no such environment.
    fn value(&self, name: &str, environment: usize) -> PyResult<f64> {
        let count = self.runs.len();
        let none = || PyIndexError::new_err(format!("there are {count} environments"));
        let scene = self.scenes.get(environment).ok_or_else(none)?;
        Ok(tangency::Parameter::parse(scene, name).map_err(errors::scene)?.value(scene))
    }

    fn __repr__(&self) -> String {
        let [count, _, bodies, _] = self.shape();
        format!("<tangency.Rollouts: {count} runs of {} steps of {bodies} bodies>", self.steps)
    }
}
