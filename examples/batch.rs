//! How does a push turn poles of different masses?
//!
//! 1,024 cart-poles, each with a pole and a push of its own, roll for half a second side by side over
//! all cores. Prints, for some of them, where the pole ends and how that angle depends on the push.

#![expect(clippy::print_stdout, reason = "an example prints what it found")]

use tangency::batch::{Batch, Controls};
use tangency::{Param, Scene, State, StateVector, default_solver};
use tangency_bench::scenes;

const ENVIRONMENTS: usize = 1024;
const STEPS: usize = 100;
/// The body whose angle is the loss.
const POLE: usize = 1;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::new(&scenes::race_cartpole())?;
    let mut batch = Batch::new(scene, ENVIRONMENTS, default_solver());
    let part = |i: usize| i as f64 / (ENVIRONMENTS - 1) as f64;
    for i in 0..ENVIRONMENTS {
        batch.set(i, Param::Mass(POLE), 0.05 + 0.45 * part(i))?;
    }
    let pushes: Vec<f64> =
        (0..ENVIRONMENTS).map(|i| 4.0 * part(37 * i % ENVIRONMENTS) - 2.0).collect();
    let upright = std::f64::consts::FRAC_PI_2;
    let angle = |_: usize, k: usize, state: &State, bar: &mut StateVector| {
        if k < STEPS {
            return 0.0;
        }
        bar.q[POLE].z += 1.0;
        state.q[POLE].z - upright
    };
    let found = batch.value_and_gradient(STEPS, Controls::Held(&pushes), angle)?.all()?;

    println!("pole, kg   push, N   angle, rad   d angle / d push, rad/N");
    for i in (0..ENVIRONMENTS).step_by(128) {
        let mass = batch.scene(i).get(Param::Mass(POLE)).unwrap_or_default();
        let (push, value) = (pushes[i], found[i].value);
        // One push for all steps: its derivative is the sum over them.
        let slope: f64 = found[i].gradient.by.controls.iter().map(|step| step[0]).sum();
        println!("{mass:8.3} {push:9.3} {value:12.4} {slope:25.5}");
    }
    Ok(())
}
