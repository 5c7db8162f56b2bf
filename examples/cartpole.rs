//! A pole hangs from a cart: which pushes swing it up and leave it standing, the cart where it was?
//!
//! Prints the planned motion, then how it ends for poles of another mass than planned for: with the
//! same pushes, and with the planned gains that correct them on the way.

#![expect(clippy::print_stdout, reason = "an example prints what it found")]

use std::f64::consts::FRAC_PI_2;

use tangency::control::{ControlLimits, Dynamics, Planner, Quadratic, SceneDynamics};
use tangency::{Param, Scene, State, default_solver, rollout};
use tangency_bench::scenes::hanging_cartpole;

const STEPS: usize = 200;
/// Greatest push, N.
const PUSH: f64 = 5.0;
const EFFORT: f64 = 0.01;
const MISS: f64 = 1e4;
const POLE: usize = 1;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::new(&hanging_cartpole())?;
    let solver = default_solver();
    let mut dynamics = SceneDynamics::new(&scene, &*solver);
    let order = dynamics.order().clone();
    let mut cost = Quadratic::of_effort(dynamics.states(), 1, EFFORT);
    for (body, axis, target) in [(0, 0, 0.0), (POLE, 2, FRAC_PI_2)] {
        cost.aim(order.pose(body, axis).expect("dynamic"), target, 0.0, MISS);
        cost.aim(order.velocity(body, axis).expect("dynamic"), 0.0, 0.0, MISS);
    }
    let limits = ControlLimits::new(vec![-PUSH], vec![PUSH])?;
    let planner = Planner { tolerance: 1e-7, ..Planner::default() };
    let guess = vec![vec![0.0]; STEPS];
    let plan = planner.plan(&mut dynamics, &cost, &limits, &scene.initial_state(), &guess)?;

    let run =
        rollout(&scene, &*solver, scene.initial_state(), STEPS, |k, _| plan.controls[k].clone())?;
    println!("   t, s   push, N   cart, m   pole, rad from upright");
    for (k, state) in run.states().enumerate().step_by(10) {
        let (push, off) = (plan.controls.get(k).map_or(0.0, |u| u[0]), state.q[POLE].z - FRAC_PI_2);
        println!("{:7.2} {push:9.3} {:9.4} {off:24.5}", state.time, state.q[0].x);
    }
    println!("{} iterations, cost {:.3}\n", plan.iterations, plan.cost);
    println!("pole, kg   end with the same pushes, rad   with gains, rad");
    for mass in [0.095, 0.099, 0.1, 0.101, 0.105] {
        let mut other = scene.clone();
        other.set(Param::Mass(POLE), mass)?;
        let end = |control: &dyn Fn(usize, &State) -> Vec<f64>| {
            rollout(&other, &*solver, other.initial_state(), STEPS, control)
                .map(|run| run.last().q[POLE].z - FRAC_PI_2)
        };
        let same = end(&|k, _| plan.controls[k].clone())?;
        let corrected = end(&|k, state| plan.feedback(k, &order.of_state(state)))?;
        println!("{mass:8.3} {same:31.5} {corrected:17.5}");
    }
    Ok(())
}
