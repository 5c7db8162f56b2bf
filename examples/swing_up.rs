//! How does a pendulum get up when its motor is too weak to lift it?
//!
//! A fifth of the torque that would hold the rod level has to do: the planner finds that it must
//! swing. Prints torque, angle from hanging and rate every 0.2 s, with a picture of the angle.

#![expect(clippy::print_stdout, reason = "an example prints what it found")]

use std::f64::consts::{FRAC_PI_2, PI};

use tangency::control::{ControlLimits, Dynamics, Planner, Quadratic, SceneDynamics};
use tangency::{Scene, default_solver};
use tangency_bench::scenes::driven_pendulum;

const STEPS: usize = 300;
/// Greatest torque, N·m; the weight of the rod turns with up to 4.905.
const TORQUE: f64 = 0.9;
const EFFORT: f64 = 0.1;
/// What missing the goal costs, per rad² and per (rad/s)².
const MISS: f64 = 1e4;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::new(&driven_pendulum())?;
    let solver = default_solver();
    let mut dynamics = SceneDynamics::new(&scene, &*solver);
    let order = dynamics.order();
    let (angle, rate) = (order.pose(0, 2).expect("a rod"), order.velocity(0, 2).expect("a rod"));
    let mut cost = Quadratic::of_effort(dynamics.states(), 1, EFFORT);
    cost.aim(angle, FRAC_PI_2, 0.0, MISS);
    cost.aim(rate, 0.0, 0.0, MISS);
    let limits = ControlLimits::new(vec![-TORQUE], vec![TORQUE])?;
    let planner = Planner { tolerance: 1e-7, ..Planner::default() };
    let guess = vec![vec![0.0]; STEPS];
    let plan = planner.plan(&mut dynamics, &cost, &limits, &scene.initial_state(), &guess)?;

    println!("   t, s   N·m    angle     rate");
    for (k, x) in plan.states.iter().enumerate().step_by(10) {
        let torque = plan.controls.get(k).map_or(0.0, |u| u[0]);
        let (turn, time) = (x[angle] + FRAC_PI_2, scene.dt() * k as f64);
        println!("{time:7.2} {torque:6.3} {turn:8.4} {:8.4} |{}|", x[rate], picture(turn));
    }
    let end = &plan.states[STEPS];
    let (off, speed) = (end[angle] - FRAC_PI_2, end[rate]);
    println!("{} iterations; {off:.1e} rad from upright, {speed:.1e} rad/s", plan.iterations);
    Ok(())
}

/// A dot where the rod points, from −π to π.
fn picture(turn: f64) -> String {
    let place = 30.0 * turn / PI;
    let dot = |k: i32| if (f64::from(k) - place).abs() <= 0.5 { 'o' } else { ' ' };
    (-30..=30).map(dot).collect()
}
