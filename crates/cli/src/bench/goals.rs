//! The goals of this project's speed, each with what this run found.

use tangency_bench::batch::Throughput;
use tangency_bench::check::Check;
use tangency_bench::precision::{Front, Point};

use super::outcome::{ALL, HARD, MANY, Outcome};
use super::row::Row;
use super::tables::LARGE;

/// Time steps of the race, s.
const FINE: f64 = 0.005;
const COARSE: f64 = 1.0 / 60.0;

/// How the rows of other engines begin, at the settings that are their defaults.
const PYMUNK: &str = "pymunk";
const MUJOCO: &str = "mujoco ";
const RAPIER: &str = "rapier2d-f64, 4 it.";
const PHYZ: &str = "phyz";
const NIMBLE: &str = "nimblephysics";
const OTHERS: [&str; 5] = [RAPIER, PHYZ, NIMBLE, "mujoco-mjx", "brax"];

/// All goals; what this run did not measure says so.
pub(super) fn goals(outcome: &Outcome) -> Vec<Check> {
    let mut all = small_scenes(outcome);
    all.extend(stack(outcome));
    all.extend(chains(outcome));
    all.extend(pyramids(outcome));
    all.extend(modes(outcome));
    all.extend(gradients(outcome));
    all.extend(solvers(outcome));
    all.extend(growth(outcome));
    all.extend(batches(outcome));
    all.extend(memory(outcome));
    all
}

/// The first row of a scene whose engine's name begins so.
fn row<'a>(outcome: &'a Outcome, scene: &str, dt: f64, engine: &str) -> Option<&'a Row> {
    let same = |row: &&Row| {
        row.scene == scene && (row.dt - dt).abs() < 1e-9 && row.engine.starts_with(engine)
    };
    outcome.race.iter().find(same)
}

/// Steps of ours in the time of one of another engine.
fn speed(outcome: &Outcome, scene: &str, dt: f64, engine: &str) -> Option<f64> {
    let us = |engine: &str| row(outcome, scene, dt, engine)?.us_least;
    Some(us(engine)? / us(&outcome.own)?)
}

fn small_scenes(outcome: &Outcome) -> Vec<Check> {
    let mut all = Vec::new();
    for scene in ["bounce", "chain of 10", "cartpole"] {
        let over = |engine| speed(outcome, scene, FINE, engine);
        let others = OTHERS.iter().filter_map(|engine| over(engine)).reduce(f64::min);
        all.push(Check::at_least(format!("{scene}: speed over pymunk"), over(PYMUNK), 1.2));
        all.push(Check::at_least(format!("{scene}: speed over MuJoCo"), over(MUJOCO), 1.2));
        let what = format!("{scene}: speed over the fastest other engine");
        all.push(Check::at_least(what, others, 1.0));
    }
    all
}

fn residual(outcome: &Outcome, scene: &str, dt: f64) -> Check {
    let found = row(outcome, scene, dt, &outcome.own).and_then(|row| row.residual);
    Check::at_most(format!("{scene}: worst residual"), found, 1e-10)
}

fn stack(outcome: &Outcome) -> Vec<Check> {
    let scene = "stack of 10";
    let over = |engine| speed(outcome, scene, FINE, engine);
    vec![
        residual(outcome, scene, FINE),
        Check::at_least(format!("{scene}: speed over pymunk"), over(PYMUNK), 1.0),
        Check::at_least(format!("{scene}: speed over MuJoCo"), over(MUJOCO), 5.0),
    ]
}

fn chains(outcome: &Outcome) -> Vec<Check> {
    let projected = format!("{}, projected", outcome.own);
    let mut all = Vec::new();
    for links in [50, 200, MANY] {
        let scene = format!("chain of {links}");
        let of = |engine: &str| row(outcome, &scene, COARSE, engine);
        let over = |engine: &str| Some(of(engine)?.us_least? / of(RAPIER)?.us_least?);
        let drift = of(&projected).and_then(|row| row.drift);
        let times = format!("{scene}: time over rapier2d at its defaults");
        all.push(Check::at_most(&*times, over(&outcome.own), 0.25));
        all.push(Check::at_most(format!("{times}, joints projected"), over(&projected), 0.25));
        all.push(Check::at_most(format!("{scene}: drift with projection, m"), drift, 1e-9));
    }
    all
}

fn pyramids(outcome: &Outcome) -> Vec<Check> {
    let mut all = Vec::new();
    for boxes in [55, 210] {
        let scene = format!("pyramid of {boxes}");
        let time = speed(outcome, &scene, COARSE, RAPIER).map(|speed| 1.0 / speed);
        let what = format!("{scene}: time over rapier2d at its defaults");
        all.push(Check::at_most(what, time, 3.0));
        all.push(residual(outcome, &scene, COARSE));
    }
    let what = "pyramid: time over rapier2d at each error that it reaches, worst";
    all.push(Check::at_most(what, at_equal_error(outcome, "V20"), 1.0));
    all
}

