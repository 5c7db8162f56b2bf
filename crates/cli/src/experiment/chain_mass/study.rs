//! What is run, in order.

use std::time::{Duration, Instant};

use indicatif::ProgressBar;
use tangency::diff::Parameter;

use super::Arguments;
use super::results::{Fit, LinkMasses, Noise, Results, RunTime, Variant};
use super::setup::{RECIPE, START, Setup, TRUE_MASS, observe};
use crate::fit::best;
use crate::gradient::{Difference, relative_error};
use crate::loss::Loss;
use crate::objective::{Evaluation, Objective};
use crate::observations::Observations;
use crate::optimise::{self, Method, Settings};
use crate::{Console, Failure};

/// Starts of the better optimisers.
const STARTS: [f64; 4] = [0.5, 0.63, 1.0, 20.0];
/// The start from which the original cycles.
const CYCLING_START: f64 = 0.63;
/// Updates of the better optimisers at most.
const BETTER: Settings = Settings { iterations: 100, ..RECIPE };
/// Noise of positions (a link is 60 long) and of angles, rad.
const SIGMA: [f64; 2] = [1.0, 0.02];
/// Where the gradient is compared with differences.
const CHECKED: [f64; 4] = [1.0, 3.0, 5.0, 12.0];

/// How much is run.
struct Extent {
    seeds: u64,
    sizes: &'static [usize],
    repetitions: usize,
    landscape: u32,
}

impl Extent {
    fn new(quick: bool) -> Self {
        if quick {
            Self { seeds: 2, sizes: &[1, 2, 5], repetitions: 1, landscape: 20 }
        } else {
            Self { seeds: 5, sizes: &[1, 2, 5, 10, 20, 40], repetitions: 5, landscape: 160 }
        }
    }
}

pub(super) fn study(
    setup: &Setup<'_>,
    arguments: &Arguments,
    console: &Console,
) -> Result<Results, Failure> {
    let extent = Extent::new(arguments.quick);
    let objective = setup.objective();
    let first = objective.evaluate(&setup.loss(), &[START])?;

    let start = Instant::now();
    let plain = plain_fit(setup, START, console)?;
    let plain_seconds = start.elapsed().as_secs_f64();

    let plain_elsewhere = plain_fit(setup, CYCLING_START, console)?;
    let better = better_fits(setup, console)?;
    let [forward, reverse] = pass_times(&objective, &setup.loss(), extent.repetitions)?;
    let mut results = Results {
        links: setup.links,
        true_mass: TRUE_MASS,
        start_loss: first.loss,
        start_gradient: first.gradient[0],
        start_variants: start_variants(setup)?,
        plain,
        plain_elsewhere,
        better,
        plain_seconds,
        forward_seconds: forward.as_secs_f64(),
        reverse_seconds: reverse.as_secs_f64(),
        gradient_error: gradient_error(setup)?,
        worst_residual: 0.0,
        noise: noise(setup, arguments.seed, extent.seeds, console)?,
        link_masses: link_masses(setup, console)?,
        run_times: run_times(setup, &extent, console)?,
        landscape: landscape(setup, extent.landscape)?,
    };
    results.worst_residual = worst_residual(&objective, &results)?;
    Ok(results)
}

/// The paper's recipe.
fn plain_fit(setup: &Setup<'_>, start: f64, console: &Console) -> Result<Fit, Failure> {
    let progress = console.progress(RECIPE.iterations + 1, "gradient descent");
    fit(setup, &setup.observed, Method::GradientDescent, start, &progress)
}

fn better_fits(setup: &Setup<'_>, console: &Console) -> Result<Vec<Fit>, Failure> {
    let mut fits = Vec::new();
    let progress = console.progress(2 * STARTS.len(), "better optimisers");
    for method in [Method::GaussNewton, Method::Lbfgs] {
        for start in STARTS {
            fits.push(fit(setup, &setup.observed, method, start, &ProgressBar::hidden())?);
            progress.inc(1);
        }
    }
    progress.finish_and_clear();
    Ok(fits)
}

fn fit(
    setup: &Setup<'_>,
    observed: &Observations,
    method: Method,
    start: f64,
    progress: &ProgressBar,
) -> Result<Fit, Failure> {
    let settings = if method == Method::GradientDescent { RECIPE } else { BETTER };
    let mut watch = |_: &optimise::Iterate| progress.inc(1);
    let objective = setup.objective();
    let trace = optimise::fit(&objective, observed, &[start], method, &settings, &mut watch)?;
    progress.finish_and_clear();
    Ok(Fit { method: method.into(), start, trace: trace.into_iter().map(Into::into).collect() })
}

