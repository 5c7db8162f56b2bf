//! Fits parameters: gradient descent as in the paper, L-BFGS, Gauss–Newton, each from the crate of plans.
//!
//! The last two work in coordinates z in which no trial is refused: z = ln p for parameters that
//! must be positive, z = p for others.

use clap::ValueEnum;
use tangency::control::{
    self, Bounds, GradientDescent, LeastSquares, Residuals, SearchError, Slope,
};
use tangency::diff::Parameter;

use crate::Failure;
use crate::loss::Loss;
use crate::objective::Objective;
use crate::observations::Observations;
use crate::simulate::whole;

/// How parameters are fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Method {
    /// p ← p − rate · gradient, each component of the gradient clipped: the paper's recipe
    GradientDescent,
    /// Limited-memory BFGS with Moré and Thuente's line search
    Lbfgs,
    /// Levenberg and Marquardt's damped Gauss–Newton
    GaussNewton,
}

/// When to stop, and how gradient descent steps.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Updates at most.
    pub iterations: usize,
    /// Gradient descent: step per gradient.
    pub rate: f64,
    /// Gradient descent: greatest size of a component of the gradient.
    pub clip: f64,
    /// Gauss–Newton: fit the beginning first, then longer and longer parts of the motion.
    pub continuation: bool,
}

/// A point that a minimiser visited.
#[derive(Clone, Debug, PartialEq)]
pub struct Iterate {
    /// Values of the parameters.
    pub values: Vec<f64>,
    /// The loss there.
    pub loss: f64,
    /// The share of the motion that the loss looked at; 1 except in a continuation.
    pub horizon: f64,
}

/// Is called after every update.
pub type Watch<'a> = &'a mut dyn FnMut(&Iterate);

/// Fits parameters from a start: all iterates, the start first, the best last.
///
/// # Errors
/// A failure at the start; later ones only shorten steps (except in gradient descent).
pub fn fit(
    objective: &Objective<'_>,
    observed: &Observations,
    start: &[f64],
    method: Method,
    settings: &Settings,
    watch: Watch<'_>,
) -> Result<Vec<Iterate>, Failure> {
    if method == Method::GaussNewton && settings.continuation {
        continued_gauss_newton(objective, observed, start, settings, watch)
    } else {
        search(objective, observed, start, method, settings, watch)
    }
}

/// Pairs that L-BFGS remembers.
const MEMORY: usize = 10;

/// One search over the whole motion.
fn search(
    objective: &Objective<'_>,
    observed: &Observations,
    start: &[f64],
    method: Method,
    settings: &Settings,
    watch: Watch<'_>,
) -> Result<Vec<Iterate>, Failure> {
    let mut fit = Fit { objective, observed, loss: Loss::Observed(observed.clone()) };
    let Settings { rate, clip, iterations, .. } = *settings;
    let bounds = bounds(objective.parameters);
    let tell = &mut |iterate: &control::Iterate| watch(&Iterate::of(iterate));
    let found = match method {
        Method::GradientDescent => {
            let method = GradientDescent { rate, clip, iterations };
            method.minimise(&mut fit, start, tell).map_err(SearchError::Objective)
        }
        Method::Lbfgs => {
            let method = control::Lbfgs { bounds, iterations, memory: MEMORY };
            method.minimise(&mut fit, start, tell)
        }
        Method::GaussNewton => {
            let method = control::GaussNewton { bounds, iterations };
            method.minimise(&mut fit, start, tell)
        }
    };
    let found = found.map_err(|error| named(error, objective.parameters))?;
    Ok(found.iter().map(Iterate::of).collect())
}

/// What is fitted to what.
struct Fit<'a> {
    objective: &'a Objective<'a>,
    observed: &'a Observations,
    loss: Loss,
}

impl control::Objective for Fit<'_> {
    type Error = Failure;

    fn evaluate(&mut self, values: &[f64]) -> Result<Slope, Failure> {
        let here = self.objective.evaluate(&self.loss, values)?;
        Ok(Slope { loss: here.loss, gradient: here.gradient })
    }
}

