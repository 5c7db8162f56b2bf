//! Runs of scenes, and comparison with exact figures.

use tangency::{LcpSolver, Rollout, Scene, SceneDef, State, StepRecord, simulate};

/// Every backend of this build. An empty list would let every test pass unseen.
pub(crate) fn backends() -> Vec<Box<dyn LcpSolver>> {
    let list = tangency::solvers();
    assert!(!list.is_empty(), "this build has no backend: turn on the feature `ipm`");
    list
}

/// A scene that is known to be valid.
#[track_caller]
pub(crate) fn built(def: &SceneDef) -> Scene {
    Scene::new(def).unwrap_or_else(|error| panic!("{}: {error}", def.name))
}

/// A definition with another time step.
pub(crate) fn with_dt(def: SceneDef, dt: f64) -> SceneDef {
    SceneDef { dt, ..def }
}

/// Number of steps of a duration.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "durations are short")]
pub(crate) fn steps(duration: f64, dt: f64) -> usize {
    (duration / dt).round() as usize
}

/// A run without controls whose steps were all accepted and whose states are finite.
#[track_caller]
pub(crate) fn run(scene: &Scene, solver: &dyn LcpSolver, steps: usize) -> Rollout {
    let rollout = simulate(scene, solver, steps)
        .unwrap_or_else(|error| panic!("{}, {}: {error}", scene.def().name, solver.name()));
    let worst = rollout.residual();
    assert!(worst <= 1e-10, "{}: residual {worst:e}", scene.def().name);
    let finite = |s: &State| s.q.iter().chain(&s.v).all(|x| x.iter().all(|x| x.is_finite()));
    assert!(rollout.states().all(finite), "{}: a state is not finite", scene.def().name);
    rollout
}

/// The first step of a scene.
#[track_caller]
pub(crate) fn first_step(scene: &Scene, solver: &dyn LcpSolver) -> StepRecord {
    run(scene, solver, 1).records.remove(0)
}

/// |found − exact| ≤ tolerance. `cargo test -- --nocapture` prints the table of all figures.
#[track_caller]
#[expect(clippy::print_stdout, reason = "captured unless the test fails or the table is asked for")]
pub(crate) fn near(what: &str, found: f64, exact: f64, tolerance: f64) {
    let error = (found - exact).abs();
    println!("| {what} | {exact} | {found} | {error:.2e} | {tolerance:.1e} |");
    assert!(error <= tolerance, "{what}: {found} is not {exact}, off by {error:e} > {tolerance:e}");
}

/// |found − exact| ≤ tolerance · |exact|.
#[track_caller]
pub(crate) fn near_relative(what: &str, found: f64, exact: f64, tolerance: f64) {
    near(what, found, exact, tolerance * exact.abs());
}

/// Order of convergence: the slope of log error on log dt over 8, 4, 2, 1 ms.
#[track_caller]
#[expect(clippy::print_stdout, reason = "captured unless the test fails or the table is asked for")]
pub(crate) fn order(what: &str, least: f64, error: impl Fn(f64) -> f64) {
    let points = [8e-3, 4e-3, 2e-3, 1e-3].map(|dt: f64| (dt.ln(), error(dt).abs().ln()));
    let mean = |f: fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / 4.0;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let cross: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    let square: f64 = points.iter().map(|p| (p.0 - x).powi(2)).sum();
    let slope = cross / square;
    println!("| {what}, order | at least {least} | {slope:.3} | | |");
    assert!(slope >= least, "{what}: order {slope}, at least {least} is asked");
}