/// Loss and gradient at the start, for what "all poses" might mean.
fn start_variants(setup: &Setup<'_>) -> Result<Vec<Variant>, Failure> {
    let links: Vec<usize> = (0..setup.links).collect();
    let all: Vec<usize> = (0..=setup.links).collect();
    let mut variants = Vec::new();
    for (name, bodies) in [("links and ball", all), ("links", links)] {
        let keep = |list: &[nalgebra::Vector3<f64>]| bodies.iter().map(|b| list[*b]).collect();
        let mut seen = setup.observed.clone();
        seen.frames.iter_mut().for_each(|frame| frame.poses = keep(&frame.poses));
        seen.bodies.clone_from(&bodies);
        let here = setup.objective().evaluate(&Loss::Observed(seen), &[START])?;
        variants.push(Variant { compared: name, loss: here.loss, gradient: here.gradient[0] });
    }
    Ok(variants)
}

/// Median times of the rollout and of its reverse pass at the start.
fn pass_times(
    objective: &Objective<'_>,
    loss: &Loss,
    repetitions: usize,
) -> Result<[Duration; 2], Failure> {
    let runs = (0..=2 * repetitions).map(|_| objective.evaluate(loss, &[START]));
    let runs = runs.collect::<Result<Vec<Evaluation>, _>>()?;
    Ok([median(runs.iter().map(|r| r.forward)), median(runs.iter().map(|r| r.reverse))])
}

fn median(times: impl Iterator<Item = Duration>) -> Duration {
    let mut times: Vec<Duration> = times.collect();
    times.sort_unstable();
    times[times.len() / 2]
}

/// The worst relative error of the gradient against extrapolated central differences.
fn gradient_error(setup: &Setup<'_>) -> Result<f64, Failure> {
    let (objective, loss) = (setup.objective(), setup.loss());
    let mut worst = 0.0_f64;
    for mass in CHECKED {
        let exact = objective.evaluate(&loss, &[mass])?.gradient[0];
        worst = worst.max(Difference::new(&objective, &loss, mass)?.relative_error(exact));
    }
    Ok(worst)
}

/// Estimates from noisy observations, and how far they should spread.
fn noise(setup: &Setup<'_>, seed: u64, seeds: u64, console: &Console) -> Result<Noise, Failure> {
    let progress = console.progress(usize::try_from(seeds).unwrap_or(0), "noise");
    let mut estimates = Vec::new();
    for seed in seed..seed + seeds {
        let seen = setup.noisy(seed, SIGMA);
        let found = fit(setup, &seen, Method::GaussNewton, START, &ProgressBar::hidden())?;
        estimates.push(found.mass());
        progress.inc(1);
    }
    progress.finish_and_clear();
    let count = estimates.len() as f64;
    let mean = estimates.iter().sum::<f64>() / count;
    let squares = estimates.iter().map(|mass| (mass - mean).powi(2)).sum::<f64>();
    let (sigma, spread) = (SIGMA, (squares / (count - 1.0)).sqrt());
    Ok(Noise { sigma, seed, estimates, mean, spread, expected_spread: expected_spread(setup)? })
}

/// Least squares to first order: δm = Σ Jᵢ εᵢ / Σ Jᵢ².
fn expected_spread(setup: &Setup<'_>) -> Result<f64, Failure> {
    let linear = setup.objective().linearise(&setup.observed, &[TRUE_MASS])?;
    let scale = (linear.values.len() as f64).sqrt();
    let sigmas = [SIGMA[0], SIGMA[0], SIGMA[1]].into_iter().cycle();
    let slopes = linear.jacobian.iter().map(|j| j * scale);
    let (variance, squares) = slopes
        .zip(sigmas)
        .fold((0.0, 0.0), |(v, s), (j, sigma)| (v + (j * sigma).powi(2), s + j * j));
    Ok(variance.sqrt() / squares)
}

