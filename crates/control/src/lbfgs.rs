//! Limited-memory BFGS, by argmin.

use std::cell::RefCell;
use std::sync::{Arc, Mutex};

use argmin::core::observers::{Observe, ObserverMode};
use argmin::core::{
    ArgminError, CostFunction, Error, Executor, Gradient, IterState, KV, State as _,
};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;

use crate::Bounds;
use crate::bounds::Chart;
use crate::objective::{Iterate, Objective, SearchError, Slope, Watch, check_start, push};

/// L-BFGS (Liu & Nocedal 1989) with Moré and Thuente's line search (1994), in coordinates in which no
/// bound is ever met (see [`Bounds`]).
#[derive(Clone, Debug, PartialEq)]
pub struct Lbfgs {
    /// Bounds, one per number.
    pub bounds: Vec<Bounds>,
    /// Pairs of steps and gradients that it remembers.
    pub memory: usize,
    /// Most iterations.
    pub iterations: usize,
}

/// How far it tries to go first, in coordinates.
const FIRST_TRIAL: f64 = 0.5;
/// Scaled slope at which it stops.
const SMALLEST_SLOPE: f64 = 1e-14;
/// Scaled decrease at which it stops.
const SMALLEST_DECREASE: f64 = 1e-30;

impl Lbfgs {
    /// For so many numbers without bounds, ten pairs, 500 iterations.
    #[must_use]
    pub fn unbounded(numbers: usize) -> Self {
        Self { bounds: vec![Bounds::FREE; numbers], memory: 10, iterations: 500 }
    }

    /// The points from `start` on, the start first: each better than those before it. A trial without a
    /// loss ends the search at the best point so far.
    ///
    /// # Errors
    /// A [`SearchError`] where it cannot begin.
    pub fn minimise<O: Objective>(
        &self,
        objective: &mut O,
        start: &[f64],
        watch: Watch<'_>,
    ) -> Result<Vec<Iterate>, SearchError<O::Error>> {
        let first = objective.evaluate(start)?;
        check_start(&self.bounds, start)?;
        let chart = Chart(&self.bounds);
        let z = chart.coordinates(start);
        let by_z = first.gradient.iter().zip(chart.slopes(&z)).map(|(g, s)| g * s);
        let steepness = by_z.map(|g| g * g).sum::<f64>().sqrt();
        let mut trace = Vec::new();
        push(&mut trace, start.to_vec(), first.loss, watch);
        if steepness == 0.0 || self.iterations == 0 {
            return Ok(trace);
        }
        // The first trial goes as far as the scaled gradient is long.
        let scale = steepness / FIRST_TRIAL;
        let objective = RefCell::new(objective);
        let problem = Scaled { objective, chart: &chart, scale, last: RefCell::new(None) };
        for (z, loss) in self.search(problem, z) {
            push(&mut trace, chart.values(&z), loss * scale, watch);
        }
        Ok(trace)
    }

    fn search<O: Objective>(&self, problem: Scaled<'_, O>, z: Vec<f64>) -> Points {
        let solver = LBFGS::new(MoreThuenteLineSearch::new(), self.memory.max(1))
            .with_tolerance_grad(SMALLEST_SLOPE)
            .and_then(|solver| solver.with_tolerance_cost(SMALLEST_DECREASE))
            .expect("the tolerances are positive");
        let points = Arc::new(Mutex::new(Points::new()));
        let ended = Executor::new(problem, solver)
            .configure(|state| state.param(z).max_iters(self.iterations as u64))
            .add_observer(Recorder(Arc::clone(&points)), ObserverMode::Always)
            .ctrlc(false)
            .timer(false)
            .run();
        // A trial without a loss ends the search at the best point so far.
        drop(ended);
        points.lock().map(|points| points.clone()).unwrap_or_default()
    }
}

/// Coordinates and scaled losses.
type Points = Vec<(Vec<f64>, f64)>;

/// The loss as argmin sees it: divided by a scale, over coordinates without bounds.
struct Scaled<'a, O> {
    objective: RefCell<&'a mut O>,
    chart: &'a Chart<'a>,
    scale: f64,
    /// The last coordinates: argmin asks for value and gradient apart.
    last: RefCell<Option<(Vec<f64>, Slope)>>,
}

impl<O: Objective> Scaled<'_, O> {
    fn evaluate(&self, z: &[f64]) -> Result<Slope, Error> {
        if let Some((_, slope)) = self.last.borrow().as_ref().filter(|(last, _)| last == z) {
            return Ok(slope.clone());
        }
        let Slope { loss, gradient } =
            self.objective.borrow_mut().evaluate(&self.chart.values(z))?;
        if !loss.is_finite() {
            let text = format!("the loss is {loss}");
            return Err(ArgminError::ConditionViolated { text }.into());
        }
        let slopes = gradient.iter().zip(self.chart.slopes(z));
        let gradient = slopes.map(|(g, s)| g * s / self.scale).collect();
        let slope = Slope { loss: loss / self.scale, gradient };
        *self.last.borrow_mut() = Some((z.to_vec(), slope.clone()));
        Ok(slope)
    }
}

impl<O: Objective> CostFunction for Scaled<'_, O> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, z: &Vec<f64>) -> Result<f64, Error> {
        self.evaluate(z).map(|slope| slope.loss)
    }
}

impl<O: Objective> Gradient for Scaled<'_, O> {
    type Param = Vec<f64>;
    type Gradient = Vec<f64>;

    fn gradient(&self, z: &Vec<f64>) -> Result<Vec<f64>, Error> {
        self.evaluate(z).map(|slope| slope.gradient)
    }
}

type LbfgsState = IterState<Vec<f64>, Vec<f64>, (), (), (), f64>;

/// Writes down the points that argmin accepts.
struct Recorder(Arc<Mutex<Points>>);

impl Observe<LbfgsState> for Recorder {
    fn observe_iter(&mut self, state: &LbfgsState, _: &KV) -> Result<(), Error> {
        if let (Some(z), Ok(mut points)) = (state.get_param(), self.0.lock()) {
            points.push((z.clone(), state.get_cost()));
        }
        Ok(())
    }
}
