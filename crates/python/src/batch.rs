//! Environments side by side.

use numpy::{IntoPyArray, PyArray1, PyArray3};
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;
use tangency::batch::Controls;
use tangency::{GradientMode, Param, Parameter, State};

use crate::arrays::{self, Numbers, tuple};
use crate::rollouts::Rollouts;
use crate::scene::Scene;
use crate::solver::Solver;
use crate::{errors, threads};

/// Many environments of one scene, side by side over all cores.
///
/// They may differ in state, in numbers and in controls. Results have the bits of a run alone on any number
/// of threads; ``RAYON_NUM_THREADS`` sets how many there are. A batch belongs to one thread at a time.
///
/// Parameters
/// ----------
/// scene : Scene
///     What moves.
/// environments : int
///     How many.
/// backend : str
///     Solver of the complementarity problems, one of `backends`.
/// tolerance : float, optional
///     Its tolerance, in (0, 1); its own unless given. Backends that pivot have none.
/// kappa : float, optional
///     Smooths the derivatives of rollouts that follow, as `Rollout.smoothed` does.
///
/// Raises
/// ------
/// ValueError
///     If the backend, the tolerance or `kappa` does not fit.
#[pyclass(module = "tangency")]
pub(crate) struct Batch {
    scene: Py<Scene>,
    environments: tangency::batch::Batch,
    kappa: Option<f64>,
}

impl Batch {
    fn states<'py>(
        &self,
        py: Python<'py>,
        part: impl Fn(&State) -> &[nalgebra::Vector3<f64>],
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let shape = [self.environments.len(), self.scene.get().scene.bodies().len(), 3];
        arrays::tables(py, self.environments.states().map(part), shape)
    }

    /// Gives environments the numbers back that they had, the last change first.
    fn restore(&mut self, before: Vec<(usize, Param, f64)>) {
        for (environment, param, old) in before.into_iter().rev() {
            let restored = self.environments.set(environment, param, old);
            restored.expect("the environment had this number before");
        }
    }

    /// Indices of environments: all, or those given.
    fn indices(&self, given: Option<Vec<usize>>) -> PyResult<Vec<usize>> {
        let count = self.environments.len();
        let Some(list) = given else { return Ok((0..count).collect()) };
        match list.iter().find(|it| **it >= count) {
            None => Ok(list),
            Some(it) => {
                let message = format!("there is no environment {it}; there are {count}");
                Err(PyIndexError::new_err(message))
            }
        }
    }

    /// Controls of so many steps: none, held (environments, channels), or planned.
    fn controls(&self, given: Option<&Numbers>, steps: usize) -> PyResult<Kind> {
        let (count, channels) = (self.environments.len(), self.environments.channels());
        let Some(numbers) = given else { return Ok(Kind::Zero) };
        if numbers.shape == [count, channels] {
            return Ok(Kind::Held);
        }
        if numbers.shape == [count, steps, channels] {
            return Ok(Kind::Planned);
        }
        let (found, held) = (tuple(&numbers.shape), tuple(&[count, channels]));
        let planned = tuple(&[count, steps, channels]);
        let message = format!(
            "controls has shape {found}; give (environments, channels) = {held} or \
             (environments, steps, channels) = {planned}"
        );
        Err(PyValueError::new_err(message))
    }
}

/// How controls are laid out.
#[derive(Clone, Copy)]
enum Kind {
    Zero,
    Held,
    Planned,
}

impl Kind {
    fn of(self, numbers: Option<&Numbers>) -> Controls<'_> {
        match (self, numbers) {
            (Self::Held, Some(numbers)) => Controls::Held(&numbers.values),
            (Self::Planned, Some(numbers)) => Controls::Planned(&numbers.values),
            _ => Controls::Zero,
        }
    }
}

#[pymethods]
impl Batch {
    #[new]
    #[pyo3(signature = (scene, environments, *, backend = "ipm", tolerance = None, kappa = None))]
    fn new(
        scene: Py<Scene>,
        environments: usize,
        backend: &str,
        tolerance: Option<f64>,
        kappa: Option<f64>,
    ) -> PyResult<Self> {
        let solver = Solver::new(backend, tolerance)?.backend;
        let it = (*scene.get().scene).clone();
        let mut batch = tangency::batch::Batch::new(it, environments, solver);
        if let Some(kappa) = kappa {
            if !(kappa > 0.0 && kappa.is_finite()) {
                let message =
                    format!("kappa is {kappa}; give a positive, finite number, such as 1e-4");
                return Err(PyValueError::new_err(message));
            }
            batch.set_gradient_mode(GradientMode::Smoothed { kappa });
        }
        Ok(Self { scene, environments: batch, kappa })
    }

