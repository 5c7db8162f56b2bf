//! What does the engine model at a state of a scene? Nothing that the scene does not need.
//!
//! Prints bodies, rows and islands of `scenes/stack.toml` (or the file given) at the start, and
//! the path that each island takes, then what the first 100 steps cost.

#![expect(clippy::print_stdout, reason = "an example prints what it found")]

use tangency::{default_solver, inspect, load_scene, simulate};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::args().nth(1).unwrap_or_else(|| "scenes/stack.toml".into());
    let scene = load_scene(&file)?;
    println!("{}\n{}\n", scene.def().name, inspect(&scene, &scene.initial_state())?);

    let run = simulate(&scene, default_solver().as_ref(), 100)?;
    println!("step  contacts  rows  factorisations  residual");
    for (k, record) in run.records.iter().enumerate().step_by(10) {
        let counts = record.counts(&scene);
        println!(
            "{k:4}  {:8}  {:4}  {:14}  {:.1e}",
            counts.contacts,
            counts.rows,
            counts.factorisations,
            record.residual()
        );
    }
    Ok(())
}
