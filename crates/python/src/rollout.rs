//! Runs of one scene, and their derivatives.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use numpy::{IntoPyArray, PyArray1, PyArray3, PyArrayDyn};
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use tangency::{GradientMode, RolloutVector, RowImpulse, StateVector};

use crate::arrays::{self, Numbers};
use crate::controls::{Controls, Policy};
use crate::gradient::Gradient;
use crate::impulse::{self, Impulse};
use crate::picture::Corners;
use crate::report::GradientReport;
use crate::scene::Scene;
use crate::seeds::{self, Bars};
use crate::solver::Solver;
use crate::step_jacobian::StepJacobian;
use crate::{errors, picture, state, threads};

/// A run, with everything that its derivatives need.
///
/// `rollout` makes them. Runs never change, can be pickled, and may be used from several threads at once.
#[pyclass(frozen, module = "tangency")]
pub(crate) struct Rollout {
    scene: Py<Scene>,
    run: Arc<tangency::Rollout>,
    /// Where derivatives are smoothed, how much (see `smoothed`); otherwise None.
    #[pyo3(get)]
    kappa: Option<f64>,
}

/// What a pickle holds.
type Kept<'py> = (Py<Scene>, Bound<'py, PyBytes>, Option<f64>);

/// Runs a scene.
///
/// Parameters
/// ----------
/// scene : Scene
///     What moves.
/// steps : int, optional
///     How many steps; as many as there are controls, or else those of the scene's duration, unless given.
/// controls : array_like, shape (steps, channels), or callable, optional
///     The control of every step, or a policy: ``controls(k, state)`` is called before step k with the
///     `State` there and returns ``channels`` numbers. Zero unless given.
/// state : State or (q, v) or (q, v, time), optional
///     Where the run begins; the scene's initial state unless given.
/// backend : str
///     Solver of the complementarity problems, one of `backends`.
/// tolerance : float, optional
///     Its tolerance, in (0, 1); its own unless given. Backends that pivot have none.
///
/// Returns
/// -------
/// Rollout
///
/// Raises
/// ------
/// StepError
///     If a step cannot be solved to the scene's tolerance, or a control is not finite. There is no wrong
///     state instead.
/// ValueError
///     If an array has another shape or the state is not finite.
///
/// Notes
/// -----
/// What the policy raises comes out of `rollout` as it was raised.
#[pyfunction]
#[pyo3(signature = (scene, steps = None, controls = None, *, state = None, backend = "ipm", tolerance = None))]
pub(crate) fn rollout<'py>(
    py: Python<'py>,
    scene: Py<Scene>,
    steps: Option<usize>,
    controls: Option<&Bound<'py, PyAny>>,
    state: Option<&Bound<'py, PyAny>>,
    backend: &str,
    tolerance: Option<f64>,
) -> PyResult<Rollout> {
    let it = scene.get().scene.clone();
    let solver = Solver::new(backend, tolerance)?.backend;
    let initial = state::from_python(&it, state)?;
    let (controls, steps) = Controls::new(&it, controls, steps, scene.get().steps())?;
    let run = match controls {
        Controls::Policy(policy) => {
            let mut policy = Policy::new(policy, &it);
            let run = threads::alone(py, &it, || {
                tangency::rollout(&it, &*solver, initial, steps, |k, state| {
                    policy.control(k, state)
                })
            })?;
            if let Some(failure) = policy.failure {
                return Err(failure);
            }
            run
        }
        Controls::Zero => threads::alone(py, &it, || {
            let zeros = vec![0.0; it.controls().len()];
            tangency::rollout(&it, &*solver, initial, steps, |_, _| zeros.clone())
        })?,
        Controls::Planned(u) => threads::alone(py, &it, || {
            let m = it.controls().len();
            let row = |k: usize| u[k * m..(k + 1) * m].to_vec();
            tangency::rollout(&it, &*solver, initial, steps, |k, _| row(k))
        })?,
    };
    Ok(Rollout { scene, run: Arc::new(run.map_err(errors::step)?), kappa: None })
}

