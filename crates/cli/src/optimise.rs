//! Minimisers of an [`Objective`]: gradient descent as in the paper, L-BFGS, Gauss–Newton.
//!
//! The last two work in coordinates z in which no trial is refused: z = ln p for parameters that
//! must be positive, z = p for others.

#![expect(non_snake_case, reason = "matrices carry their usual names")]

use std::cell::RefCell;
use std::sync::{Arc, Mutex};

use argmin::core::observers::{Observe, ObserverMode};
use argmin::core::{CostFunction, Executor, Gradient, IterState, KV, State as _};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;
use clap::ValueEnum;
use nalgebra::{DMatrix, DVector};
use tangency::diff::Parameter;

use crate::Failure;
use crate::loss::Loss;
use crate::objective::{Linearisation, Objective};
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

/// The loss as argmin sees it: divided by a scale, over coordinates without bounds.
struct ScaledLoss<'a> {
    objective: &'a Objective<'a>,
    loss: Loss,
    chart: &'a Chart,
    scale: f64,
    /// The last point: argmin asks for value and gradient apart.
    last: RefCell<Option<ScaledPoint>>,
}

/// Loss and gradient at a point, all scaled.
#[derive(Clone)]
struct ScaledPoint {
    z: Vec<f64>,
    loss: f64,
    gradient: Vec<f64>,
}

impl ScaledLoss<'_> {
    fn evaluate(&self, z: &[f64]) -> Result<ScaledPoint, argmin::core::Error> {
        if let Some(last) = self.last.borrow().as_ref().filter(|last| last.z == z) {
            return Ok(last.clone());
        }
        let values = self.chart.values(z);
        let here = self.objective.evaluate(&self.loss, &values)?;
        let slopes = here.gradient.iter().zip(self.chart.slopes(&values));
        let gradient = slopes.map(|(g, s)| g * s / self.scale).collect();
        let point = ScaledPoint { z: z.to_vec(), loss: here.loss / self.scale, gradient };
        *self.last.borrow_mut() = Some(point.clone());
        Ok(point)
    }
}

impl CostFunction for ScaledLoss<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, z: &Vec<f64>) -> Result<f64, argmin::core::Error> {
        self.evaluate(z).map(|point| point.loss)
    }
}

impl Gradient for ScaledLoss<'_> {
    type Param = Vec<f64>;
    type Gradient = Vec<f64>;

    fn gradient(&self, z: &Vec<f64>) -> Result<Vec<f64>, argmin::core::Error> {
        self.evaluate(z).map(|point| point.gradient)
    }
}

type LbfgsState = IterState<Vec<f64>, Vec<f64>, (), (), (), f64>;

/// Writes down the points that argmin accepts.
struct Recorder(Visited);

/// Coordinates and scaled losses.
type Visited = Arc<Mutex<Vec<(Vec<f64>, f64)>>>;

impl Observe<LbfgsState> for Recorder {
    fn observe_iter(&mut self, state: &LbfgsState, _: &KV) -> Result<(), argmin::core::Error> {
        if let (Some(z), Ok(mut points)) = (state.get_param(), self.0.lock()) {
            points.push((z.clone(), state.get_cost()));
        }
        Ok(())
    }
}

/// argmin's L-BFGS with Moré and Thuente's line search.
fn lbfgs(
    objective: &Objective<'_>,
    observed: &Observations,
    start: &[f64],
    settings: &Settings,
    watch: Watch<'_>,
) -> Result<Vec<Iterate>, Failure> {
    let (loss, chart) = (Loss::Observed(observed.clone()), Chart::new(objective.parameters));
    let first = objective.evaluate(&loss, start)?;
    let slopes = chart.slopes(start);
    let steepness = first.gradient.iter().zip(slopes).map(|(g, s)| (g * s).powi(2)).sum::<f64>();
    let mut trace = Vec::new();
    push(&mut trace, start.to_vec(), first.loss, 1.0, watch);
    if steepness == 0.0 {
        return Ok(trace);
    }
    // The first trial goes as far as the scaled gradient is long.
    let scale = steepness.sqrt() / FIRST_TRIAL;
    let last = RefCell::new(None);
    let problem = ScaledLoss { objective, loss, chart: &chart, scale, last };
    let solver = LBFGS::new(MoreThuenteLineSearch::new(), MEMORY)
        .with_tolerance_grad(SMALLEST_SLOPE)
        .and_then(|solver| solver.with_tolerance_cost(SMALLEST_DECREASE))
        .expect("the tolerances are positive");
    let points = Visited::default();
    let z = chart.coordinates(start);
    let iterations = settings.iterations as u64;
    let ended = Executor::new(problem, solver)
        .configure(|state| state.param(z).max_iters(iterations))
        .add_observer(Recorder(Arc::clone(&points)), ObserverMode::Always)
        .ctrlc(false)
        .timer(false)
        .run();
    // A trial that cannot be simulated ends the search at the best point so far.
    drop(ended);
    let points = points.lock().map(|points| points.clone()).unwrap_or_default();
    for (z, loss) in points {
        push(&mut trace, chart.values(&z), loss * scale, 1.0, watch);
    }
    Ok(trace)
}

/// Pairs that L-BFGS remembers.
const MEMORY: usize = 10;
/// How far L-BFGS tries to go first, in coordinates.
const FIRST_TRIAL: f64 = 0.5;
/// Scaled slope at which L-BFGS stops.
const SMALLEST_SLOPE: f64 = 1e-14;
/// Scaled decrease at which L-BFGS stops.
const SMALLEST_DECREASE: f64 = 1e-30;

