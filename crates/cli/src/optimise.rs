//! Minimisers of an [`Objective`]: gradient descent as in the paper, L-BFGS, Gauss–Newton.
//!
//! The last two work in coordinates z in which no trial is refused: z = ln p for parameters that
//! must be positive, z = p for others. Trials at which a step fails count as infinitely bad.

use argmin::core::{CostFunction, Executor, Gradient, State as _};
use argmin::solver::linesearch::BacktrackingLineSearch;
use argmin::solver::linesearch::condition::ArmijoCondition;
use argmin::solver::quasinewton::LBFGS;
use clap::ValueEnum;
use nalgebra::{DMatrix, DVector};
use tangency::diff::Parameter;

use crate::loss::Loss;
use crate::objective::{Linearisation, Objective};
use crate::observations::Observations;
use crate::Failure;

/// How parameters are fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Method {
    /// p ← p − rate · gradient, each component of the gradient clipped: the paper's recipe
    GradientDescent,
    /// Limited-memory BFGS with a backtracking line search
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
    match method {
        Method::GradientDescent => gradient_descent(objective, observed, start, settings, watch),
        Method::Lbfgs => lbfgs(objective, observed, start, settings, watch),
        Method::GaussNewton if settings.continuation => {
            continued_gauss_newton(objective, observed, start, settings, watch)
        }
        Method::GaussNewton => gauss_newton(objective, observed, start, settings, watch),
    }
}

/// p ← p − rate · clip(gradient).
fn gradient_descent(
    objective: &Objective<'_>,
    observed: &Observations,
    start: &[f64],
    settings: &Settings,
    watch: Watch<'_>,
) -> Result<Vec<Iterate>, Failure> {
    let loss = Loss::Observed(observed.clone());
    let mut values = start.to_vec();
    let mut trace = Vec::new();
    for _ in 0..settings.iterations {
        let here = objective.evaluate(&loss, &values)?;
        push(&mut trace, values.clone(), here.loss, 1.0, watch);
        for (value, slope) in values.iter_mut().zip(&here.gradient) {
            *value -= settings.rate * slope.clamp(-settings.clip, settings.clip);
        }
    }
    let last = objective.value(&loss, &values)?;
    push(&mut trace, values, last, 1.0, watch);
    Ok(trace)
}

fn push(trace: &mut Vec<Iterate>, values: Vec<f64>, loss: f64, horizon: f64, watch: Watch<'_>) {
    let iterate = Iterate { values, loss, horizon };
    watch(&iterate);
    trace.push(iterate);
}

/// Coordinates without bounds.
struct Chart {
    positive: Vec<bool>,
}

impl Chart {
    fn new(parameters: &[Parameter]) -> Self {
        Self { positive: parameters.iter().map(must_be_positive).collect() }
    }

    /// z of p.
    fn coordinates(&self, values: &[f64]) -> Vec<f64> {
        let pairs = values.iter().zip(&self.positive);
        pairs.map(|(p, positive)| if *positive { p.ln() } else { *p }).collect()
    }

    /// p of z.
    fn values(&self, z: &[f64]) -> Vec<f64> {
        let pairs = z.iter().zip(&self.positive);
        pairs.map(|(z, positive)| if *positive { z.exp() } else { *z }).collect()
    }

    /// dp/dz, one per parameter.
    fn slopes(&self, values: &[f64]) -> Vec<f64> {
        let pairs = values.iter().zip(&self.positive);
        pairs.map(|(p, positive)| if *positive { *p } else { 1.0 }).collect()
    }
}

/// Quantities that a scene refuses unless they are positive.
fn must_be_positive(parameter: &Parameter) -> bool {
    const POSITIVE: [&str; 10] = [
        "mass", "total_mass", "density", "inertia", "radius", "dt", "length", "motor_max",
        "stiffness", "damping",
    ];
    let quantity = parameter.name.split([':', '.']).next().unwrap_or_default();
    POSITIVE.contains(&quantity)
}

/// The loss as argmin sees it.
struct LossOfCoordinates<'a> {
    objective: &'a Objective<'a>,
    loss: &'a Loss,
    chart: &'a Chart,
}

impl CostFunction for LossOfCoordinates<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, z: &Vec<f64>) -> Result<f64, argmin::core::Error> {
        Ok(self.objective.value(self.loss, &self.chart.values(z)).unwrap_or(f64::INFINITY))
    }
}

impl Gradient for LossOfCoordinates<'_> {
    type Param = Vec<f64>;
    type Gradient = Vec<f64>;

    fn gradient(&self, z: &Vec<f64>) -> Result<Vec<f64>, argmin::core::Error> {
        let values = self.chart.values(z);
        let here = self.objective.evaluate(self.loss, &values)?;
        Ok(here.gradient.iter().zip(self.chart.slopes(&values)).map(|(g, s)| g * s).collect())
    }
}