impl Rollout {
    fn it(&self) -> &tangency::Scene {
        &self.scene.get().scene
    }

    fn shape(&self) -> [usize; 3] {
        [self.run.records.len() + 1, self.it().bodies().len(), 3]
    }

    /// The index of a state; negative ones count from the end.
    fn index(&self, k: isize) -> PyResult<usize> {
        let count = self.run.records.len() + 1;
        let index = if k < 0 { count.checked_add_signed(k) } else { k.try_into().ok() };
        let none = || PyIndexError::new_err(format!("there is no state {k}; there are {count}"));
        index.filter(|index| *index < count).ok_or_else(none)
    }

    fn record(&self, step: usize) -> PyResult<&tangency::StepRecord> {
        let steps = self.run.records.len();
        let none =
            || PyIndexError::new_err(format!("there is no step {step}; the run has {steps}"));
        self.run.records.get(step).ok_or_else(none)
    }

    /// The direction in which everything changes.
    fn direction(
        &self,
        q0: Option<Numbers>,
        v0: Option<Numbers>,
        controls: Option<Numbers>,
        values: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<RolloutVector> {
        let values = match values {
            Some(values) => values.extract::<BTreeMap<String, f64>>()?,
            None => BTreeMap::new(),
        };
        direction(&self.scene.get().scene, self.run.records.len(), q0, v0, controls, &values)
    }
}

/// A direction of a run's inputs: its initial state, controls, and named numbers.
pub(crate) fn direction(
    scene: &tangency::Scene,
    steps: usize,
    q0: Option<Numbers>,
    v0: Option<Numbers>,
    controls: Option<Numbers>,
    values: &BTreeMap<String, f64>,
) -> PyResult<RolloutVector> {
    let mut along = RolloutVector::zeros(scene, steps);
    for (name, rate) in values {
        let parameter = tangency::Parameter::parse(scene, name).map_err(errors::scene)?;
        parameter.targets.iter().for_each(|(param, scale)| along.add(scene, *param, rate * scale));
    }
    let bodies = scene.bodies().len();
    let initial = &mut along.initial;
    for (what, given, to) in [("q0", q0, &mut initial.q), ("v0", v0, &mut initial.v)] {
        let Some(given) = given else { continue };
        given.expect(what, "(bodies, 3)", &[bodies, 3])?;
        to.iter_mut().zip(given.triples()).for_each(|(to, add)| *to += add);
    }
    if let Some(given) = controls {
        let channels = scene.controls().len();
        given.expect("controls", "(steps, channels)", &[steps, channels])?;
        let rows = given.values.chunks(channels.max(1));
        along.controls.iter_mut().zip(rows).for_each(|(to, row)| to.copy_from_slice(row));
    }
    Ok(along)
}

#[pymethods]
impl Rollout {
    /// The scene that ran.
    #[getter]
    fn scene<'py>(&self, py: Python<'py>) -> Bound<'py, Scene> {
        self.scene.bind(py).clone()
    }

    /// Number of steps.
    #[getter]
    fn steps(&self) -> usize {
        self.run.records.len()
    }

    fn __len__(&self) -> usize {
        self.run.records.len()
    }

    /// Poses (m, m, rad) of all bodies, shape (steps + 1, bodies, 3); the initial ones first.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        arrays::tables(py, self.run.states().map(|state| &state.q[..]), self.shape())
    }

    /// Velocities (m/s, m/s, rad/s) of all bodies, shape (steps + 1, bodies, 3); the initial ones first.
    #[getter]
    fn v<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        arrays::tables(py, self.run.states().map(|state| &state.v[..]), self.shape())
    }

    /// Times of the states, s, shape (steps + 1,).
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.run.states().map(|state| state.time).collect::<Vec<_>>().into_pyarray(py)
    }

    /// Controls of the steps, shape (steps, channels); those of a policy as it gave them.
    #[getter]
    fn controls<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let values = self.run.records.iter().flat_map(|record| record.control.clone()).collect();
        arrays::array(py, values, &[self.run.records.len(), self.it().controls().len()])
    }

    /// One state of the run.
    ///
    /// Parameters
    /// ----------
    /// step : int
    ///     Which: 0 is the initial one, -1 the last one.
    ///
    /// Returns
    /// -------
    /// State
    ///
    /// Raises
    /// ------
    /// IndexError
    ///     If there is no such state.
    fn state<'py>(&self, py: Python<'py>, step: isize) -> PyResult<Bound<'py, PyAny>> {
        state::to_python(py, self.run.state(self.index(step)?))
    }

    /// The last state.
    #[getter]
    fn last<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        state::to_python(py, self.run.last())
    }

    /// Worst scaled residual of any step's problem.
    #[getter]
    fn residual(&self) -> f64 {
        self.run.residual()
    }

    /// Mechanical energy of every state, J, shape (steps + 1,).
    #[getter]
    fn energy<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let energies: Vec<f64> = self.run.states().map(|state| self.it().energy(state)).collect();
        energies.into_pyarray(py)
    }

    /// Contacts that push in a step.
    ///
    /// Parameters
    /// ----------
    /// step : int
    ///     Which step.
    ///
    /// Returns
    /// -------
    /// list of dict
    ///     ``bodies`` (two names, a and b), ``point`` (m), ``normal`` (from a to b), ``gap`` (m, before the
    ///     step), ``normal_impulse`` and ``tangent_impulse`` (on b, N·s; the tangent is the normal turned by
    ///     +90°). Where impacts divide the step, those of its parts come first.
    ///
    /// Raises
    /// ------
    /// IndexError
    ///     If there is no such step.
    fn contacts<'py>(&self, py: Python<'py>, step: usize) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let record = self.record(step)?;
        let one = |record: &tangency::StepRecord, push: &tangency::ContactImpulse| {
            let contact = &record.contacts[push.contact];
            let names =
                contact.feature.id.bodies.map(|body| &self.it().bodies()[body as usize].name);
            let all = PyDict::new(py);
            all.set_item("bodies", (names[0], names[1]))?;
            all.set_item("point", (push.point.x, push.point.y))?;
            all.set_item("normal", (push.direction.x, push.direction.y))?;
            all.set_item("gap", contact.gap)?;
            all.set_item("normal_impulse", push.normal)?;
            all.set_item("tangent_impulse", push.tangent)?;
            Ok(all)
        };
        let records = record.parts.iter().chain([record]);
        let pushes = records.flat_map(|record| {
            record.contact_impulses().into_iter().map(move |push| (record, push))
        });
        pushes.map(|(record, push)| one(record, &push)).collect()
    }

    /// Impulses of all rows of a step, those of its parts first.
    ///
    /// Parameters
    /// ----------
    /// step : int
    ///     Which step.
    ///
    /// Returns
    /// -------
    /// list of Impulse
    ///     Losses may depend on them: see `gradient`.
    ///
    /// Raises
    /// ------
    /// IndexError
    ///     If there is no such step.
    fn impulses(&self, step: usize) -> PyResult<Vec<Impulse>> {
        Ok(impulse::of_step(self.it(), step, self.record(step)?))
    }

    /// What a step modelled and what it cost.
    ///
    /// Parameters
    /// ----------
    /// step : int
    ///     Which step.
    ///
    /// Returns
    /// -------
    /// dict of str to int
    ///     ``free_bodies``, ``linear_islands``, ``lcp_islands``, ``rows``, ``contacts``, ``iterations``,
    ///     ``factorisations``, ``displacements`` that mended positions; islands that let position errors stay
    ///     (``loose_islands``), gave up restitution (``plastic_islands``) or could only be mended in part
    ///     (``soft_islands``); and ``impacts`` that divide the step.
    ///
    /// Raises
    /// ------
    /// IndexError
    ///     If there is no such step.
    fn counts<'py>(&self, py: Python<'py>, step: usize) -> PyResult<Bound<'py, PyDict>> {
        let counts = self.record(step)?.counts(self.it());
        let all = PyDict::new(py);
        all.set_item("free_bodies", counts.free_bodies)?;
        all.set_item("linear_islands", counts.linear_islands)?;
        all.set_item("lcp_islands", counts.lcp_islands)?;
        all.set_item("rows", counts.rows)?;
        all.set_item("contacts", counts.contacts)?;
        all.set_item("iterations", counts.iterations)?;
        all.set_item("factorisations", counts.factorisations)?;
        all.set_item("displacements", counts.displacements)?;
        all.set_item("loose_islands", counts.loose_islands)?;
        all.set_item("plastic_islands", counts.plastic_islands)?;
        all.set_item("soft_islands", counts.soft_islands)?;
        all.set_item("impacts", counts.impacts)?;
        Ok(all)
    }

    /// The gradient of a loss over the run, by reverse mode: one transposed linear solve per island and step.
    ///
    /// Parameters
    /// ----------
    /// q, v : array_like, shape (bodies, 3) or (steps + 1, bodies, 3), optional
    ///     ∂L/∂q and ∂L/∂v: of the last state alone, or of all states. Zero unless given.
    /// wrt : list of str
    ///     Names of numbers, as of `Scene.value`, that ``values`` of the result will have; ``gradient[name]``
    ///     gives all others as well.
    /// impulses : list of (Impulse, float)
    ///     ∂L/∂impulse for every impulse that the loss sees, each as `impulses` gave it.
    ///
    /// Returns
    /// -------
    /// Gradient
    ///
    /// Raises
    /// ------
    /// GradientError
    ///     If a seed is not finite, or a linear system of the way back is singular.
    /// SceneError
    ///     If the scene has no number of a name.
    /// ValueError
    ///     If a seed has another shape.
    #[pyo3(
        signature = (q = None, v = None, *, wrt = Vec::new(), impulses = Vec::new()),
        text_signature = "($self, q=None, v=None, *, wrt=(), impulses=())"
    )]
    fn gradient(
        &self,
        py: Python<'_>,
        q: Option<Numbers>,
        v: Option<Numbers>,
        wrt: Vec<String>,
        impulses: Vec<(PyRef<'_, Impulse>, f64)>,
    ) -> PyResult<Gradient> {
        let wrt = self.scene.get().parameters(&wrt)?;
        let [states, bodies, _] = self.shape();
        let read = |what, given| -> PyResult<Bars> {
            Ok(Bars::read(what, given, &[], states - 1, bodies)?.swap_remove(0))
        };
        let (q, v) = (read("q", q)?, read("v", v)?);
        let mut by_step: BTreeMap<usize, Vec<RowImpulse>> = BTreeMap::new();
        for (impulse, value) in &impulses {
            by_step
                .entry(impulse.step)
                .or_default()
                .push(RowImpulse { value: *value, ..impulse.row });
        }
        let seed = |k: usize, state: &tangency::State| {
            let mut bar = StateVector::like(state);
            seeds::add(&q, &v, k, &mut bar);
            Some(bar)
        };
        let (scene, run) = (self.it(), &*self.run);
        let found = threads::alone(py, scene, || {
            if by_step.is_empty() {
                let add =
                    |k, _: &tangency::State, bar: &mut StateVector| seeds::add(&q, &v, k, bar);
                return tangency::gradient_adding(scene, run, add);
            }
            tangency::gradient_with_impulses(scene, run, seed, |k, _| {
                by_step.get(&k).cloned().unwrap_or_default()
            })
        })?;
        let found = found.map_err(errors::gradient)?;
        let report = Py::new(py, GradientReport::new(scene, run, &found.report))?;
        Ok(Gradient { scene: self.scene.get().scene.clone(), by: found.by, wrt, report })
    }

    /// How all states change along one direction of the run's inputs, by forward mode.
    ///
    /// Parameters
    /// ----------
    /// q0, v0 : array_like, shape (bodies, 3), optional
    ///     Change of the initial state. Zero unless given.
    /// controls : array_like, shape (steps, channels), optional
    ///     Change of the controls. Zero unless given.
    /// values : dict of str to float, optional
    ///     Rates of named numbers, as of `Scene.value`.
    ///
    /// Returns
    /// -------
    /// dq, dv : ndarray, shape (steps + 1, bodies, 3)
    ///     Change of all poses and velocities per unit along the direction.
    ///
    /// Raises
    /// ------
    /// GradientError
    ///     If the direction is not finite, or a linear system on the way is singular.
    /// SceneError
    ///     If the scene has no number of a name.
    /// ValueError
    ///     If an array has another shape.
    #[pyo3(signature = (*, q0 = None, v0 = None, controls = None, values = None))]
    #[expect(clippy::type_complexity, reason = "a pair of arrays")]
    fn tangent<'py>(
        &self,
        py: Python<'py>,
        q0: Option<Numbers>,
        v0: Option<Numbers>,
        controls: Option<Numbers>,
        values: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<(Bound<'py, PyArray3<f64>>, Bound<'py, PyArray3<f64>>)> {
        let along = self.direction(q0, v0, controls, values)?;
        let changes =
            threads::alone(py, self.it(), || tangency::tangent(self.it(), &self.run, &along))?;
        let changes = changes.map_err(errors::gradient)?;
        let q = arrays::tables(py, changes.iter().map(|change| &change.q[..]), self.shape())?;
        let v = arrays::tables(py, changes.iter().map(|change| &change.v[..]), self.shape())?;
        Ok((q, v))
    }

    /// All derivatives of one step.
    ///
    /// Parameters
    /// ----------
    /// step : int
    ///     Which step.
    /// wrt : list of str
    ///     Names of numbers, as of `Scene.value`, for the columns of ``parameters``.
    ///
    /// Returns
    /// -------
    /// StepJacobian
    ///
    /// Raises
    /// ------
    /// GradientError
    ///     If a linear system of the step is singular.
    /// IndexError
    ///     If there is no such step.
    /// SceneError
    ///     If the scene has no number of a name.
    #[pyo3(
        signature = (step, *, wrt = Vec::new()),
        text_signature = "($self, step, *, wrt=())"
    )]
    fn step_jacobian(
        &self,
        py: Python<'_>,
        step: usize,
        wrt: Vec<String>,
    ) -> PyResult<StepJacobian> {
        let (record, parameters) = (self.record(step)?, self.scene.get().parameters(&wrt)?);
        let before = self.run.state(step);
        let found =
            py.detach(|| tangency::diff::step_jacobian(self.it(), before, record, &parameters));
        Ok(StepJacobian { found: found.map_err(errors::gradient)?, wrt })
    }

    /// The same run, prepared for derivatives along the central path.
    ///
    /// States and impulses stay as they are; derivatives are those of the problem in which every
    /// complementarity product is `kappa` instead of 0, so that contacts just out of touch and bodies that
    /// friction holds have some, too.
    ///
    /// Parameters
    /// ----------
    /// kappa : float
    ///     The products, scaled without unit; 1e-4 is a good first choice, less is sharper.
    ///
    /// Returns
    /// -------
    /// Rollout
    ///
    /// Raises
    /// ------
    /// GradientError
    ///     If `kappa` is not positive and finite, or a point of the path is not found.
    /// ValueError
    ///     If the run is smoothed already.
    fn smoothed(&self, py: Python<'_>, kappa: f64) -> PyResult<Self> {
        if self.kappa.is_some() {
            return Err(PyValueError::new_err(
                "the run is smoothed; take the one it was made from",
            ));
        }
        let mut run = (*self.run).clone();
        let mode = GradientMode::Smoothed { kappa };
        py.detach(|| mode.prepare(&mut run)).map_err(errors::gradient)?;
        Ok(Self { scene: self.scene.clone_ref(py), run: Arc::new(run), kappa: Some(kappa) })
    }

    /// A picture of state k, -1 for the last one.
    ///
    /// Parameters
    /// ----------
    /// k : int
    ///     Which state, from -1 - steps to steps.
    /// width, height : int
    ///     Pixels, 1 to 8000.
    /// view : (float, float, float, float), optional
    ///     What part of the world it holds: x from, to, y from, to, m; fitted to the whole run unless given.
    ///
    /// Returns
    /// -------
    /// ndarray of uint8, shape (height, width, 3)
    ///     Red, green and blue, from the top left.
    ///
    /// Raises
    /// ------
    /// IndexError
    ///     If there is no such state.
    /// ValueError
    ///     If there is no such size or view.
    #[pyo3(signature = (k, width = 600, height = 400, *, view = None))]
    fn picture<'py>(
        &self,
        py: Python<'py>,
        k: isize,
        width: u32,
        height: u32,
        view: Option<Corners>,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let state = self.run.state(self.index(k)?);
        let view = picture::view(self.it(), view, self.run.states())?;
        picture::rgb(py, &picture::draw(py, self.it(), state, (width, height), view)?)
    }

    /// The HTML page that plays the run in a browser, without a network.
    ///
    /// Parameters
    /// ----------
    /// title : str, optional
    ///     Its title; the scene's name unless given.
    ///
    /// Returns
    /// -------
    /// str
    ///     All of it; of long runs every few steps, so that it has a few MB at most.
    #[pyo3(signature = (title = None))]
    fn replay(&self, py: Python<'_>, title: Option<&str>) -> String {
        py.detach(|| picture::page(self.it(), &self.run, title))
    }

    /// Writes the page that `replay` makes.
    ///
    /// Parameters
    /// ----------
    /// path : str or path
    ///     The file.
    /// title : str, optional
    ///     The page's title; the scene's name unless given.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     If the file cannot be written.
    #[pyo3(signature = (path, title = None))]
    fn save_replay(&self, py: Python<'_>, path: PathBuf, title: Option<&str>) -> PyResult<()> {
        Ok(std::fs::write(path, self.replay(py, title))?)
    }

    /// The page inside of a frame, for notebooks.
    fn _repr_html_(&self, py: Python<'_>) -> String {
        picture::inline(&self.replay(py, None))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Kept<'py>)> {
        let rebuild = py.get_type::<Self>().getattr(intern!(py, "_rebuild"))?;
        let bytes = rmp_serde::to_vec(&*self.run).map_err(errors::value)?;
        Ok((rebuild, (self.scene.clone_ref(py), PyBytes::new(py, &bytes), self.kappa)))
    }

    #[staticmethod]
    fn _rebuild(
        py: Python<'_>,
        scene: Py<Scene>,
        bytes: &[u8],
        kappa: Option<f64>,
    ) -> PyResult<Self> {
        let run = rmp_serde::from_slice(bytes).map_err(errors::value)?;
        let exact = Self { scene, run: Arc::new(run), kappa: None };
        match kappa {
            None => Ok(exact),
            Some(kappa) => exact.smoothed(py, kappa),
        }
    }

    fn __repr__(&self) -> String {
        let [states, bodies, _] = self.shape();
        format!(
            "<tangency.Rollout: {} steps of {bodies} bodies, worst residual {:.1e}>",
            states - 1,
            self.run.residual()
        )
    }
}
