//! `tangency fit`: parameters of a scene from an observed motion.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;
use tangency::Param;
use tangency::diff::Parameter;
use tangency_view::{Frame, Run, replay_html};

use crate::args::{gradient_mode, positive, smoothing};
use crate::grid::Grid;
use crate::objective::Objective;
use crate::observations::Observations;
use crate::optimise::{self, Iterate, Method, Settings};
use crate::plot::{self, Axis, Chart, Curve};
use crate::simulate::find_solver;
use crate::{Console, Failure, Table};

/// The options of `fit`.
#[derive(Args, Debug)]
pub struct Arguments {
    /// Scene file, .toml or .json
    pub scene: PathBuf,
    /// Observed trajectory: CSV or JSON lines as `simulate` writes them
    ///
    /// Poses are compared at equal times; between two steps of the scene its motion is interpolated
    /// linearly. Bodies that are not in the file are not compared, nor are velocities.
    #[arg(long)]
    pub observed: PathBuf,
    /// Parameters to learn, such as `total_mass:links,friction:floor`
    #[arg(long, required = true, value_delimiter = ',')]
    pub learn: Vec<String>,
    /// Where to start, one number per parameter [default: the scene's values]
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true)]
    pub start: Option<Vec<f64>>,
    /// How to search
    #[arg(long, value_enum, default_value_t = Method::GaussNewton)]
    pub method: Method,
    /// Updates at most
    #[arg(long, default_value_t = 100)]
    pub iterations: usize,
    /// Gradient descent: step per gradient
    #[arg(long, default_value = "0.01", value_parser = positive)]
    pub rate: f64,
    /// Gradient descent: greatest size of a component of the gradient
    #[arg(long, default_value = "100", value_parser = positive)]
    pub clip: f64,
    /// Gauss-Newton: fit the beginning of the motion first, then longer and longer parts
    #[arg(long)]
    pub continuation: bool,
    /// Smoothed derivatives: contacts are felt before they close, and friction before it slips
    ///
    /// KAPPA is how widely, without unit: 1e-6 (hardly) to 1e-1. The loss stays exact.
    #[arg(long, value_name = "KAPPA", value_parser = smoothing)]
    pub smoothed: Option<f64>,
    /// Folder for the files [default: out/fit-SCENE]
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// Solver of the complementarity problems
    #[arg(long, default_value = "ipm")]
    pub backend: String,
}

#[derive(Serialize)]
struct Fitted<'a> {
    parameter: &'a str,
    start: f64,
    value: f64,
}

/// Runs the subcommand.
///
/// # Errors
/// Bad input, a step that failed, files that cannot be written.
pub fn run(arguments: &Arguments, console: &Console) -> Result<(), Failure> {
    let solver = find_solver(&arguments.backend)?;
    let scene = tangency::load_scene(&arguments.scene)?;
    let parameters = Parameter::parse_all(&scene, &arguments.learn)?;
    check_apart(&parameters)?;
    let observed = Observations::read(&arguments.observed, &scene)?;
    let steps = optimise::steps_until(scene.dt(), observed.end())?;
    let solver = solver.as_ref();
    let (mode, checkpoints) = (gradient_mode(arguments.smoothed), false);
    let parameters = &parameters[..];
    let objective = Objective { scene: &scene, parameters, solver, steps, checkpoints, mode };
    let start = start_values(arguments, &objective)?;
    let settings = Settings {
        iterations: arguments.iterations,
        rate: arguments.rate,
        clip: arguments.clip,
        continuation: arguments.continuation,
    };

    let progress = console.progress(arguments.iterations, "fitting");
    let mut watch = |iterate: &Iterate| {
        progress.inc(1);
        progress.set_message(format!("loss {:.3e}", iterate.loss));
    };
    let trace =
        optimise::fit(&objective, &observed, &start, arguments.method, &settings, &mut watch)?;
    progress.finish_and_clear();

    let folder = arguments.out.clone().unwrap_or_else(|| default_folder(&arguments.scene));
    fs::create_dir_all(&folder)
        .map_err(|source| Failure::Write { file: folder.clone(), source })?;
    write_iterations(&folder.join("iterations.csv"), parameters, &trace)?;
    let [svg, png] = plot::save(&loss_curve(&trace), &folder.join("loss"))?;
    write_result(&folder.join("fitted.json"), parameters, &trace)?;
    let best = best(&trace);
    write_replay(&folder.join("replay.html"), &objective, &observed, &best.values)?;

    let mut grid = Grid::new(["parameter", "start", "fitted"]);
    for ((parameter, start), value) in parameters.iter().zip(&start).zip(&best.values) {
        grid.row([parameter.name.clone(), start.to_string(), format!("{value:.12}")]);
    }
    let mut table = Table::default();
    table.row("updates", trace.len() - 1);
    table.row("loss", format!("{:.3e} at the start, {:.3e} now", trace[0].loss, best.loss));
    for file in ["iterations.csv", "fitted.json", "replay.html"] {
        table.row("written", folder.join(file).display());
    }
    table.row("written", svg.display());
    table.row("written", png.display());
    console.say(format_args!("{grid}\n\n{table}"));
    Ok(())
}

