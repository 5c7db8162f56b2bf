//! Plans by iterative LQR.

use nalgebra::{DMatrix, DVector};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;
use tangency::GradientMode;
use tangency::control::{
    ControlLimits, Cost, Ending, PlanError as Error, Planner, Quadratic, SceneDynamics,
};

use crate::arrays::{Numbers, tuple};
use crate::errors::{self, PlanError};
use crate::plan_callbacks::{Failure, PythonCost, PythonDynamics};
use crate::scene::Scene;
use crate::solver::Solver;
use crate::state;

/// Controls, the motion that they make, and how to keep to it; `plan` makes them.
#[pyclass(frozen, module = "tangency")]
pub(crate) struct Plan {
    plan: tangency::control::Plan,
}

#[pymethods]
impl Plan {
    /// u, shape (steps, channels).
    #[getter]
    fn controls<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let shape = [self.plan.controls.len(), self.plan.limits.lower().len()];
        self.plan.controls.concat().into_pyarray(py).reshape(shape)
    }

    /// x, shape (steps + 1, states).
    #[getter]
    fn states<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let shape = [self.plan.states.len(), self.plan.states.first().map_or(0, DVector::len)];
        let values: Vec<f64> = self.plan.states.iter().flatten().copied().collect();
        values.into_pyarray(py).reshape(shape)
    }

    /// K, shape (steps, channels, states); zero where a control is at its limit, and empty if no iteration was
    /// done.
    #[getter]
    fn gains<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let gains = &self.plan.gains;
        let (m, n) = gains.first().map_or((0, 0), DMatrix::shape);
        let rows = gains.iter().flat_map(|gain| gain.transpose().as_slice().to_vec());
        rows.collect::<Vec<f64>>().into_pyarray(py).reshape([gains.len(), m, n])
    }

    /// Cost of the motion.
    #[getter]
    fn cost(&self) -> f64 {
        self.plan.cost
    }

    /// Cost of the first guess and after every iteration that improved it, shape (improvements + 1,).
    #[getter]
    fn history<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.plan.history.clone().into_pyarray(py)
    }

    /// Number of iterations.
    #[getter]
    fn iterations(&self) -> usize {
        self.plan.iterations
    }

    /// Why the search ended: "optimal" (no change of the controls promises anything more), "settled" (the last
    /// step brought next to nothing, as happens at a switch), or None inside an error.
    #[getter]
    fn ending(&self) -> Option<&'static str> {
        self.plan.ending.map(|ending| match ending {
            Ending::Optimal => "optimal",
            Ending::Settled => "settled",
        })
    }

    /// The control of a step in a state that is not quite that of the plan: u + K (x − x̄), within the limits.
    ///
    /// Parameters
    /// ----------
    /// k : int
    ///     Which step.
    /// x : array_like, shape (states,)
    ///     The state.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (channels,)
    ///
    /// Raises
    /// ------
    /// IndexError
    ///     If there is no such step.
    /// ValueError
    ///     If `x` has another shape.
    fn feedback<'py>(
        &self,
        py: Python<'py>,
        k: usize,
        x: Numbers,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let steps = self.plan.gains.len();
        if k >= steps {
            return Err(PyIndexError::new_err(format!(
                "there is no step {k}; the plan has {steps}"
            )));
        }
        x.expect("x", "(states,)", &[self.plan.states[k].len()])?;
        Ok(self.plan.feedback(k, &x.vector()).into_pyarray(py))
    }

    fn __repr__(&self) -> String {
        let steps = self.plan.controls.len();
        format!("<tangency.Plan: {steps} steps, cost {:.6e}>", self.plan.cost)
    }
}

