//! Does a scene move the same here as elsewhere, to the last bit?
//!
//! Prints one number for all states of a run of `scenes/bridge.toml` (or the file given): the same
//! on every machine of a kind, in every build and with every set of features that has the same
//! first backend.

#![expect(clippy::print_stdout, reason = "an example prints what it found")]

use tangency::{default_solver, load_scene, simulate};
use tangency_bench::state_hash;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::args().nth(1).unwrap_or_else(|| "scenes/bridge.toml".into());
    let scene = load_scene(&file)?;
    let solver = default_solver();
    let steps = (scene.def().duration / scene.dt()).round();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
    let run = simulate(&scene, solver.as_ref(), steps as usize)?;
    println!("{:016x}  {}, {steps} steps, {}", state_hash(run.states()), file, solver.name());
    Ok(())
}
