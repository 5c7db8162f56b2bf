//! `tangency simulate`: runs a scene, writes what happened, says how well it went.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use tangency::{BACKENDS, LcpSolver, Scene, StepScratch, backend, load_scene, step};
use tangency_view::{Frame, Run, replay_html};

use crate::args::positive;
use crate::trajectory_file::{Format, write_trajectory};
use crate::{Console, Failure, Summary};

/// The options of `simulate`.
#[derive(Args, Debug)]
pub struct Arguments {
    /// Scene file, .toml or .json
    pub scene: PathBuf,
    /// How long to run, s [default: the scene's duration]
    #[arg(long, value_parser = positive, allow_negative_numbers = true)]
    pub duration: Option<f64>,
    /// Time step, s [default: the scene's]
    #[arg(long, value_parser = positive, allow_negative_numbers = true)]
    pub dt: Option<f64>,
    /// Folder for the files [default: out/SCENE]
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// Format of the trajectory
    #[arg(long, value_enum, default_value_t = Format::Csv)]
    pub format: Format,
    /// Write the replay page (the default)
    #[arg(long, overrides_with = "no_replay")]
    pub replay: bool,
    /// Do not write the replay page
    #[arg(long)]
    pub no_replay: bool,
    /// Solver of the complementarity problems
    #[arg(long, default_value = "ipm")]
    pub backend: String,
}

/// Runs the subcommand.
///
/// # Errors
/// Bad input, a step that failed, files that cannot be written.
pub fn run(arguments: &Arguments, console: &Console) -> Result<(), Failure> {
    let solver = find_solver(&arguments.backend)?;
    let scene = scene_with(&arguments.scene, arguments.dt)?;
    let duration = arguments.duration.unwrap_or(scene.def().duration);
    let steps = n_steps(duration, scene.dt())?;
    let name = title(&scene, &arguments.scene);

    let (run, summary, failure) = simulate(&scene, solver.as_ref(), steps, &name, console);

    let folder = arguments.out.clone().unwrap_or_else(|| default_folder(&arguments.scene));
    let written = write(arguments, &scene, &run, &folder)?;
    let energy = [&run.frames[0], &run.frames[run.frames.len() - 1]].map(|frame| frame.energy);
    let mut table = summary.table(scene.dt(), energy);
    for file in written {
        table.row("written", file.display());
    }
    console.say(format_args!("{name}\n{table}"));
    failure.map_or(Ok(()), Err)
}

/// The solver of this name.
///
/// # Errors
/// [`Failure::UnknownBackend`] with the names there are.
pub fn find_solver(name: &str) -> Result<Box<dyn LcpSolver>, Failure> {
    backend(name).ok_or_else(|| Failure::UnknownBackend {
        name: name.to_owned(),
        known: BACKENDS.join(", "),
    })
}

/// The scene of a file, with another time step if one is given.
///
/// # Errors
/// What is wrong with the file, or with the step.
pub fn scene_with(file: &Path, dt: Option<f64>) -> Result<Scene, Failure> {
    let scene = load_scene(file)?;
    let Some(dt) = dt else { return Ok(scene) };
    let mut def = scene.def().clone();
    def.dt = dt;
    Ok(Scene::new(&def)?)
}

/// Runs of more steps are refused.
pub const MOST_STEPS: usize = 10_000_000;

/// How many steps reach a time: the nearest whole number.
///
/// # Errors
/// [`Failure::TooManySteps`].
pub fn n_steps(time: f64, dt: f64) -> Result<usize, Failure> {
    whole((time / dt).round(), dt)
}

/// A number of steps of `dt` that is whole.
///
/// # Errors
/// [`Failure::TooManySteps`].
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "between 0 and MOST_STEPS"
)]
pub fn whole(steps: f64, dt: f64) -> Result<usize, Failure> {
    if steps <= MOST_STEPS as f64 {
        return Ok(steps.max(0.0) as usize);
    }
    Err(Failure::TooManySteps { steps, dt })
}

/// What was simulated before the first step that failed, if one did.
fn simulate(
    scene: &Scene,
    solver: &dyn LcpSolver,
    steps: usize,
    name: &str,
    console: &Console,
) -> (Run, Summary, Option<Failure>) {
    let mut state = scene.initial_state();
    let mut run = Run { name: name.to_owned(), frames: vec![Frame::initial(scene, &state)] };
    let (mut summary, mut scratch) = (Summary::default(), StepScratch::default());
    let control = vec![0.0; scene.controls().len()];
    let progress = console.progress(steps, "simulating");
    for k in 1..=steps {
        let start = Instant::now();
        let taken = step(scene, solver, &state, &control, &mut scratch).and_then(|record| {
            summary.add(scene, &record, start.elapsed())?;
            Ok(record)
        });
        match taken {
            Ok(record) => {
                run.frames.push(Frame::after(scene, &record));
                state = record.after;
            }
            Err(source) => return (run, summary, Some(Failure::Step { step: k, source })),
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    (run, summary, None)
}

fn write(
    arguments: &Arguments,
    scene: &Scene,
    run: &Run,
    folder: &Path,
) -> Result<Vec<PathBuf>, Failure> {
    fs::create_dir_all(folder)
        .map_err(|source| Failure::Write { file: folder.to_owned(), source })?;
    let trajectory = folder.join(format!("trajectory.{}", arguments.format));
    write_trajectory(&trajectory, arguments.format, scene, run)?;
    if arguments.no_replay {
        return Ok(vec![trajectory]);
    }
    let replay = folder.join("replay.html");
    fs::write(&replay, replay_html(&run.name, scene, std::slice::from_ref(run)))
        .map_err(|source| Failure::Write { file: replay.clone(), source })?;
    Ok(vec![trajectory, replay])
}

/// The scene's own name, or that of its file.
fn title(scene: &Scene, file: &Path) -> String {
    if scene.def().name.is_empty() { stem(file) } else { scene.def().name.clone() }
}

fn default_folder(file: &Path) -> PathBuf {
    Path::new("out").join(stem(file))
}

fn stem(file: &Path) -> String {
    file.file_stem().unwrap_or(file.as_os_str()).to_string_lossy().into_owned()
}