/// Levenberg (1944) and Marquardt (1963): (JᵀJ + μ diag JᵀJ) Δz = −Jᵀr, μ small while that works.
///
/// argmin's Gauss–Newton inverts JᵀJ, knows no damping, and stops at a trial that fails.
fn gauss_newton(
    objective: &Objective<'_>,
    observed: &Observations,
    start: &[f64],
    settings: &Settings,
    watch: Watch<'_>,
) -> Result<Vec<Iterate>, Failure> {
    let mut search = Search::new(objective, observed, start, 1.0)?;
    let mut trace = Vec::new();
    push(&mut trace, start.to_vec(), search.loss, 1.0, watch);
    for _ in 0..settings.iterations {
        let moved = search.advance(objective, observed);
        push(&mut trace, search.values.clone(), search.loss, 1.0, watch);
        if moved.is_none_or(|distance| distance < SMALLEST_MOVE) {
            break;
        }
    }
    Ok(trace)
}

/// The same, first for the beginning of the motion and then for longer and longer parts.
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
        let found = gauss_newton(&part, &seen, &values, &rough, &mut |_| ())?;
        if found.len() > 2 {
            left -= (found.len() - 1).min(left);
            for iterate in found {
                values.clone_from(&iterate.values);
                push(&mut trace, iterate.values, iterate.loss, share, watch);
            }
        }
    }
    let rest = Settings { iterations: left, ..*settings };
    trace.extend(gauss_newton(objective, observed, &values, &rest, watch)?);
    Ok(trace)
}

/// Share of the motion that a continuation fits first.
const FIRST_HORIZON: f64 = 1.0 / 16.0;
/// How much longer the next part is.
const LONGER: f64 = std::f64::consts::SQRT_2;
/// Updates that a part of the motion gets at most.
const ROUGH_ITERATIONS: usize = 30;
/// Moves of the coordinates below this end Gauss–Newton.
const SMALLEST_MOVE: f64 = 1e-14;
/// Parameters that the motion sees less than this, relative to others, are damped as if it did.
const LEAST_SEEN: f64 = 1e-2;
/// Greatest move of a coordinate in one update.
const GREATEST_MOVE: f64 = 1.0;
/// Where the damping starts, how it changes, and where it is given up.
const DAMPING: [f64; 3] = [1e-2, 10.0, 1e12];

/// Steps that reach a time, or go a little beyond it.
///
/// # Errors
/// [`Failure::TooManySteps`].
pub fn steps_until(dt: f64, time: f64) -> Result<usize, Failure> {
    whole((time / dt - 1e-9).ceil(), dt)
}

/// Where Levenberg and Marquardt are.
struct Search {
    chart: Chart,
    values: Vec<f64>,
    loss: f64,
    damping: f64,
    linear: Linearisation,
}

impl Search {
    fn new(
        objective: &Objective<'_>,
        observed: &Observations,
        start: &[f64],
        damping: f64,
    ) -> Result<Self, Failure> {
        let linear = objective.linearise(observed, start)?;
        let loss = sum_of_squares(&linear);
        let chart = Chart::new(objective.parameters);
        Ok(Self { chart, values: start.to_vec(), loss, damping: damping * DAMPING[0], linear })
    }

    /// Goes to a better point; how far it is in coordinates, or `None` if there is none.
    fn advance(&mut self, objective: &Objective<'_>, observed: &Observations) -> Option<f64> {
        let [_, factor, hopeless] = DAMPING;
        let slopes = self.chart.slopes(&self.values);
        let J = &self.linear.jacobian * DMatrix::from_diagonal(&DVector::from_vec(slopes));
        let r = DVector::from_column_slice(&self.linear.residuals);
        let (A, g) = (J.tr_mul(&J), J.tr_mul(&r));
        let z = DVector::from_vec(self.chart.coordinates(&self.values));
        while self.damping < hopeless {
            let step = damped_step(&A, &g, self.damping)?;
            let distance = step.amax();
            let values = self.chart.values((&z + &step).as_slice());
            match objective.linearise(observed, &values) {
                Ok(linear) if sum_of_squares(&linear) < self.loss => {
                    self.damping /= factor;
                    (self.values, self.loss) = (values, sum_of_squares(&linear));
                    self.linear = linear;
                    return Some(distance);
                }
                _ if distance < SMALLEST_MOVE => return None,
                _ => self.damping *= factor,
            }
        }
        None
    }
}

fn sum_of_squares(linear: &Linearisation) -> f64 {
    linear.residuals.iter().map(|r| r * r).sum()
}

/// −(A + μ diag A)⁻¹ g, shortened to the greatest move; `None` if nothing depends on anything.
fn damped_step(A: &DMatrix<f64>, g: &DVector<f64>, damping: f64) -> Option<DVector<f64>> {
    let greatest = A.diagonal().amax();
    if greatest == 0.0 {
        return None;
    }
    // What the motion hardly sees stays where it is.
    let diagonal = A.diagonal().map(|a| damping * a.max(LEAST_SEEN * greatest));
    let step = -(A + DMatrix::from_diagonal(&diagonal)).cholesky()?.solve(g);
    let longest = step.amax();
    Some(if longest > GREATEST_MOVE { step * (GREATEST_MOVE / longest) } else { step })
}
