//! Long horizons: gradients from few records, and how much gradients grow.

use tangency::diff::{DiffError, RowImpulse, checkpointed_gradient_with_impulses};
use tangency::{
    Checkpoints, Gradient, GradientMode, LcpSolver, Param, RowSource, Scene, SceneDef, State,
    StateVector, StepRecord, checkpointed_gradient, checkpointed_rollout, gradient,
    gradient_adding, gradient_with_impulses, rollout,
};
use tangency_bench::scenes::{
    between_discs, billiard, falling_disc, material, motor_arm, oblique_collision, pendulum, stack,
};

use crate::engine::{backends, built, near_relative, with_dt};
use crate::gradients::battery::battery;
use crate::gradients::loss::coefficients;
use crate::gradients::numbers::controls;
use crate::impacts::resolved;

fn sparse(scene: &Scene, solver: &dyn LcpSolver, controls: &[Vec<f64>]) -> Checkpoints {
    let control = |k: usize, _: &State| controls[k].clone();
    checkpointed_rollout(scene, solver, scene.initial_state(), controls.len(), control)
        .unwrap_or_else(|error| panic!("{}: {error}", scene.def().name))
}

fn add(k: usize, state: &State, bar: &mut StateVector) {
    bar.add(&coefficients(k, state));
}

/// Every digit, the sign of zero included.
fn bits(gradient: &Gradient) -> String {
    format!("{gradient:?}")
}

#[track_caller]
fn check(scene: &Scene, solver: &dyn LcpSolver, steps: usize) {
    let controls = controls(scene.controls().len(), steps);
    let control = |k: usize, _: &State| controls[k].clone();
    let tape = rollout(scene, solver, scene.initial_state(), steps, control)
        .unwrap_or_else(|error| panic!("{}: {error}", scene.def().name));
    let run = sparse(scene, solver, &controls);
    assert_eq!(run.last(), tape.last());
    let full = gradient_adding(scene, &tape, add).expect("a gradient");
    let found =
        checkpointed_gradient(scene, solver, &run, GradientMode::Exact, add).expect("a gradient");
    assert!(bits(&found) == bits(&full), "{}, {steps} steps", scene.def().name);
}

#[test]
fn few_records_give_the_same_bits() {
    for solver in backends() {
        for entry in battery() {
            let scene = built(&entry.def);
            for steps in [1, 2, 3, 10] {
                check(&scene, &*solver, steps);
            }
        }
        for def in [
            pendulum(2.0),
            stack(&[2.0, 1.0]),
            motor_arm(),
            resolved(material(falling_disc(0.15, 0.7), 0.2, 0.7)),
            resolved(with_dt(oblique_collision(0.0, [1.0, 0.1]), 0.01)),
        ] {
            check(&built(&def), &*solver, 100);
        }
        check(&built(&pendulum(2.0)), &*solver, 1000);
        check(&built(&resolved(with_dt(billiard([0.3, 0.4], [1.7, 1.1]), 0.01))), &*solver, 1000);
    }
}

#[test]
fn impulses_are_seen_in_segments_too() {
    let press = |k: usize, record: &StepRecord| {
        let sources = record.islands.iter().flat_map(|island| &island.sources);
        let value = |i: usize| (0.7 * i as f64 + 0.1 * k as f64).cos();
        let seed = |(i, source): (usize, &RowSource)| RowImpulse {
            part: None,
            source: *source,
            value: value(i),
        };
        sources.enumerate().map(seed).collect::<Vec<_>>()
    };
    for solver in backends() {
        let scene = built(&pendulum(2.0));
        let controls = controls(0, 30);
        let tape = tangency::simulate(&scene, &*solver, 30).expect("a run");
        let run = sparse(&scene, &*solver, &controls);
        let full = gradient_with_impulses(&scene, &tape, |k, s| Some(coefficients(k, s)), press);
        let found = checkpointed_gradient_with_impulses(
            &scene,
            &*solver,
            &run,
            GradientMode::Exact,
            add,
            press,
        );
        assert_eq!(bits(&found.expect("a gradient")), bits(&full.expect("a gradient")));
    }
}

/// At most 2 ⌈√T⌉ records are held, and a run of no step has none.
#[test]
fn records_grow_with_the_root() {
    let (solver, scene) = (&backends()[0], built(&pendulum(2.0)));
    for (steps, most) in [(0, 0), (1, 1), (2, 2), (3, 3), (10, 6), (100, 19), (1000, 63)] {
        let run = sparse(&scene, &**solver, &controls(0, steps));
        assert_eq!((run.steps(), run.most_records()), (steps, most));
        let found = checkpointed_gradient(&scene, &**solver, &run, GradientMode::Exact, add)
            .expect("a gradient");
        assert_eq!(found.report.growth.len(), steps + 1);
    }
}

#[test]
fn another_scene_is_refused() {
    let (solver, scene) = (&backends()[0], built(&pendulum(2.0)));
    let run = sparse(&scene, &**solver, &controls(0, 20));
    let mut other = scene.clone();
    other.set(Param::Gravity(1), -9.0).expect("a number");
    let error = checkpointed_gradient(&other, &**solver, &run, GradientMode::Exact, add)
        .expect_err("another run");
    assert!(matches!(error, DiffError::OtherRun { first: 15, last: 19 }), "{error}");
}

/// The growth of the gradient of one number of the last state, back to the initial one.
fn growth(def: SceneDef, solver: &dyn LcpSolver, steps: usize, body: usize, axis: usize) -> f64 {
    let scene = built(&resolved(def));
    let tape = tangency::simulate(&scene, solver, steps).expect("a run");
    let seed = |k: usize, state: &State| {
        let mut seed = StateVector::like(state);
        seed.q[body][axis] = 1.0;
        (k == steps).then_some(seed)
    };
    let report = gradient(&scene, &tape, seed).expect("a gradient").report;
    assert_eq!((report.growth.len(), report.growth[steps]), (steps + 1, 1.0));
    assert!(report.growth.iter().all(|growth| *growth >= 1.0));
    assert!(report.greatest_growth().expect("a rollout").1 >= report.growth[0]);
    report.growth[0]
}

/// V37 (a): dy/dy₀ and dy/dvy₀ after n impacts, at T = 2 n: √((T dy/dy₀)² + (dy/dvy₀)²)/T.
#[test]
fn growth_between_discs() {
    for solver in backends() {
        for (impacts, by_place, by_speed) in [
            (1_u16, 3.0_f64, 4.0),
            (2, 17.0, 24.0),
            (5, 3_363.0, 4_756.0),
            (10, 22_619_537.0, 31_988_856.0),
        ] {
            let (def, end) = (with_dt(between_discs(), 0.02), 2.0 * f64::from(impacts));
            let found = growth(def, &*solver, 100 * usize::from(impacts), 2, 1);
            let exact = by_place.hypot(by_speed / end);
            near_relative("growth between discs", found, exact, 1e-6);
        }
    }
}

/// V37 (b): dx/dx₀ = ±1, dx/dvx₀ = ±T, however many walls were hit.
#[test]
fn growth_in_a_box() {
    for solver in backends() {
        for (steps, axis) in [(500, 0), (500, 1), (5000, 0)] {
            let def = with_dt(billiard([0.3, 0.4], [1.7, 1.1]), 0.02);
            let found = growth(def, &*solver, steps, 4, axis);
            near_relative("growth in a box", found, 2.0_f64.sqrt(), 1e-6);
        }
    }
}