/// The worst ratio, over all points of rapier2d in a case, of our least time to be as accurate.
fn at_equal_error(outcome: &Outcome, case: &str) -> Option<f64> {
    let (_, fronts) = outcome.precision.iter().find(|(it, _)| it.id == case)?;
    let own = fronts.iter().find(|front| front.engine == outcome.own)?;
    let rapier = fronts.iter().filter(|front| front.engine.starts_with("rapier"));
    let points = rapier.flat_map(|front| &front.points);
    points.map(|p| time_to(own, p.error.state()) / p.time.least).reduce(f64::max)
}

/// Time of fixed steps over that of steps divided at events, both as accurate: as far as fixed steps were
/// not made short enough, as if their error went on falling with dt.
fn fixed_over(outcome: &Outcome, case: &str, mode: &str, error: f64) -> Option<f64> {
    let (_, fronts) = outcome.precision.iter().find(|(it, _)| it.id == case)?;
    let named = |name: &str| fronts.iter().find(|front| front.engine == name);
    let (fixed, divided) = (named(&outcome.own)?, named(&format!("{}, {mode}", outcome.own))?);
    let slower = |point: &Point| point.time.least * (point.error.state() / error).max(1.0);
    let fixed = fixed.points.iter().map(slower).reduce(f64::min)?;
    Some(fixed / time_to(divided, error))
}

/// The least time of a front's points that are as accurate, s; infinite if none is.
fn time_to(front: &Front, error: f64) -> f64 {
    let enough = front.points.iter().filter(|point| point.error.state() <= error);
    enough.map(|point| point.time.least).fold(f64::INFINITY, f64::min)
}

fn modes(outcome: &Outcome) -> Vec<Check> {
    let mut all = Vec::new();
    for case in ["V02", "V04", "V07", "V10"] {
        for (error, least) in [(1e-4, 10.0), (1e-7, 1000.0)] {
            let what = format!("{case}: time of fixed steps over accurate ones, error {error:.0e}");
            all.push(Check::at_least(what, fixed_over(outcome, case, "accurate", error), least));
        }
    }
    all
}

fn gradients(outcome: &Outcome) -> Vec<Check> {
    let mut all = Vec::new();
    for scene in ["bounce", "stack of 10", "chain of 10", "cartpole"] {
        let of = |engine| row(outcome, scene, FINE, engine);
        let own = of(&outcome.own);
        let what = format!("{scene}: value and gradient over value");
        all.push(Check::at_most(what, own.and_then(|row| row.gradient), 2.0));
        for (name, engine) in [("MuJoCo", MUJOCO), ("nimblephysics", NIMBLE), ("phyz", PHYZ)] {
            let ratio = || Some(own?.gradient_us? / of(engine)?.gradient_us?);
            let what = format!("{scene}: value and gradient over those of {name}");
            all.push(Check::at_most(what, ratio(), 0.1));
        }
    }
    all.extend(outcome.all_over_one.clone());
    all
}

fn solvers(outcome: &Outcome) -> Vec<Check> {
    let last = |scene: &str, solver: &str| {
        outcome.solvers.iter().rev().find(|row| row.scene == scene && row.solver == solver)
    };
    let over = |scene| outcome.over_native(last(scene, "clarabel")?);
    let iterations = || Some(last(HARD, "interior point")?.score.iterations);
    vec![
        Check::at_least("recorded problems: speed over Clarabel, cold", over(ALL), 10.0),
        Check::at_least(
            "recorded problems that need the interior point: speed over Clarabel, cold",
            over(HARD),
            10.0,
        ),
        Check::at_most("iterations of the interior point there", iterations(), 12.0),
    ]
}

fn growth(outcome: &Outcome) -> Vec<Check> {
    let exponent = |family: &str| {
        let (_, curves) = outcome.growth.iter().find(|(name, _)| *name == family)?;
        curves.iter().find(|curve| curve.engine == outcome.own)?.exponent(LARGE)
    };
    vec![
        Check::at_most("chains: exponent of time over links", exponent("chain"), 1.1),
        Check::at_most("pyramids: exponent of time over boxes", exponent("pyramid"), 1.5),
    ]
}

/// Environments of a large batch.
const BATCH: usize = 1024;

fn batches(outcome: &Outcome) -> Vec<Check> {
    let scenes = ["cartpole", "chain of 10", "stack of 10"];
    let check = |scene: &str| {
        let large =
            |row: &&Throughput| row.scene == scene && row.environments == BATCH && row.threads > 1;
        let found = outcome.batch.iter().rfind(large);
        let what = format!("{BATCH} environments, {scene}: efficiency on all cores");
        Check::at_least(what, found.map(|row| row.efficiency), 0.9)
    };
    scenes.map(check).into()
}

fn memory(outcome: &Outcome) -> Vec<Check> {
    let mib = |bytes: f64| bytes / f64::from(1 << 20);
    let tape = outcome.tape("chain of 10");
    let scene = format!("chain of {MANY}: memory of scene and step, MiB");
    vec![
        Check::at_most("chain of 10: tape of 300 steps, MiB", tape.map(mib), 1.0),
        Check::at_most(scene, outcome.large_scene.map(mib), 100.0),
    ]
}
