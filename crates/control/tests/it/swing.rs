//! A system that is not linear, with a cost of one's own: a pendulum without an engine.
//!
//! ```text
//!  ω⁺ = ω + h (u − sin θ)      θ⁺ = θ + h ω⁺      l = ½ r u²      l_T = w (1 + cos θ) + ½ w ω²
//! ```

use nalgebra::{DMatrix, DVector, dmatrix, dvector};
use tangency_bench::finite_difference::derivative;
use tangency_control::{
    ControlLimits, Cost, Dynamics, Expansion, LastExpansion, Linearisation, PlanError, Planner,
};

const H: f64 = 0.05;
const STEPS: usize = 240;
const EFFORT: f64 = 0.01;
const WEIGHT: f64 = 100.0;

#[derive(Debug, thiserror::Error)]
#[error("the pendulum turns at {rate}")]
struct TooFast {
    rate: f64,
}

struct Pendulum;

impl Dynamics for Pendulum {
    type State = DVector<f64>;
    type Step = DVector<f64>;
    type Error = TooFast;

    fn states(&self) -> usize {
        2
    }

    fn controls(&self) -> usize {
        1
    }

    fn coordinates(&self, state: &DVector<f64>) -> DVector<f64> {
        state.clone()
    }

    fn step(
        &mut self,
        x: &DVector<f64>,
        _: Option<&DVector<f64>>,
        control: &[f64],
    ) -> Result<DVector<f64>, TooFast> {
        let rate = x[1] + H * (control[0] - x[0].sin());
        if rate.abs() > 8.0 {
            return Err(TooFast { rate });
        }
        Ok(dvector![x[0] + H * rate, rate])
    }

    fn after<'a>(&self, step: &'a DVector<f64>) -> &'a DVector<f64> {
        step
    }

    fn linearise(&self, x: &DVector<f64>, _: &DVector<f64>) -> Result<Linearisation, TooFast> {
        let by_angle = -H * x[0].cos();
        let state = dmatrix![1.0 + H * by_angle, H; by_angle, 1.0];
        Ok(Linearisation { state, control: dmatrix![H * H; H] })
    }
}

/// Upright at the end, by its height.
struct Upright;

impl Cost for Upright {
    fn running(&self, _: usize, _: &DVector<f64>, u: &DVector<f64>) -> f64 {
        0.5 * EFFORT * u[0] * u[0]
    }

    fn running_expansion(&self, _: usize, _: &DVector<f64>, u: &DVector<f64>) -> Expansion {
        let (xx, ux) = (DMatrix::zeros(2, 2), DMatrix::zeros(1, 2));
        Expansion { x: DVector::zeros(2), u: u * EFFORT, xx, ux, uu: dmatrix![EFFORT] }
    }

    fn last(&self, x: &DVector<f64>) -> f64 {
        WEIGHT * (1.0 + x[0].cos()) + 0.5 * WEIGHT * x[1] * x[1]
    }

    fn last_expansion(&self, x: &DVector<f64>) -> LastExpansion {
        // Hanging, the true curvature is negative: the planner has to make up for it.
        let xx = DMatrix::from_diagonal(&(dvector![-x[0].cos(), 1.0] * WEIGHT));
        LastExpansion { x: dvector![-x[0].sin(), x[1]] * WEIGHT, xx }
    }
}

fn cost(controls: &[f64]) -> f64 {
    let mut x = DVector::zeros(2);
    let mut sum = 0.0;
    for u in controls {
        sum += Upright.running(0, &x, &dvector![*u]);
        x = Pendulum.step(&x, None, &[*u]).expect("slow");
    }
    sum + Upright.last(&x)
}

/// Its weight is 1, the torque at most 0.4: it has to swing. At the end no control within the limits
/// has a slope, and those at a limit have one that points outwards, by differences of the cost.
#[test]
fn swings_up() {
    let limits = ControlLimits::new(vec![-0.4], vec![0.4]).expect("limits");
    let guess: Vec<Vec<f64>> = (0..STEPS).map(|k| vec![0.1 * (H * k as f64).sin()]).collect();
    let planner = Planner { tolerance: 1e-12, ..Planner::default() };
    let found = planner
        .plan(&mut Pendulum, &Upright, &limits, &DVector::zeros(2), &guess)
        .unwrap_or_else(|error| panic!("{error}"));
    let end = &found.states[STEPS];
    assert!(end[0].cos() <= -1.0 + 1e-4 && end[1].abs() <= 1e-2, "it ends at {end}");
    let controls: Vec<f64> = found.controls.iter().map(|u| u[0]).collect();
    assert!((cost(&controls) - found.cost).abs() <= 1e-12);
    let mut limited = 0;
    for k in 0..STEPS {
        let at = |u: f64| {
            let mut changed = controls.clone();
            changed[k] = u;
            cost(&changed)
        };
        let slope = derivative(at, controls[k], 1e-2).value;
        let at_limit = controls[k].abs() == 0.4;
        limited += usize::from(at_limit);
        let outwards = at_limit && slope * controls[k] < 0.0;
        assert!(outwards || slope.abs() <= 1e-6, "step {k}: u = {}, {slope:e}", controls[k]);
    }
    assert!(limited >= 20, "only {limited} limits are met");
    assert!(found.history.is_sorted_by(|before, after| after < before));
}

/// A first guess that cannot be followed says where.
#[test]
fn too_fast() {
    let limits = ControlLimits::none(1);
    let guess = vec![vec![10.0]; STEPS];
    let found =
        Planner::default().plan(&mut Pendulum, &Upright, &limits, &DVector::zeros(2), &guess);
    let Err(PlanError::Dynamics { step, source }) = found else { panic!("{found:?}") };
    assert!(step > 10 && source.to_string().starts_with("the pendulum turns at 8."), "{source}");
}
