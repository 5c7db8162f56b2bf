//! `tangency gradient`: the value of a loss over a rollout, and its gradient.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;
use tangency::diff::{OneSided, Parameter, Switch};
use tangency::{Param, RowSource, Scene, Simulator, State, StepRecord};
use tangency_bench::finite_difference::derivative;

use crate::args::{gradient_mode, positive, smoothing};
use crate::grid::Grid;
use crate::growth::Growth;
use crate::loss::Loss;
use crate::objective::{Evaluation, Objective};
use crate::simulate::{find_solver, n_steps, scene_with, whole};
use crate::{Console, Failure};

/// The options of `gradient`.
#[derive(Args, Debug)]
pub struct Arguments {
    /// Scene file, .toml or .json
    pub scene: PathBuf,
    /// Formula over the final state, such as `ball.x^2 + 0.1*ball.vy`, or a trajectory file
    ///
    /// A formula knows BODY.x, .y, .angle, .vx, .vy, .omega, the operators + - * / ^, pi, sin, cos,
    /// tan, exp, ln, sqrt and abs; and impulses of the last step: impulse(BODY, BODY).n and .t, the
    /// sums over the contacts of two bodies (along the normal, and along it turned by a quarter
    /// counter-clockwise, on the body that the normal points to), 0 where they are out of reach;
    /// impulse(JOINT).x, .y, .angle, .across, .length, .motor, .lower and .upper, those of them that
    /// the joint has, on its second body. A trajectory (CSV as `simulate` writes it) stands for the mean
    /// squared error of all its poses, compared at equal times.
    #[arg(long, allow_hyphen_values = true)]
    pub loss: String,
    /// Parameters, such as `mass:links,velocity.x:ball,width:box,gravity.y`
    #[arg(long, required = true, value_delimiter = ',')]
    pub wrt: Vec<String>,
    /// Number of steps [default: to the end of the trajectory, or of the scene]
    #[arg(long, conflicts_with = "duration")]
    pub steps: Option<usize>,
    /// How long to run, s
    #[arg(long, value_parser = positive)]
    pub duration: Option<f64>,
    /// Time step, s [default: the scene's]
    #[arg(long, value_parser = positive)]
    pub dt: Option<f64>,
    /// Keep few records and make the others again: memory that grows with the root of the number of steps,
    /// for one more run; the digits are the same
    #[arg(long)]
    pub checkpoints: bool,
    /// Smoothed derivatives: contacts are felt before they close, and friction before it slips
    ///
    /// KAPPA is how widely, without unit: 1e-6 (hardly) to 1e-1. The loss stays exact.
    #[arg(long, value_name = "KAPPA", value_parser = smoothing, conflicts_with = "check")]
    pub smoothed: Option<f64>,
    /// Compare with extrapolated central differences; fails if they disagree
    #[arg(long)]
    pub check: bool,
    /// Greatest relative difference that --check lets pass
    #[arg(long, default_value = "1e-6", value_parser = positive)]
    pub tolerance: f64,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    /// Solver of the complementarity problems
    #[arg(long, default_value = "ipm")]
    pub backend: String,
}

/// What is printed.
#[derive(Debug, Serialize)]
struct Report {
    loss: f64,
    steps: usize,
    duration: f64,
    parameters: Vec<ParameterReport>,
    /// Steps and rows at which the derivative is one-sided.
    one_sided: Vec<String>,
    /// Whether the loss depends on how dependent rows share their impulses, which is a convention.
    undetermined_impulses: bool,
    /// How much the gradient grows on its way back.
    growth: Growth,
    residual: f64,
    forward_seconds: f64,
    reverse_seconds: f64,
}

#[derive(Debug, Serialize)]
struct ParameterReport {
    name: String,
    value: f64,
    gradient: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    difference: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    relative_error: Option<f64>,
}

/// Runs the subcommand.
///
/// # Errors
/// Bad input, a step that failed, or a check that did not pass.
pub fn run(arguments: &Arguments, console: &Console) -> Result<(), Failure> {
    let solver = find_solver(&arguments.backend)?;
    let scene = scene_with(&arguments.scene, arguments.dt)?;
    let parameters = Parameter::parse_all(&scene, &arguments.wrt)?;
    let loss = Loss::parse(&arguments.loss, &scene)?;
    let duration = arguments.duration.unwrap_or_else(|| match &loss {
        Loss::Formula(_) => scene.def().duration,
        Loss::Observed(observed) => observed.end(),
    });
    let steps = match arguments.steps {
        Some(steps) => whole(steps as f64, scene.dt())?,
        None => n_steps(duration, scene.dt())?,
    };
    let solver = solver.as_ref();
    let (mode, checkpoints) = (gradient_mode(arguments.smoothed), arguments.checkpoints);
    let parameters = &parameters[..];
    let objective = Objective { scene: &scene, parameters, solver, steps, checkpoints, mode };
    let values = objective.values();
    let evaluation = objective.evaluate(&loss, &values)?;
    let differences =
        if arguments.check { Some(differences(&objective, &loss, console)?) } else { None };
    let report = Report::new(&objective, &loss, &evaluation, differences.as_deref())?;
    if arguments.json {
        console.say(serde_json::to_string_pretty(&report).unwrap_or_default());
    } else {
        console.say(report.text());
    }
    report.judge(arguments.tolerance)
}

