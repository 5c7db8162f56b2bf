//! One environment, step by step.

use std::sync::Arc;

use numpy::PyArray2;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use tangency::{State, StepRecord, StepScratch};

use crate::arrays::{self, Numbers};
use crate::impulse::{self, Impulse};
use crate::scene::Scene;
use crate::solver::Solver;
use crate::{errors, state, threads};

/// One environment, step by step; keeps its last step only.
///
/// Memory stays flat and nothing is recorded: to differentiate, take `rollout`. A simulator can be pickled
/// and then goes on to the same bits. One thread at a time may step it.
///
/// Parameters
/// ----------
/// scene : Scene
///     What moves.
/// state : State or (q, v) or (q, v, time), optional
///     Where it begins; the scene's initial state unless given.
/// backend : str
///     Solver of the complementarity problems, one of `backends`.
/// tolerance : float, optional
///     Its tolerance, in (0, 1); its own unless given. Backends that pivot have none.
///
/// Raises
/// ------
/// ValueError
///     If the state, the backend or the tolerance does not fit.
#[pyclass(module = "tangency")]
pub(crate) struct Simulator {
    scene: Py<Scene>,
    it: Arc<tangency::Scene>,
    solver: Solver,
    start: State,
    last: Option<StepRecord>,
    scratch: StepScratch,
    steps: usize,
}

/// What a pickle holds.
type Kept<'py> = (Py<Scene>, String, Option<f64>, usize, Bound<'py, PyBytes>);

impl Simulator {
    fn current(&self) -> &State {
        self.last.as_ref().map_or(&self.start, |record| &record.after)
    }
}

#[pymethods]
impl Simulator {
    #[new]
    #[pyo3(signature = (scene, state = None, *, backend = "ipm", tolerance = None))]
    fn new(
        scene: Py<Scene>,
        state: Option<&Bound<'_, PyAny>>,
        backend: &str,
        tolerance: Option<f64>,
    ) -> PyResult<Self> {
        let it = scene.get().scene.clone();
        let (solver, start) = (Solver::new(backend, tolerance)?, state::from_python(&it, state)?);
        Ok(Self { scene, it, solver, start, last: None, scratch: StepScratch::default(), steps: 0 })
    }

    /// The scene.
    #[getter]
    fn scene<'py>(&self, py: Python<'py>) -> Bound<'py, Scene> {
        self.scene.bind(py).clone()
    }

    /// The state that it has come to, a `State`.
    #[getter]
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        state::to_python(py, self.current())
    }

    /// Poses (m, m, rad) now, shape (bodies, 3).
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        arrays::triples(py, &self.current().q)
    }

    /// Velocities (m/s, m/s, rad/s) now, shape (bodies, 3).
    #[getter]
    fn v<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        arrays::triples(py, &self.current().v)
    }

    /// Time now, s.
    #[getter]
    fn time(&self) -> f64 {
        self.current().time
    }

    /// Steps since the start or the last `reset`.
    #[getter]
    fn steps(&self) -> usize {
        self.steps
    }

    /// Scaled residual of the last step; 0 before the first one.
    #[getter]
    fn residual(&self) -> f64 {
        self.last.as_ref().map_or(0.0, StepRecord::residual)
    }

    /// Takes one step.
    ///
    /// Parameters
    /// ----------
    /// control : array_like, shape (channels,), optional
    ///     A number does for one channel. Zero unless given.
    ///
    /// Returns
    /// -------
    /// State
    ///     Where it is now.
    ///
    /// Raises
    /// ------
    /// StepError
    ///     If the step cannot be solved, or a control is not finite; the simulator stays where it was.
    /// ValueError
    ///     If `control` has another shape.
    #[pyo3(signature = (control = None))]
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        control: Option<Numbers>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let channels = self.it.controls().len();
        let control = match control {
            None => vec![0.0; channels],
            Some(numbers) if numbers.shape.is_empty() && channels == 1 => numbers.values,
            Some(numbers) => {
                numbers.expect("control", "(channels,)", &[channels])?;
                numbers.values
            }
        };
        let (it, start, last, scratch) = (&*self.it, &self.start, &self.last, &mut self.scratch);
        let solver = &*self.solver.backend;
        let record = threads::alone(py, it, || match last {
            Some(before) => tangency::next_step(it, solver, before, &control, scratch),
            None => tangency::step(it, solver, start, &control, scratch),
        })?;
        if let Some(before) = self.last.replace(record.map_err(errors::step)?) {
            self.scratch.recycle(before);
        }
        self.steps += 1;
        state::to_python(py, self.current())
    }

    /// Goes to a state.
    ///
    /// Parameters
    /// ----------
    /// state : State or (q, v) or (q, v, time), optional
    ///     The scene's initial state unless given.
    ///
    /// Returns
    /// -------
    /// State
    ///     Where it is now.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the state does not fit or is not finite.
    #[pyo3(signature = (state = None))]
    fn reset<'py>(
        &mut self,
        py: Python<'py>,
        state: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.start = state::from_python(&self.it, state)?;
        (self.last, self.steps) = (None, 0);
        state::to_python(py, &self.start)
    }

    /// Impulses of all rows of the last step; none before the first one.
    ///
    /// Returns
    /// -------
    /// list of Impulse
    fn impulses(&self) -> Vec<Impulse> {
        let step = self.steps.saturating_sub(1);
        self.last.as_ref().map_or_else(Vec::new, |record| impulse::of_step(&self.it, step, record))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Kept<'py>)> {
        let rebuild = py.get_type::<Self>().getattr(intern!(py, "_rebuild"))?;
        let bytes = rmp_serde::to_vec(&(&self.start, &self.last)).map_err(errors::value)?;
        let (scene, bytes) = (self.scene.clone_ref(py), PyBytes::new(py, &bytes));
        let Solver { name, tolerance, .. } = &self.solver;
        Ok((rebuild, (scene, name.clone(), *tolerance, self.steps, bytes)))
    }

    #[staticmethod]
    fn _rebuild(
        scene: Py<Scene>,
        backend: &str,
        tolerance: Option<f64>,
        steps: usize,
        bytes: &[u8],
    ) -> PyResult<Self> {
        let (start, last) = rmp_serde::from_slice(bytes).map_err(errors::value)?;
        let (it, solver) = (scene.get().scene.clone(), Solver::new(backend, tolerance)?);
        Ok(Self { scene, it, solver, start, last, scratch: StepScratch::default(), steps })
    }

    fn __repr__(&self) -> String {
        format!("<tangency.Simulator of {:?} at {} s>", self.it.def().name, self.current().time)
    }
}