/// The iterate with the smallest loss over the whole motion.
#[must_use]
pub fn best(trace: &[Iterate]) -> &Iterate {
    let whole = trace.iter().filter(|iterate| iterate.horizon >= 1.0);
    whole.min_by(|a, b| a.loss.total_cmp(&b.loss)).unwrap_or(&trace[0])
}

/// Two parameters that set the same number cannot both be learned.
fn check_apart(parameters: &[Parameter]) -> Result<(), Failure> {
    for (index, one) in parameters.iter().enumerate() {
        let sets = |target: &(Param, f64)| one.targets.iter().any(|own| own.0 == target.0);
        if let Some(other) = parameters[..index].iter().find(|p| p.targets.iter().any(sets)) {
            let names = [other, one].map(|parameter| parameter.name.clone());
            return Err(Failure::Overlap { names });
        }
    }
    Ok(())
}

fn start_values(arguments: &Arguments, objective: &Objective<'_>) -> Result<Vec<f64>, Failure> {
    let start = arguments.start.clone().unwrap_or_else(|| objective.values());
    let (expected, found) = (objective.parameters.len(), start.len());
    if found == expected { Ok(start) } else { Err(Failure::StartCount { expected, found }) }
}

fn write_iterations(
    file: &Path,
    parameters: &[Parameter],
    trace: &[Iterate],
) -> Result<(), Failure> {
    let names = parameters.iter().map(|parameter| parameter.name.clone());
    let heading = ["update", "horizon", "loss"].map(str::to_owned).into_iter().chain(names);
    let mut grid = Grid::with_heading(heading.collect());
    for (update, iterate) in trace.iter().enumerate() {
        let numbers = [iterate.horizon, iterate.loss].into_iter().chain(iterate.values.clone());
        grid.row(std::iter::once(update.to_string()).chain(numbers.map(|n| n.to_string())));
    }
    grid.write_csv(file)
}

fn write_result(file: &Path, parameters: &[Parameter], trace: &[Iterate]) -> Result<(), Failure> {
    let best = best(trace);
    let fitted: Vec<Fitted<'_>> = (parameters.iter().zip(&trace[0].values).zip(&best.values))
        .map(|((parameter, start), value)| Fitted {
            parameter: &parameter.name,
            start: *start,
            value: *value,
        })
        .collect();
    let text = serde_json::to_string_pretty(&fitted).unwrap_or_default();
    fs::write(file, text).map_err(|source| Failure::Write { file: file.to_owned(), source })
}

fn loss_curve(trace: &[Iterate]) -> Chart {
    let points = trace.iter().enumerate().map(|(update, it)| (update as f64, it.loss)).collect();
    let curve = Curve { label: String::new(), points, color: 0, marks: true, dashed: false };
    Chart {
        title: "Loss per update".into(),
        subtitle: "mean squared error of all observed poses".into(),
        x: Axis::linear("update"),
        y: Axis::log("loss"),
        curves: vec![curve],
        level: None,
    }
}

/// The observed and the fitted motion on one page.
fn write_replay(
    file: &Path,
    objective: &Objective<'_>,
    observed: &Observations,
    values: &[f64],
) -> Result<(), Failure> {
    let (scene, rollout) = objective.rollout(values)?;
    let fitted = Run::from_rollout("fitted", &scene, &rollout);
    let seen = observed.frames.iter().map(|frame| {
        let mut state = scene.initial_state();
        state.time = frame.time;
        for (body, pose) in observed.bodies.iter().zip(&frame.poses) {
            state.q[*body] = *pose;
        }
        Frame::initial(&scene, &state)
    });
    let seen = Run { name: "observed".into(), frames: seen.collect() };
    let page = replay_html(&scene.def().name, &scene, &[seen, fitted]);
    fs::write(file, page).map_err(|source| Failure::Write { file: file.to_owned(), source })
}

fn default_folder(scene: &Path) -> PathBuf {
    let stem = scene.file_stem().unwrap_or(scene.as_os_str()).to_string_lossy();
    Path::new("out").join(format!("fit-{stem}"))
}