/// Extrapolated central differences by every parameter.
fn differences(
    objective: &Objective<'_>,
    loss: &Loss,
    console: &Console,
) -> Result<Vec<Difference>, Failure> {
    let progress = console.progress(objective.parameters.len(), "differences");
    let mut found = Vec::new();
    for parameter in objective.parameters {
        // Alone, because parameters may overlap.
        let alone = Objective { parameters: std::slice::from_ref(parameter), ..*objective };
        found.push(Difference::new(&alone, loss, parameter.value(objective.scene))?);
        progress.inc(1);
    }
    progress.finish_and_clear();
    Ok(found)
}

/// A difference quotient, to check a derivative against.
#[derive(Clone, Copy, Debug)]
pub struct Difference {
    /// The extrapolated central difference; not a number where a step failed.
    pub value: f64,
    /// The greater one of the slopes to both sides: what rounding is relative to where the
    /// derivative vanishes.
    pub slope: f64,
}

impl Difference {
    /// Of an objective with one parameter.
    ///
    /// # Errors
    /// A rollout that failed at the value itself.
    pub fn new(objective: &Objective<'_>, loss: &Loss, value: f64) -> Result<Self, Failure> {
        let step = DIFFERENCE_STEP * if value.abs() < SMALL { 1.0 } else { value.abs() };
        let here = objective.value(loss, &[value])?;
        let loss_at = |value: f64| objective.value(loss, &[value]).unwrap_or(f64::NAN);
        let slope = |step: f64| ((loss_at(value + step) - here) / step).abs();
        let slope = slope(step).max(slope(-step));
        Ok(Self { value: derivative(loss_at, value, step).value, slope })
    }

    /// How far a derivative is from it.
    #[must_use]
    pub fn relative_error(&self, exact: f64) -> f64 {
        let size = exact.abs().max(self.value.abs()).max(self.slope);
        if size == 0.0 { 0.0 } else { (exact - self.value).abs() / size }
    }
}

/// What is said of impulses that are not unique.
const SHARED: &str = "\n\nThe loss depends on how rows that depend on each other share their impulses: those \
                      of least norm, and of least change";

/// Largest step of the differences, relative to the parameter's value.
const DIFFERENCE_STEP: f64 = 1e-4;
/// Values below this count as zero, and their steps are absolute.
const SMALL: f64 = 1e-6;

/// |a − b| relative to the larger of them; 0 if both are 0.
#[must_use]
pub fn relative_error(a: f64, b: f64) -> f64 {
    let size = a.abs().max(b.abs());
    if size == 0.0 { 0.0 } else { (a - b).abs() / size }
}

impl Report {
    fn new(
        objective: &Objective<'_>,
        loss: &Loss,
        found: &Evaluation,
        differences: Option<&[Difference]>,
    ) -> Result<Self, Failure> {
        let parameter = |(index, parameter): (usize, &Parameter)| {
            let gradient = found.gradient[index];
            let difference = differences.map(|list| list[index]);
            ParameterReport {
                name: parameter.name.clone(),
                value: parameter.value(objective.scene),
                gradient,
                difference: difference.map(|d| d.value),
                relative_error: difference.map(|d| d.relative_error(gradient)),
            }
        };
        let (states, mut one_sided) = retrace(objective, &found.report.one_sided)?;
        one_sided.extend(meeting_times(objective, loss, &states));
        Ok(Self {
            loss: found.loss,
            steps: objective.steps,
            duration: states[states.len() - 1].time,
            parameters: objective.parameters.iter().enumerate().map(parameter).collect(),
            one_sided,
            undetermined_impulses: !found.report.undetermined_impulses.is_empty(),
            growth: Growth::of(&found.report),
            residual: found.residual,
            forward_seconds: found.forward.as_secs_f64(),
            reverse_seconds: found.reverse.as_secs_f64(),
        })
    }

