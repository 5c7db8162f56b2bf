//! A hand pushes a box over a rough floor: how does the box come to rest at x = 1?
//!
//! The hand can push, not pull; friction has to stop the box, and the hand has to let go in time. The
//! planner works through sticking, sliding and the touch of hand and box. Prints the motion every
//! 0.1 s.

#![expect(clippy::print_stdout, reason = "an example prints what it found")]

use tangency::control::{ControlLimits, Dynamics, Planner, Quadratic, SceneDynamics};
use tangency::{Scene, default_solver};
use tangency_bench::scenes::pushed_box;

const STEPS: usize = 100;
/// Greatest force of the hand, N.
const FORCE: f64 = 5.0;
const EFFORT: f64 = 0.01;
const MISS: f64 = 1e5;
const GOAL: f64 = 1.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::new(&pushed_box())?;
    let solver = default_solver();
    let mut dynamics = SceneDynamics::new(&scene, &*solver);
    let order = dynamics.order();
    let place = |name: &str| scene.body_index(name).and_then(|body| order.pose(body, 0));
    let (cube, hand) = (place("box").expect("a box"), place("hand").expect("a hand"));
    let speed = cube + dynamics.states() / 2;
    let mut cost = Quadratic::of_effort(dynamics.states(), 1, EFFORT);
    cost.aim(cube, GOAL, 0.0, MISS);
    cost.aim(speed, 0.0, 0.0, MISS);
    let limits = ControlLimits::new(vec![-FORCE], vec![FORCE])?;
    // A box that stays where it is has no slope: the first guess must move it.
    let guess: Vec<Vec<f64>> = (0..STEPS).map(|k| vec![if k < 30 { FORCE } else { 0.0 }]).collect();
    let plan =
        Planner::default().plan(&mut dynamics, &cost, &limits, &scene.initial_state(), &guess)?;

    println!("   t, s   force, N    box, m   box, m/s   hand, m");
    for (k, x) in plan.states.iter().enumerate().step_by(5) {
        let (time, force) = (scene.dt() * k as f64, plan.controls.get(k).map_or(0.0, |u| u[0]));
        println!("{time:7.2} {force:10.3} {:9.5} {:10.5} {:9.5}", x[cube], x[speed], x[hand]);
    }
    let end = &plan.states[STEPS];
    println!("cost by iteration: {:.4?}", plan.history);
    println!("{:.1e} m from the goal at {:.1e} m/s", end[cube] - GOAL, end[speed]);
    Ok(())
}
