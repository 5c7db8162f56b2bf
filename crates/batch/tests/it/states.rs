//! Where environments are, what they differ in, and how they get back.

use tangency_batch::{Batch, Controls};
use tangency_bench::scenes;
use tangency_core::{Param, Simulator, simulate};

use crate::fleet::{ENVIRONMENTS, built, fleet, solver, start};

const STEPS: usize = 10;

#[test]
fn environments_with_numbers_of_their_own() {
    let shared = built(&scenes::race_cartpole());
    let mass = |i: usize| 0.1 + 0.02 * i as f64;
    let own = |i: usize| {
        let mut scene = shared.clone();
        scene.set(Param::Mass(1), mass(i)).expect("a mass");
        scene
    };
    let mut set = Batch::new(shared.clone(), 8, solver());
    for i in 0..8 {
        set.set(i, Param::Mass(1), mass(i)).expect("a mass");
    }
    let mut given =
        Batch::of_scenes((0..8).map(own).collect(), solver()).expect("the same channels");
    set.advance(STEPS, Controls::Zero).expect("all advance");
    given.advance(STEPS, Controls::Zero).expect("all advance");
    for i in 0..8 {
        let alone = simulate(&own(i), &*solver(), STEPS).expect("a run");
        assert_eq!(set.state(i), alone.last());
        assert_eq!(given.state(i), alone.last());
    }
    assert_ne!(set.state(0), set.state(7));
    assert!(set.set(0, Param::Mass(1), -1.0).is_err());
    assert_eq!(set.scene(0).get(Param::Mass(1)), Some(0.1));
}

#[test]
fn environments_with_shapes_of_their_own() {
    let def = scenes::race_bounce();
    let shared = built(&def);
    let radius = |i: usize| 0.1 + 0.01 * (i % 5) as f64;
    let own = |i: usize| {
        let mut scene = if i.is_multiple_of(2) { shared.clone() } else { built(&def) };
        scene.set(Param::Radius(1, 0), radius(i)).expect("a radius");
        scene.set(Param::Position(1, 1), radius(i) + 0.01).expect("a place just above the floor");
        scene
    };
    let scenes = (0..ENVIRONMENTS).map(own).collect();
    let mut batch = Batch::of_scenes(scenes, solver()).expect("the same channels");
    for steps in 1..6 {
        batch.advance(steps, Controls::Zero).expect("all advance");
    }
    for i in 0..ENVIRONMENTS {
        let alone = simulate(&own(i), &*solver(), 15).expect("a run");
        assert_eq!(batch.record(i), alone.records.last());
        assert!(alone.records.iter().any(|record| !record.contact_impulses().is_empty()));
    }
}

#[test]
fn a_reset_moves_one_environment() {
    let scene = built(&scenes::race_stack(3));
    let mut batch = fleet(&scene);
    batch.advance(STEPS, Controls::Zero).expect("all advance");
    let before: Vec<_> = batch.states().cloned().collect();
    batch.set(2, Param::Velocity(1, 0), 0.25).expect("a velocity");
    batch.reset(2);
    batch.reset_to(3, start(&scene, 3)).expect("a state of the scene");
    assert_eq!(batch.state(2).v[1].x, 0.25);
    assert_eq!(batch.state(3), &start(&scene, 3));
    assert!(batch.record(2).is_none());
    for i in (0..ENVIRONMENTS).filter(|i| ![2, 3].contains(i)) {
        assert_eq!(batch.state(i), &before[i]);
    }
    let solver = solver();
    let mut alone = Simulator::starting(&scene, &*solver, start(&scene, 3));
    for _ in 0..STEPS {
        alone.step(&[]).expect("a step");
    }
    batch.advance(STEPS, Controls::Zero).expect("all advance");
    assert_eq!(batch.record(3), alone.record());
}

#[test]
fn looking_ahead_moves_nothing() {
    let mut batch = fleet(&built(&scenes::race_stack(2)));
    batch.advance(3, Controls::Zero).expect("all advance");
    let before: Vec<_> = batch.states().cloned().collect();
    let ends = batch.map_rollouts(STEPS, Controls::Zero, |_, run| run.last().clone());
    let ends = ends.expect("no controls").all().expect("all rollouts");
    let tapes = batch.rollout(STEPS, Controls::Zero).expect("no controls").all();
    for (i, tape) in tapes.expect("all rollouts").iter().enumerate() {
        assert_eq!((&tape.initial, tape.last()), (&before[i], &ends[i]));
    }
    assert!(batch.states().eq(&before));
}

#[test]
fn a_batch_of_none() {
    let mut batch = Batch::of_scenes(Vec::new(), solver()).expect("nothing to disagree");
    assert!(batch.is_empty());
    batch.step(&[]).expect("nothing to do");
    assert!(batch.rollout(3, Controls::Zero).expect("no controls").results.is_empty());
}

/// A loss that has work of its own for the threads may be interrupted by another environment's.
#[test]
fn a_loss_may_use_the_threads_itself() {
    let batch = fleet(&built(&scenes::race_stack(2)));
    let last = |_: usize, run: &tangency_core::Rollout| {
        let half = |from: usize| run.states().skip(from).step_by(2).map(|s| s.v[1].x).sum::<f64>();
        let (even, odd) = rayon::join(|| half(0), || half(1));
        even + odd
    };
    let sums = batch.map_rollouts(STEPS, Controls::Zero, last).expect("no controls").all();
    assert_eq!(sums.expect("all rollouts").len(), ENVIRONMENTS);
}
