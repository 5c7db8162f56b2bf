//! A ball is to fly over a wall and push a plate behind it; as it is thrown, it misses the plate.
//!
//! So the plate rests, whatever the throw, and the exact derivative of where it ends is 0. With
//! `contact_reach` steps know of contacts a metre away, and smoothed derivatives feel them: descent on the
//! square of the distance finds the plate, and a throw that pushes it to its goal. Prints both derivatives
//! on the way.

#![expect(clippy::print_stdout, reason = "an example prints what it found")]

use nalgebra::Vector3;
use tangency::diff::DiffError;
use tangency::{GradientMode, Rollout, Scene, StateVector, default_solver, gradient, rollout};
use tangency_bench::scenes::hidden_plate;

const STEPS: usize = 240;
const GOAL: f64 = 2.5;
const RATE: f64 = 0.03;
const BALL: usize = 1;
const PLATE: usize = 2;

/// The derivative of (x − goal)² of the plate at the end by the velocity of the throw, as the tape is prepared.
fn slope(scene: &Scene, run: &Rollout) -> Result<Vector3<f64>, DiffError> {
    let found = gradient(scene, run, |k, state| {
        let mut seed = StateVector::like(state);
        seed.q[PLATE].x = 2.0 * (state.q[PLATE].x - GOAL);
        (k == STEPS).then_some(seed)
    })?;
    Ok(found.by.initial.v[BALL])
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::new(&hidden_plate())?;
    let solver = default_solver();
    let mut start = scene.initial_state();
    println!("round     throw, m/s        plate, m         exact             smoothed");
    for round in 0..=60 {
        let mut run = rollout(&scene, &*solver, start.clone(), STEPS, |_, _| Vec::new())?;
        let exact = slope(&scene, &run)?;
        GradientMode::Smoothed { kappa: 1e-3 }.prepare(&mut run)?;
        let smoothed = slope(&scene, &run)?;
        if round % 5 == 0 {
            let [throw, plate] = [start.v[BALL], run.last().q[PLATE]];
            println!(
                "{round:5} {:8.4} {:8.4} {:13.6} {:9.4} {:9.4} {:9.4} {:9.4}",
                throw.x, throw.y, plate.x, exact.x, exact.y, smoothed.x, smoothed.y
            );
        }
        start.v[BALL] -= Vector3::new(smoothed.x, smoothed.y, 0.0) * RATE;
    }
    Ok(())
}
