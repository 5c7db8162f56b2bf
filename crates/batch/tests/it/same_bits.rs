//! Every environment does what it would do by itself, to the last bit, on any number of threads.

use tangency_batch::{Batch, Controls};
use tangency_bench::state_hash;
use tangency_core::{Rollout, Scene, Simulator, State, StepRecord, rollout, simulate};
use tangency_diff::gradient_adding;

use crate::fleet::{ENVIRONMENTS, bits, busy, fleet, loss, on_threads, pushes, solver, start};

const STEPS: usize = 25;

fn planned(plan: &[f64], scene: &Scene, environment: usize, k: usize) -> Vec<f64> {
    let channels = scene.controls().len();
    plan[(environment * STEPS + k) * channels..][..channels].to_vec()
}

/// The rollout of one environment by the engine's own function.
fn alone(scene: &Scene, plan: &[f64], environment: usize) -> Rollout {
    let control = |k: usize, _: &State| planned(plan, scene, environment, k);
    rollout(scene, &*solver(), start(scene, environment), STEPS, control).expect("a rollout")
}

#[test]
fn most_scenes_touch() {
    let touching = busy().into_iter().filter(|scene| {
        let run = simulate(scene, &*solver(), STEPS).expect("a run");
        run.records.iter().any(|record| !record.contact_impulses().is_empty())
    });
    assert!(touching.count() >= 3);
}

#[test]
fn environments_move_as_simulators_do() {
    for scene in busy() {
        let plan = pushes(&scene, ENVIRONMENTS * STEPS);
        let alone = |i: usize| {
            let solver = solver();
            let mut one = Simulator::starting(&scene, &*solver, start(&scene, i));
            for k in 0..STEPS {
                one.step(&planned(&plan, &scene, i, k)).expect("a step");
            }
            one.record().cloned().expect("a last step")
        };
        let expected: Vec<StepRecord> = (0..ENVIRONMENTS).map(alone).collect();
        let together = || {
            let mut batch = fleet(&scene);
            batch.advance(STEPS, Controls::Planned(&plan)).expect("all advance");
            let last = |i| batch.record(i).cloned().expect("a last step");
            (0..ENVIRONMENTS).map(last).collect::<Vec<_>>()
        };
        for (threads, found) in on_threads(together) {
            assert!(found == expected, "{}, {threads} threads", scene.def().name);
            let states = |records: &[StepRecord]| state_hash(records.iter().map(|it| &it.after));
            assert_eq!(states(&found), states(&expected));
        }
    }
}

#[test]
fn rollouts_are_those_of_the_engine() {
    for scene in busy() {
        let plan = pushes(&scene, ENVIRONMENTS * STEPS);
        let expected: Vec<Rollout> = (0..ENVIRONMENTS).map(|i| alone(&scene, &plan, i)).collect();
        let batch = fleet(&scene);
        let together = || {
            let outcomes =
                batch.rollout(STEPS, Controls::Planned(&plan)).expect("controls that fit");
            outcomes.all().expect("all rollouts")
        };
        for (threads, found) in on_threads(together) {
            assert!(bits(&found) == bits(&expected), "{}, {threads} threads", scene.def().name);
        }
    }
}

#[test]
fn gradients_are_those_of_one_rollout() {
    for scene in busy() {
        let plan = pushes(&scene, ENVIRONMENTS * STEPS);
        let alone = |i: usize| {
            let (run, mut value) = (alone(&scene, &plan, i), 0.0);
            let term = |k, state: &_, bar: &mut _| value += loss(k, state, bar);
            let gradient = gradient_adding(&scene, &run, term).expect("a gradient");
            (value, gradient)
        };
        let expected: Vec<_> = (0..ENVIRONMENTS).map(alone).collect();
        let batch = fleet(&scene);
        for (threads, found) in on_threads(|| evaluations(&batch, &plan)) {
            assert!(found == bits(&expected), "{}, {threads} threads", scene.def().name);
        }
        for (threads, found) in on_threads(|| checkpointed(&batch, &plan)) {
            assert!(found == bits(&expected), "{}, {threads} threads", scene.def().name);
        }
        let gradients: Vec<_> = expected.iter().map(|(_, gradient)| gradient).collect();
        for (threads, found) in on_threads(|| gradients_of_tapes(&batch, &plan)) {
            assert!(found == bits(&gradients), "{}, {threads} threads", scene.def().name);
        }
    }
}

/// Values and gradients, tape by tape.
fn evaluations(batch: &Batch, plan: &[f64]) -> String {
    let plan = Controls::Planned(plan);
    let outcomes = batch.value_and_gradient(STEPS, plan, |_, k, state, bar| loss(k, state, bar));
    let all = outcomes.expect("controls that fit").all().expect("all gradients");
    bits(&all.into_iter().map(|it| (it.value, it.gradient)).collect::<Vec<_>>())
}

/// The same from few records.
fn checkpointed(batch: &Batch, plan: &[f64]) -> String {
    let term = |_, k, state: &_, bar: &mut _| loss(k, state, bar);
    let outcomes = batch.checkpointed_value_and_gradient(STEPS, Controls::Planned(plan), term);
    let all = outcomes.expect("controls that fit").all().expect("all gradients");
    bits(&all.into_iter().map(|it| (it.value, it.gradient)).collect::<Vec<_>>())
}

/// Gradients of tapes that are all held at once.
fn gradients_of_tapes(batch: &Batch, plan: &[f64]) -> String {
    let tapes = batch.rollout(STEPS, Controls::Planned(plan)).expect("controls that fit");
    let outcomes = batch.gradient(&tapes.results, |_, k, state, bar| {
        loss(k, state, bar);
    });
    bits(&outcomes.expect("a tape per environment").all().expect("all gradients"))
}

#[test]
fn work_done_before_changes_nothing() {
    for scene in busy() {
        let plan = pushes(&scene, ENVIRONMENTS * STEPS);
        let batch = fleet(&scene);
        let first = evaluations(&batch, &plan);
        batch.rollout(3, Controls::Zero).expect("controls that fit");
        assert!(first == evaluations(&batch, &plan), "{}", scene.def().name);
    }
}

#[test]
fn steps_one_by_one_or_all_at_once() {
    for scene in busy() {
        let controls = pushes(&scene, ENVIRONMENTS);
        let (mut one, mut many) = (fleet(&scene), fleet(&scene));
        for _ in 0..STEPS {
            one.step(&controls).expect("all step");
        }
        many.advance(STEPS, Controls::Held(&controls)).expect("all advance");
        assert!(one.states().eq(many.states()), "{}", scene.def().name);
    }
}