impl LeastSquares for Fit<'_> {
    type Error = Failure;

    fn linearise(&mut self, values: &[f64]) -> Result<Residuals, Failure> {
        self.objective.linearise(self.observed, values)
    }
}

impl Iterate {
    /// Of a search over the whole motion.
    fn of(iterate: &control::Iterate) -> Self {
        Self { values: iterate.point.clone(), loss: iterate.loss, horizon: 1.0 }
    }
}

/// Names the parameter that a search cannot begin with.
fn named(error: SearchError<Failure>, parameters: &[Parameter]) -> Failure {
    match error {
        SearchError::Objective(failure) => failure,
        SearchError::Size { bounds: expected, numbers: found } => {
            Failure::StartCount { expected, found }
        }
        SearchError::Start { index, value, lower, upper } => {
            let name = parameters[index].name.clone();
            Failure::Start { name, value, lower, upper }
        }
    }
}

/// Which parameters must be positive.
fn bounds(parameters: &[Parameter]) -> Vec<Bounds> {
    let of = |p| if must_be_positive(p) { Bounds::POSITIVE } else { Bounds::FREE };
    parameters.iter().map(of).collect()
}

/// Quantities that a scene refuses unless they are positive.
fn must_be_positive(parameter: &Parameter) -> bool {
    const POSITIVE: [&str; 10] = [
        "mass",
        "total_mass",
        "density",
        "inertia",
        "radius",
        "dt",
        "length",
        "motor_max",
        "stiffness",
        "damping",
    ];
    let quantity = parameter.name.split([':', '.']).next().unwrap_or_default();
    POSITIVE.contains(&quantity)
}

/// Gauss–Newton, first for the beginning of the motion and then for longer and longer parts.
///
/// Over a long time the loss has many minima, because the motion after an impact is chaotic; over
/// a short time it has one, and the one found there is a start for the next.
fn continued_gauss_newton(
    objective: &Objective<'_>,
    observed: &Observations,
    start: &[f64],
    settings: &Settings,
    watch: Watch<'_>,
) -> Result<Vec<Iterate>, Failure> {
    let mut trace = Vec::new();
    let mut values = start.to_vec();
    let mut left = settings.iterations;
    let mut horizon = FIRST_HORIZON;
    while horizon < 1.0 && left > 0 {
        let seen = observed.until(horizon * observed.end());
        let part = objective.shortened(steps_until(objective.scene.dt(), seen.end())?);
        horizon *= LONGER;
        if seen.is_empty() {
            continue;
        }
        let rough = Settings { iterations: left.min(ROUGH_ITERATIONS), ..*settings };
        let share = seen.end() / observed.end();
        let found = search(&part, &seen, &values, Method::GaussNewton, &rough, &mut |_| ())?;
        if found.len() > 2 {
            left -= (found.len() - 1).min(left);
            for iterate in found {
                values.clone_from(&iterate.values);
                let iterate = Iterate { horizon: share, ..iterate };
                watch(&iterate);
                trace.push(iterate);
            }
        }
    }
    let rest = Settings { iterations: left, ..*settings };
    trace.extend(search(objective, observed, &values, Method::GaussNewton, &rest, watch)?);
    Ok(trace)
}

/// Share of the motion that a continuation fits first.
const FIRST_HORIZON: f64 = 1.0 / 16.0;
/// How much longer the next part is.
const LONGER: f64 = std::f64::consts::SQRT_2;
/// Updates that a part of the motion gets at most.
const ROUGH_ITERATIONS: usize = 30;
/// Steps that reach a time, or go a little beyond it.
///
/// # Errors
/// [`Failure::TooManySteps`].
pub fn steps_until(dt: f64, time: f64) -> Result<usize, Failure> {
    whole((time / dt - 1e-9).ceil(), dt)
}