    /// The scene that all environments began with.
    #[getter]
    fn scene<'py>(&self, py: Python<'py>) -> Bound<'py, Scene> {
        self.scene.bind(py).clone()
    }

    fn __len__(&self) -> usize {
        self.environments.len()
    }

    /// Poses (m, m, rad) now, shape (environments, bodies, 3).
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        self.states(py, |state| &state.q)
    }

    /// Velocities (m/s, m/s, rad/s) now, shape (environments, bodies, 3).
    #[getter]
    fn v<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        self.states(py, |state| &state.v)
    }

    /// Times now, s, shape (environments,).
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.environments.states().map(|state| state.time).collect::<Vec<_>>().into_pyarray(py)
    }

    /// Changes a number of environments. Initial positions and velocities show at the next `reset`, all else
    /// from the next step on.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     Of the number, as of `Scene.value`.
    /// values : float or array_like, shape (environments,)
    ///     One for all, or one for each.
    /// environments : list of int, optional
    ///     Which; all unless given.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     If the scene has no such number, or it cannot be that; nothing has then changed.
    /// ValueError
    ///     If `values` has another shape.
    /// IndexError
    ///     If there is no such environment.
    #[pyo3(signature = (name, values, environments = None))]
    fn set(
        &mut self,
        name: &str,
        values: Numbers,
        environments: Option<Vec<usize>>,
    ) -> PyResult<()> {
        let environments = self.indices(environments)?;
        let one = values.shape.is_empty();
        if !one {
            values.expect("values", "(environments,)", &[environments.len()])?;
        }
        let parameter = Parameter::parse(&self.scene.get().scene, name).map_err(errors::scene)?;
        let value = |k: usize| values.values[if one { 0 } else { k }];
        let targets = environments.iter().enumerate().flat_map(|(k, environment)| {
            parameter.targets.iter().map(move |(param, scale)| (*environment, *param, *scale, k))
        });
        let mut before = Vec::with_capacity(environments.len());
        for (environment, param, scale, k) in targets {
            let old = self.environments.scene(environment).get(param);
            if let Err(error) = self.environments.set(environment, param, scale * value(k)) {
                self.restore(before);
                return Err(errors::number(name, error));
            }
            before.extend(old.map(|old| (environment, param, old)));
        }
        Ok(())
    }

    /// Puts environments into their initial states.
    ///
    /// Parameters
    /// ----------
    /// environments : list of int, optional
    ///     Which; all unless given.
    ///
    /// Raises
    /// ------
    /// IndexError
    ///     If there is no such environment.
    #[pyo3(signature = (environments = None))]
    fn reset(&mut self, environments: Option<Vec<usize>>) -> PyResult<()> {
        for environment in self.indices(environments)? {
            self.environments.reset(environment);
        }
        Ok(())
    }

    /// Puts environments into given states.
    ///
    /// Parameters
    /// ----------
    /// q, v : array_like, shape (environments, bodies, 3), optional
    ///     Poses and velocities; the initial ones unless given.
    /// time : float
    ///     Of all of them, s.
    /// environments : list of int, optional
    ///     Which; all unless given.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an array has another shape or is not finite; nothing has then changed.
    /// IndexError
    ///     If there is no such environment.
    #[pyo3(signature = (q = None, v = None, time = 0.0, environments = None))]
    fn reset_to(
        &mut self,
        q: Option<Numbers>,
        v: Option<Numbers>,
        time: f64,
        environments: Option<Vec<usize>>,
    ) -> PyResult<()> {
        let environments = self.indices(environments)?;
        let bodies = self.scene.get().scene.bodies().len();
        let shape = [environments.len(), bodies, 3];
        let read = |what, given: Option<Numbers>| -> PyResult<_> {
            let Some(numbers) = given else { return Ok(None) };
            numbers.expect(what, "(environments, bodies, 3)", &shape)?;
            Ok(Some(numbers.triples()))
        };
        let (q, v) = (read("q", q)?, read("v", v)?);
        let state = |k: usize, environment: usize| {
            let mut state = self.environments.scene(environment).initial_state();
            let part = k * bodies..(k + 1) * bodies;
            for (given, to) in [(&q, &mut state.q), (&v, &mut state.v)] {
                if let Some(given) = given {
                    to.copy_from_slice(&given[part.clone()]);
                }
            }
            state.time = time;
            let unfit = |error| errors::value(format!("environment {environment}: {error}"));
            state.check(bodies).map(|()| (environment, state)).map_err(unfit)
        };
        let states = environments.into_iter().enumerate().map(|(k, it)| state(k, it));
        for (environment, state) in states.collect::<PyResult<Vec<_>>>()? {
            self.environments.reset_to(environment, state).map_err(errors::value)?;
        }
        Ok(())
    }

    /// Takes one step of every environment.
    ///
    /// Parameters
    /// ----------
    /// controls : array_like, shape (environments, channels), optional
    ///     Zero unless given.
    ///
    /// Raises
    /// ------
    /// StepError
    ///     If environments cannot step: they stay where they were, all others have stepped. ``failures``
    ///     lists (environment, message).
    /// ValueError
    ///     If `controls` has another shape.
    #[pyo3(signature = (controls = None))]
    fn step(&mut self, py: Python<'_>, controls: Option<Numbers>) -> PyResult<()> {
        self.advance(py, 1, controls)
    }

    /// Takes steps of every environment; costs less than as many calls of `step`.
    ///
    /// Parameters
    /// ----------
    /// steps : int
    ///     How many.
    /// controls : array_like, optional
    ///     Held, shape (environments, channels), or one per step, shape (environments, steps, channels). Zero
    ///     unless given.
    ///
    /// Raises
    /// ------
    /// StepError
    ///     If environments cannot step: they stay before the step that they failed at, all others have taken
    ///     all steps. ``failures`` lists (environment, message).
    /// ValueError
    ///     If `controls` has another shape.
    #[pyo3(signature = (steps, controls = None))]
    fn advance(&mut self, py: Python<'_>, steps: usize, controls: Option<Numbers>) -> PyResult<()> {
        let kind = self.controls(controls.as_ref(), steps)?;
        let batch = &mut self.environments;
        threads::side_by_side(py, || batch.advance(steps, kind.of(controls.as_ref())))?
            .map_err(|error| errors::batch(py, &error))
    }

    /// Runs every environment from where it is; the environments stay there.
    ///
    /// Parameters
    /// ----------
    /// steps : int, optional
    ///     How many; as many as there are controls, or else those of the scene's duration, unless given.
    /// controls : array_like, optional
    ///     Held, shape (environments, channels), or one per step, shape (environments, steps, channels). Zero
    ///     unless given.
    ///
    /// Returns
    /// -------
    /// Rollouts
    ///
    /// Raises
    /// ------
    /// StepError
    ///     If environments cannot step; ``failures`` lists (environment, message).
    /// GradientError
    ///     If the runs cannot be smoothed; ``failures`` lists (environment, message).
    /// ValueError
    ///     If `controls` has another shape.
    #[pyo3(signature = (steps = None, controls = None))]
    fn rollout(
        &self,
        py: Python<'_>,
        steps: Option<usize>,
        controls: Option<Numbers>,
    ) -> PyResult<Rollouts> {
        let planned = controls.as_ref().filter(|u| u.shape.len() == 3).map(|u| u.shape[1]);
        let steps = steps.or(planned).unwrap_or_else(|| self.scene.get().steps());
        let kind = self.controls(controls.as_ref(), steps)?;
        let batch = &self.environments;
        let runs =
            threads::side_by_side(py, || batch.rollout(steps, kind.of(controls.as_ref()))?.all())?;
        let runs = runs.map_err(|error| errors::batch(py, &error))?;
        let scenes = self.environments.scenes().cloned().collect();
        Ok(Rollouts::new(self.scene.clone_ref(py), scenes, runs, steps, self.kappa))
    }

    fn __repr__(&self) -> String {
        let name = &self.scene.get().scene.def().name;
        format!("<tangency.Batch: {} environments of {name:?}>", self.environments.len())
    }
}
