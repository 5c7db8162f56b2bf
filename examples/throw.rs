//! A ball is to fly over a wall and drop off the board into the basket behind: how must it be thrown?
//!
//! L-BFGS follows the gradient of where the ball is after 1.2 s by its velocity at the start, through
//! the bounce. Prints the flight every 0.1 s, and the closed form beside what was found.

#![expect(clippy::print_stdout, reason = "an example prints what it found")]

use tangency::control::{Lbfgs, Quadratic, Shooting};
use tangency::diff::{Coordinates, Parameter};
use tangency::{Scene, default_solver};
use tangency_bench::scenes::basket;

const STEPS: usize = 120;
/// The middle of the basket, m.
const GOAL: [f64; 2] = [3.6, 0.9];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::new(&basket())?;
    let solver = default_solver();
    let velocity = ["velocity.x:ball", "velocity.y:ball"];
    let parameters = Parameter::parse_all(&scene, &velocity)?;
    let order = Coordinates::of(&scene);
    let ball = scene.body_index("ball").expect("a ball");
    let mut cost = Quadratic::of_effort(order.size(), 0, 0.0);
    for (axis, goal) in GOAL.into_iter().enumerate() {
        cost.aim(order.pose(ball, axis).expect("a dynamic body"), goal, 0.0, 2.0);
    }
    let mut throw = Shooting {
        scene: &scene,
        solver: &*solver,
        parameters: &parameters,
        cost: &cost,
        steps: STEPS,
    };
    let start = throw.start();
    let mut tell = |iterate: &tangency::control::Iterate| {
        println!(
            "thrown at {:.4?} m/s: {:.1e} m from the goal",
            iterate.point,
            iterate.loss.sqrt()
        );
    };
    let search = Lbfgs::unbounded(start.len());
    let found = search.minimise(&mut throw, &start, &mut tell)?;

    let best = &found[found.len() - 1].point;
    let (_, motion) = throw.motion(best)?;
    println!("\n   t, s     x, m     y, m");
    for state in motion.states().step_by(10) {
        println!("{:7.1} {:8.4} {:8.4}", state.time, state.q[ball].x, state.q[ball].y);
    }
    // x = 3.88 − e (vₓ T − 3.88),  y = 1.8 + v_y T − g T²/2
    let time = 1.2;
    let exact =
        [(3.88 + (3.88 - GOAL[0]) / 0.8) / time, (GOAL[1] - 1.8) / time + 9.81 * time / 2.0];
    println!("\nfound {best:.9?} m/s, closed form {exact:.9?} m/s");
    Ok(())
}
