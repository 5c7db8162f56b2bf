//! `tangency inspect`: checks a scene and shows what a step from one of its states models.

use std::path::PathBuf;

use clap::Args;
use tangency::{LcpSolver, Scene, State, StepScratch, inspect, load_scene, step};

use crate::args::not_negative;
use crate::simulate::{find_solver, n_steps};
use crate::{Console, Failure, Table};

/// The options of `inspect`.
#[derive(Args, Debug)]
pub struct Arguments {
    /// Scene file, .toml or .json
    pub scene: PathBuf,
    /// Look at the state at this time, s
    #[arg(long, default_value = "0", value_parser = not_negative, allow_negative_numbers = true)]
    pub time: f64,
    /// Solver for the steps up to that time
    #[arg(long, default_value = "ipm")]
    pub backend: String,
}

/// Runs the subcommand.
///
/// # Errors
/// Bad input, or a step that failed before the time asked for.
pub fn run(arguments: &Arguments, console: &Console) -> Result<(), Failure> {
    let scene = load_scene(&arguments.scene)?;
    let steps = n_steps(arguments.time, scene.dt())?;
    let state = if steps == 0 {
        scene.initial_state()
    } else {
        state_after(&scene, find_solver(&arguments.backend)?.as_ref(), steps, console)?
    };
    let inspection = inspect(&scene, &state)?;
    console.say(format_args!("{}\n\nat {:.6} s\n{inspection}", overview(&scene), state.time));
    Ok(())
}

fn overview(scene: &Scene) -> Table {
    let def = scene.def();
    let mut table = Table::default();
    table.row("scene", &def.name);
    table.row("description", &def.description);
    table.row("time step", format!("{} s, for {} s", def.dt, def.duration));
    table.row("contact model", format!("{:?}", def.contact_model));
    if def.contact_reach > 0.0 {
        table.row("contact reach", format!("{} m", def.contact_reach));
    }
    table.row("bodies", def.bodies.len());
    table.row("joints", def.joints.len());
    table.row("forces", def.forces.len());
    let controls: Vec<&str> = def.controls.iter().map(|control| control.name.as_str()).collect();
    table.row("controls", if controls.is_empty() { "none".into() } else { controls.join(", ") });
    table
}

fn state_after(
    scene: &Scene,
    solver: &dyn LcpSolver,
    steps: usize,
    console: &Console,
) -> Result<State, Failure> {
    let (mut state, mut scratch) = (scene.initial_state(), StepScratch::default());
    let control = vec![0.0; scene.controls().len()];
    let progress = console.progress(steps, "simulating");
    for k in 1..=steps {
        let record = step(scene, solver, &state, &control, &mut scratch)
            .map_err(|source| Failure::Step { step: k, source })?;
        state = record.after;
        progress.inc(1);
    }
    progress.finish_and_clear();
    Ok(state)
}
