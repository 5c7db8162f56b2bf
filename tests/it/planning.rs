//! Tasks that the planner does: a pendulum and a cartpole swung up, a box pushed to a goal.
//!
//! An end is not met exactly at finite weights: weight times error is what the end is worth in effort,
//! from 2 to 6 here, so that errors are some 10⁻⁴ at a weight of 10⁴.

use std::f64::consts::FRAC_PI_2;

use tangency::control::{ControlLimits, Dynamics, Plan, Planner, Quadratic, SceneDynamics};
use tangency::{LcpSolver, Scene, SceneDef, State, rollout};
use tangency_bench::scenes::{driven_pendulum, hanging_cartpole, pushed_box};

use crate::accurate::accurate;
use crate::engine::{backends, built, near};

/// What is to be done.
struct Task {
    def: SceneDef,
    steps: usize,
    limit: f64,
    /// Body, axis, and where it is to come to rest.
    aims: Vec<(usize, usize, f64)>,
    weight: f64,
    /// The first guess: a push for so many steps.
    guess: (usize, f64),
}

impl Task {
    fn plan(&self, scene: &Scene, solver: &dyn LcpSolver) -> Plan {
        let mut dynamics = SceneDynamics::new(scene, solver);
        let order = dynamics.order().clone();
        let effort = if self.def.name == "driven pendulum" { 0.1 } else { 0.01 };
        let mut cost = Quadratic::of_effort(dynamics.states(), 1, effort);
        for (body, axis, target) in &self.aims {
            let [pose, rate] = [order.pose(*body, *axis), order.velocity(*body, *axis)];
            cost.aim(pose.expect("a dynamic body"), *target, 0.0, self.weight);
            cost.aim(rate.expect("a dynamic body"), 0.0, 0.0, self.weight);
        }
        let limits = ControlLimits::new(vec![-self.limit], vec![self.limit]).expect("limits");
        let push = |k: usize| if k < self.guess.0 { self.guess.1 } else { 0.0 };
        let guess: Vec<Vec<f64>> = (0..self.steps).map(|k| vec![push(k)]).collect();
        Planner { tolerance: 1e-7, ..Planner::default() }
            .plan(&mut dynamics, &cost, &limits, &scene.initial_state(), &guess)
            .unwrap_or_else(|error| panic!("{}, {}: {error}", self.def.name, solver.name()))
    }

    /// Plans, follows the plan by the engine alone, and returns the state it ends in.
    fn end(&self, solver: &dyn LcpSolver, least_at_limit: usize) -> State {
        let scene = built(&self.def);
        let plan = self.plan(&scene, solver);
        let effort = |u: &Vec<f64>| u[0].abs();
        assert!(plan.controls.iter().all(|u| effort(u) <= self.limit));
        let at_limit = plan.controls.iter().filter(|u| effort(u) == self.limit).count();
        assert!(at_limit >= least_at_limit, "{}: {at_limit} at the limit", self.def.name);
        let control = |k: usize, _: &State| plan.controls[k].clone();
        let run = rollout(&scene, solver, scene.initial_state(), self.steps, control);
        run.expect("the planner took these steps").last().clone()
    }
}

/// A fifth of the torque that would hold the rod level: upright within 10⁻³ rad, at rest within
/// 10⁻³ rad/s.
#[test]
fn pendulum_swings_up() {
    let aims = vec![(0, 2, FRAC_PI_2)];
    let (def, weight, guess) = (driven_pendulum(), 1e4, (0, 0.0));
    let task = Task { def, steps: 300, limit: 0.9, aims, weight, guess };
    for solver in backends() {
        let end = task.end(&*solver, 20);
        near("angle", end.q[0].z, FRAC_PI_2, 1e-3);
        near("rate", end.v[0].z, 0.0, 1e-3);
    }
}

/// From hanging at rest: the pole upright, the cart where it was, both at rest, within 10⁻³.
#[test]
fn cartpole_swings_up() {
    let aims = vec![(0, 0, 0.0), (1, 2, FRAC_PI_2)];
    let (def, weight, guess) = (hanging_cartpole(), 1e4, (0, 0.0));
    let task = Task { def, steps: 200, limit: 5.0, aims, weight, guess };
    for solver in backends() {
        let end = task.end(&*solver, 5);
        near("angle", end.q[1].z, FRAC_PI_2, 1e-3);
        near("rate", end.v[1].z, 0.0, 1e-3);
        near("cart", end.q[0].x, 0.0, 1e-3);
        near("speed", end.v[0].x, 0.0, 1e-3);
    }
}

/// A hand that cannot pull: friction stops the box at the goal within 10⁻⁴ m, and exactly at rest.
#[test]
fn box_comes_to_rest_at_the_goal() {
    pushes_to_the_goal(pushed_box());
}

/// The same in accurate steps: where the box comes to rest is an event within a step, and hand and box lie
/// still for half of the guess.
#[test]
fn box_comes_to_rest_at_the_goal_in_accurate_steps() {
    let def = pushed_box();
    let dt = def.dt;
    pushes_to_the_goal(accurate(def, dt));
}

fn pushes_to_the_goal(def: SceneDef) {
    let aims = vec![(1, 0, 1.0)];
    let (weight, guess) = (1e5, (30, 5.0));
    let task = Task { def, steps: 100, limit: 5.0, aims, weight, guess };
    for solver in backends() {
        let end = task.end(&*solver, 0);
        near("place", end.q[1].x, 1.0, 1e-4);
        near("speed", end.v[1].x, 0.0, 1e-12);
    }
}
