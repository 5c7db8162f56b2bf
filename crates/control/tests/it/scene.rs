//! Scenes as dynamics: the same bits as a run, and the planner's slopes against reverse mode.

use nalgebra::DVector;
use tangency_bench::scenes::race_cartpole;
use tangency_control::{ControlLimits, Dynamics, Planner, Quadratic, SceneDynamics};
use tangency_core::{Scene, rollout};
use tangency_diff::{StateVector, gradient};
use tangency_lcp::LcpSolver;
use tangency_lcp_ipm::InteriorPoint;

const STEPS: usize = 120;
const POLE: usize = 1;
const EFFORT: f64 = 0.01;

/// Balances a pole from 0.1 rad; its slopes at the end are zero by reverse mode, which shares no code
/// with the planner's derivatives but the stages of a step.
#[test]
fn balances() {
    let (scene, solver) =
        (Scene::new(&race_cartpole()).expect("a scene"), InteriorPoint::default());
    let mut dynamics = SceneDynamics::new(&scene, &solver);
    let upright = std::f64::consts::FRAC_PI_2;
    let place = |body, axis| dynamics.order().pose(body, axis).expect("a coordinate");
    let rate = |body, axis| dynamics.order().velocity(body, axis).expect("a coordinate");
    let aims =
        [(place(0, 0), 0.0), (place(POLE, 2), upright), (rate(0, 0), 0.0), (rate(POLE, 2), 0.0)];
    let mut cost = Quadratic::of_effort(dynamics.states(), 1, EFFORT);
    for (place, target) in aims {
        cost.aim(place, target, 0.0, 100.0);
    }

    let initial = scene.initial_state();
    let limits = ControlLimits::new(vec![-4.0], vec![4.0]).expect("limits");
    let planner = Planner { tolerance: 1e-13, ..Planner::default() };
    let guess = vec![vec![0.0]; STEPS];
    let found = planner
        .plan(&mut dynamics, &cost, &limits, &initial, &guess)
        .unwrap_or_else(|error| panic!("{error}"));

    let control = |k: usize, _: &_| found.controls[k].clone();
    let run = rollout(&scene, &solver as &dyn LcpSolver, initial, STEPS, control).expect("a run");
    for (state, planned) in run.states().zip(&found.states) {
        assert_eq!(&dynamics.coordinates(state), planned);
    }
    let off = |place: usize, target: f64| 100.0 * (found.states[STEPS][place] - target);
    let seeds = aims.map(|(place, target)| off(place, target));
    let by = gradient(&scene, &run, |k, state| {
        (k == STEPS).then(|| {
            let mut seed = StateVector::like(state);
            [seed.q[0].x, seed.q[POLE].z, seed.v[0].x, seed.v[POLE].z] = seeds;
            seed
        })
    });
    let by = by.expect("a gradient").by;
    let slopes =
        found.controls.iter().zip(&by.controls).map(|(u, by)| (u[0], by[0] + EFFORT * u[0]));
    let size = DVector::from_iterator(STEPS, found.controls.iter().map(|u| u[0])).amax() * EFFORT;
    for (k, (u, slope)) in slopes.enumerate() {
        let outwards = u.abs() == 4.0 && slope * u < 0.0;
        assert!(outwards || slope.abs() <= 1e-5 * size, "step {k}: u = {u}, slope {slope:e}");
    }
}