/// Plans controls that make a cost small: iterative LQR with limits on the controls.
///
/// After Tassa, Mansard and Todorov, *Control-Limited Differential Dynamic Programming*, ICRA 2014.
///
/// Parameters
/// ----------
/// dynamics : Scene or object
///     What moves: a scene, with x as in `Scene.coordinates`; or an object with the attributes ``states``
///     and ``controls`` (n and m) and the methods ``step(x, u)``, which returns x⁺, and
///     ``linearise(x, u)``, which returns A = ∂x⁺/∂x and B = ∂x⁺/∂u.
/// cost : Quadratic or object
///     What it costs: a `Quadratic`, or an object with the methods ``running(k, x, u)`` and ``last(x)``,
///     which return numbers, ``running_expansion(k, x, u)``, which returns (∂l/∂x, ∂l/∂u, ∂²l/∂x²,
///     ∂²l/∂u∂x of shape (m, n), ∂²l/∂u²), and ``last_expansion(x)``, which returns (∂l/∂x, ∂²l/∂x²).
/// controls : array_like, shape (steps, channels)
///     The first guess; it also says how many steps there are.
/// state : State or (q, v), or array_like of shape (n,) for dynamics of one's own, optional
///     Where the motion begins; a scene's initial state unless given.
/// lower, upper : float or array_like, shape (channels,), optional
///     Limits of the controls.
/// backend : str
///     Solver of the complementarity problems of a scene, one of `backends`.
/// kappa : float, optional
///     Smooths the derivatives of a scene, as `Rollout.smoothed` does.
/// max_iterations : int
///     Most iterations.
/// tolerance : float
///     A promised or achieved decrease of less than this part of the cost ends the search.
///
/// Returns
/// -------
/// Plan
///
/// Raises
/// ------
/// PlanError
///     If the first guess cannot be followed, or the search ends early: ``plan`` is then the best one so far.
/// ValueError
///     If something does not fit: a shape, a limit, a number that is not finite.
///
/// Notes
/// -----
/// What a method of `dynamics` or `cost` raises comes out of `plan` as it was raised.
#[pyfunction]
#[pyo3(signature = (
    dynamics, cost, controls, *, state = None, lower = None, upper = None, backend = "ipm", kappa = None,
    max_iterations = 500, tolerance = 1e-9
))]
#[expect(clippy::too_many_arguments, reason = "they are keywords")]
pub(crate) fn plan<'py>(
    py: Python<'py>,
    dynamics: &Bound<'py, PyAny>,
    cost: &Bound<'py, PyAny>,
    controls: Numbers,
    state: Option<&Bound<'py, PyAny>>,
    lower: Option<Numbers>,
    upper: Option<Numbers>,
    backend: &str,
    kappa: Option<f64>,
    max_iterations: usize,
    tolerance: f64,
) -> PyResult<Plan> {
    let [_, m] = controls.shape[..] else {
        let message =
            format!("controls has shape {}; give (steps, channels)", tuple(&controls.shape));
        return Err(PyValueError::new_err(message));
    };
    let guess: Vec<Vec<f64>> = controls.values.chunks(m.max(1)).map(<[f64]>::to_vec).collect();
    let limit = |what: &str, given: Option<Numbers>, none: f64| -> PyResult<Vec<f64>> {
        match given {
            None => Ok(vec![none; m]),
            Some(one) if one.shape.is_empty() => Ok(vec![one.values[0]; m]),
            Some(many) => many.expect(what, "(channels,)", &[m]).map(|()| many.values),
        }
    };
    let lower = limit("lower", lower, f64::NEG_INFINITY)?;
    let upper = limit("upper", upper, f64::INFINITY)?;
    let limits = ControlLimits::new(lower, upper).map_err(errors::value)?;
    let planner = Planner { max_iterations, tolerance, ..Planner::default() };
    let failure = Failure::default();
    let quadratic = quadratic(cost)?;
    let python = PythonCost { object: cost.clone(), failure: &failure };
    let cost: &dyn Cost = quadratic.as_ref().map_or(&python as &dyn Cost, |it| it);
    let found = if let Ok(scene) = dynamics.cast::<Scene>() {
        let (scene, solver) = (scene.get().scene.clone(), Solver::new(backend, None)?.backend);
        let initial = state::from_python(&scene, state)?;
        let mode = kappa.map_or(GradientMode::Exact, |kappa| GradientMode::Smoothed { kappa });
        let mut moving = SceneDynamics::new(&scene, &*solver).with_gradient_mode(mode);
        planner.plan(&mut moving, cost, &limits, &initial, &guess)
    } else {
        let states = dynamics.getattr("states")?.extract()?;
        let controls = dynamics.getattr("controls")?.extract()?;
        let given = state.ok_or_else(|| PyValueError::new_err("give the initial `state`, x"))?;
        let initial: Numbers = given.extract()?;
        initial.expect("state", "(states,)", &[states])?;
        let object = dynamics.clone();
        let mut moving = PythonDynamics { object, states, controls, failure: &failure };
        planner.plan(&mut moving, cost, &limits, &initial.vector(), &guess)
    };
    if let Some(failure) = failure.take() {
        return Err(failure);
    }
    found.map(|plan| Plan { plan }).map_err(|error| refused(py, error))
}

/// The weights of a `tangency.Quadratic`; none for anything else.
fn quadratic(cost: &Bound<'_, PyAny>) -> PyResult<Option<Quadratic>> {
    let module = cost.py().import("tangency.control")?;
    if !cost.is_instance(&module.getattr("Quadratic")?)? {
        return Ok(None);
    }
    let get = |name: &str| -> PyResult<Numbers> { cost.getattr(name)?.extract() };
    Ok(Some(Quadratic {
        target: get("target")?.vector(),
        rest: get("rest")?.vector(),
        state: get("state")?.matrix("state")?,
        control: get("control")?.matrix("control")?,
        last: get("last")?.matrix("last")?,
    }))
}

/// Input that does not fit, or a search that ended early, with the best plan so far.
fn refused(py: Python<'_>, error: Error) -> PyErr {
    let text = error.to_string();
    let (Error::Iterations { plan, .. } | Error::Stuck { plan, .. }) = error else {
        return match error {
            Error::Dynamics { .. } => PlanError::new_err(text),
            _ => PyValueError::new_err(text),
        };
    };
    errors::with(py, PlanError::new_err(text), "plan", Plan { plan: *plan })
}