    fn text(&self) -> String {
        let checked = self.parameters.iter().any(|p| p.difference.is_some());
        let mut heading = vec!["parameter", "value", "gradient"];
        if checked {
            heading.extend(["difference", "relative error"]);
        }
        let mut grid = Grid::with_heading(heading.into_iter().map(str::to_owned).collect());
        for p in &self.parameters {
            let mut cells = vec![p.name.clone(), short(p.value), exact(p.gradient)];
            cells.extend(p.difference.map(exact));
            cells.extend(p.relative_error.map(|error| format!("{error:.1e}")));
            grid.row(cells);
        }
        let one_sided = match &self.one_sided[..] {
            [] => String::new(),
            [first, ..] => format!(
                "\n\nThe derivative is one-sided at {} place(s), the first: {first}",
                self.one_sided.len()
            ),
        };
        let shared = if self.undetermined_impulses { SHARED } else { "" };
        let growth = self.growth.warning().map_or_else(String::new, |it| format!("\n\n{it}"));
        format!(
            "loss {} after {} steps ({:.6} s); rollout {:.1} ms, reverse pass {:.1} ms\n\n\
             {grid}{one_sided}{shared}{growth}",
            self.loss,
            self.steps,
            self.duration,
            1e3 * self.forward_seconds,
            1e3 * self.reverse_seconds,
        )
    }

    /// Fails unless every difference confirms its gradient.
    fn judge(&self, tolerance: f64) -> Result<(), Failure> {
        let passes = |p: &&ParameterReport| p.relative_error.is_none_or(|e| e <= tolerance);
        let Some(worst) = self.parameters.iter().find(|p| !passes(p)) else { return Ok(()) };
        Err(Failure::Check {
            name: worst.name.clone(),
            relative_error: worst.relative_error.unwrap_or(f64::NAN),
            tolerance,
        })
    }
}

/// All digits of a number, without rows of zeros.
fn short(number: f64) -> String {
    let plain = number == 0.0 || (1e-4..1e6).contains(&number.abs());
    if plain { number.to_string() } else { format!("{number:e}") }
}

fn exact(number: f64) -> String {
    format!("{number:.10e}")
}

/// By dt an interpolated motion has a kink wherever an observed time meets a step.
fn meeting_times(objective: &Objective<'_>, loss: &Loss, states: &[State]) -> Option<String> {
    let is_dt = |parameter: &Parameter| parameter.targets.iter().any(|t| t.0 == Param::Dt);
    let Loss::Observed(observed) = loss else { return None };
    let by_dt = objective.parameters.iter().any(is_dt);
    (by_dt && observed.meets_steps(&states.iter().collect::<Vec<_>>()))
        .then(|| "by dt, because observed times meet steps exactly".into())
}

/// Runs the motion once more: its states, and in words what lies on a switch, step by step.
fn retrace(
    objective: &Objective<'_>,
    one_sided: &[OneSided],
) -> Result<(Vec<State>, Vec<String>), Failure> {
    let scene = objective.scene;
    let mut motion = Simulator::new(scene, objective.solver);
    let (mut states, mut words) = (vec![motion.state().clone()], Vec::new());
    let control = vec![0.0; scene.controls().len()];
    for step in 0..objective.steps {
        let record = motion.step(&control)?;
        let here = one_sided.iter().filter(|it| it.step == step);
        words.extend(here.map(|it| describe(it, scene, record)));
        states.push(record.after.clone());
    }
    Ok((states, words))
}

/// What lies on a switch, in words.
fn describe(it: &OneSided, scene: &Scene, record: &StepRecord) -> String {
    let joint = |j: u32| format!("joint {}", scene.joints()[j as usize].name);
    let contact = |c: u32| {
        let part = it.part.map_or(record, |part| &record.parts[part]);
        let bodies = part.contacts.get(c as usize).map(|contact| {
            contact.feature.id.bodies.map(|b| scene.bodies()[b as usize].name.as_str())
        });
        bodies.map_or_else(|| "a contact".into(), |[a, b]| format!("contact of {a} and {b}"))
    };
    let what = match it.source {
        RowSource::Held { joint: j, .. } | RowSource::Motor { joint: j } => joint(j),
        RowSource::Lower { joint: j } => format!("lower limit of {}", joint(j)),
        RowSource::Upper { joint: j } => format!("upper limit of {}", joint(j)),
        RowSource::Normal { contact: c } | RowSource::Tangent { contact: c } => contact(c),
    };
    let between = match it.kind {
        Switch::Touching => "open or closed",
        Switch::Slipping => "sticking or sliding",
        Switch::Saturating => "holding or at its greatest effort",
        Switch::Bouncing => "reaching the other body within the step or just not",
        Switch::Together => "which of several impacts comes first",
        Switch::Grazing => "touching in passing or just not",
    };
    format!("step {}, {what}: {between}", it.step + 1)
}
