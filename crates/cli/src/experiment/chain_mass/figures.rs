//! The figures.

use std::path::Path;

use tangency::{Rollout, State};

use super::results::{Fit, MethodName, Results, RunTime, Update};
use super::setup::{START, Setup, TRUE_MASS};
use crate::Failure;
use crate::experiment::filmstrip::Filmstrip;
use crate::plot::{Axis, Chart, Curve, save};

/// Draws and writes all figures.
pub(super) fn save_all(setup: &Setup<'_>, results: &Results, folder: &Path) -> Result<(), Failure> {
    save(&mass_per_update(results), &folder.join("mass"))?;
    save(&loss_per_update(results), &folder.join("loss"))?;
    save(&run_time(results), &folder.join("runtime"))?;
    save(&landscape(results), &folder.join("landscape"))?;
    let objective = setup.objective();
    let (_, truth) = objective.rollout(&[TRUE_MASS])?;
    let (_, start) = objective.rollout(&[START])?;
    let strip = Filmstrip {
        title: "A ball hits a hanging chain".into(),
        subtitle: format!(
            "{} links; filled: what is observed, outlined: what the first guess predicts",
            results.links
        ),
        scene: &setup.truth,
        solid: ("total mass 7 (true)", moments(&truth)),
        outline: ("total mass 1 (the first guess)", moments(&start)),
    };
    save(&strip, &folder.join("filmstrip"))?;
    Ok(())
}

/// Ten states, closer together around the impact.
fn moments(rollout: &Rollout) -> Vec<&State> {
    const STEPS: [usize; 10] = [0, 24, 44, 60, 80, 100, 130, 170, 220, 300];
    STEPS.iter().map(|k| rollout.state(*k)).collect()
}

/// The fits that the figures show.
fn shown(results: &Results) -> Vec<&Fit> {
    let from_start = |fit: &&Fit| fit.start == START;
    let plain = [&results.plain, &results.plain_elsewhere];
    plain.into_iter().chain(results.better.iter().filter(from_start)).collect()
}

/// One curve per fit, the number of each update along x.
fn curves(results: &Results, y: impl Fn(&Update) -> f64) -> Vec<Curve> {
    let curve = |(color, fit): (usize, &&Fit)| Curve {
        label: fit.name(),
        points: (fit.trace.iter().enumerate()).map(|(k, update)| (k as f64, y(update))).collect(),
        color,
        marks: true,
        dashed: fit.method != MethodName::GradientDescent,
    };
    shown(results).iter().enumerate().map(curve).collect()
}

fn mass_per_update(results: &Results) -> Chart {
    Chart {
        title: format!("Total mass of {} links, learned from their motion", results.links),
        subtitle: "gradient descent: rate 0.01, gradient clipped to ±100, so steps of at most 1"
            .into(),
        x: Axis::linear("update"),
        y: Axis {
            ticks: Some((0..=8).map(f64::from).collect()),
            range: Some((0.0, 8.0)),
            ..Axis::linear("total mass of the links")
        },
        curves: curves(results, |update| update.mass),
        level: Some((TRUE_MASS, "true mass 7".into())),
    }
}

fn loss_per_update(results: &Results) -> Chart {
    Chart {
        title: "Loss per update".into(),
        subtitle: zeros(&results.plain),
        x: Axis::linear("update"),
        y: Axis::log("mean squared error of all poses"),
        curves: curves(results, |update| update.loss),
        level: None,
    }
}

/// A logarithmic axis cannot show them.
fn zeros(plain: &Fit) -> String {
    match plain.trace.iter().position(|update| update.loss == 0.0) {
        Some(k) => format!("{} reaches exactly 0 at update {k}, which is not shown", plain.name()),
        None => "noise-free observations of 10 s".into(),
    }
}

fn run_time(results: &Results) -> Chart {
    let curve = |label: &str, color, seconds: fn(&RunTime) -> f64| Curve {
        label: label.into(),
        points: results.run_times.iter().map(|t| (t.links as f64, 1e3 * seconds(t))).collect(),
        color,
        marks: true,
        dashed: false,
    };
    let ticks = results.run_times.iter().map(|time| time.links as f64).collect();
    Chart {
        title: "Time of one gradient by the mass of every link".into(),
        subtitle: "300 steps, one thread, medians; both axes logarithmic".into(),
        x: Axis { ticks: Some(ticks), ..Axis::log("links (and parameters)") },
        y: Axis::log("time, ms"),
        curves: vec![
            curve("central differences (2n rollouts)", 1, |t| t.differences_seconds),
            curve("rollout and reverse pass", 0, |t| t.analytic_seconds),
            curve("rollout alone", 2, |t| t.forward_seconds),
        ],
        level: None,
    }
}

fn landscape(results: &Results) -> Chart {
    let points = results.landscape.clone();
    let curve = Curve { label: String::new(), points, color: 0, marks: false, dashed: false };
    let ticks = vec![0.5, 1.0, 2.0, 5.0, 7.0, 10.0, 20.0];
    Chart {
        title: "Loss over the total mass".into(),
        subtitle: "smallest at the true mass 7; jumps are hits that only some masses see".into(),
        x: Axis { ticks: Some(ticks), ..Axis::log("total mass of the links") },
        y: Axis::log("mean squared error of all poses"),
        curves: vec![curve],
        level: None,
    }
}