/// A mass for every link: from equal shares of the paper's start to a chain that grows heavier
/// downwards, of the same total mass.
fn link_masses(setup: &Setup<'_>, console: &Console) -> Result<LinkMasses, Failure> {
    let progress = console.progress(BETTER.iterations, "a mass for each link");
    let parameters = setup.link_masses()?;
    let mut truth = setup.truth.clone();
    let n = setup.links as f64;
    let share = |i: usize| TRUE_MASS / n * (0.6 + 0.8 * (i as f64 + 0.5) / n);
    let true_masses: Vec<f64> = (0..setup.links).map(share).collect();
    for (parameter, mass) in parameters.iter().zip(&true_masses) {
        parameter.set(&mut truth, *mass)?;
    }
    let observed = observe(&truth, setup.solver)?;
    let objective = setup.objective_of(&parameters);
    let start = vec![START / n; setup.links];
    let mut watch = |_: &optimise::Iterate| progress.inc(1);
    let (method, settings) = (Method::GaussNewton, Settings { continuation: true, ..BETTER });
    let trace = optimise::fit(&objective, &observed, &start, method, &settings, &mut watch)?;
    progress.finish_and_clear();
    let found = best(&trace).values.clone();
    let errors = found.iter().zip(&true_masses).map(|(found, mass)| relative_error(*found, *mass));
    let worst_relative_error = errors.fold(0.0, f64::max);
    Ok(LinkMasses { true_masses, found, worst_relative_error, updates: trace.len() - 1 })
}

/// The time of a gradient by one mass per link, in reverse mode and by central differences.
fn run_times(
    setup: &Setup<'_>,
    extent: &Extent,
    console: &Console,
) -> Result<Vec<RunTime>, Failure> {
    let progress = console.progress(extent.sizes.len(), "run times");
    let mut times = Vec::new();
    for links in extent.sizes {
        let setup = Setup::new(*links, setup.solver)?;
        let parameters = setup.link_masses()?;
        times.push(run_time(&setup, &parameters, extent.repetitions)?);
        progress.inc(1);
    }
    progress.finish_and_clear();
    Ok(times)
}

fn run_time(
    setup: &Setup<'_>,
    parameters: &[Parameter],
    repetitions: usize,
) -> Result<RunTime, Failure> {
    let (objective, loss) = (setup.objective_of(parameters), setup.loss());
    let masses = vec![START / setup.links as f64; setup.links];
    let (mut forward, mut analytic, mut differences) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..repetitions {
        let start = Instant::now();
        let here = objective.evaluate(&loss, &masses)?;
        analytic.push(start.elapsed());
        forward.push(here.forward);
        let start = Instant::now();
        central_differences(&objective, &loss, &masses)?;
        differences.push(start.elapsed());
    }
    Ok(RunTime {
        links: setup.links,
        forward_seconds: median(forward.into_iter()).as_secs_f64(),
        analytic_seconds: median(analytic.into_iter()).as_secs_f64(),
        differences_seconds: median(differences.into_iter()).as_secs_f64(),
    })
}

/// Plain central differences: two rollouts per parameter, no extrapolation.
fn central_differences(
    objective: &Objective<'_>,
    loss: &Loss,
    values: &[f64],
) -> Result<Vec<f64>, Failure> {
    let by = |index: usize| {
        let h = 1e-5 * values[index];
        let at = |shift: f64| {
            let mut values = values.to_vec();
            values[index] += shift;
            objective.value(loss, &values)
        };
        Ok((at(h)? - at(-h)?) / (2.0 * h))
    };
    (0..values.len()).map(by).collect()
}

/// The loss over the total mass, from a tenth of the true one to four times as much.
fn landscape(setup: &Setup<'_>, points: u32) -> Result<Vec<(f64, f64)>, Failure> {
    let (objective, loss) = (setup.objective(), setup.loss());
    let mass = |k: u32| 0.4 * (70.0_f64).powf(f64::from(k) / f64::from(points));
    (0..=points).map(|k| Ok((mass(k), objective.value(&loss, &[mass(k)])?))).collect()
}

/// The worst residual of all steps at every mass that a fit visited.
fn worst_residual(objective: &Objective<'_>, results: &Results) -> Result<f64, Failure> {
    let fits = results.better.iter().chain([&results.plain, &results.plain_elsewhere]);
    let mut worst = 0.0_f64;
    for update in fits.flat_map(|fit| &fit.trace) {
        worst = worst.max(objective.rollout(&[update.mass])?.1.residual());
    }
    Ok(worst)
}
