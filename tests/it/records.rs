//! States, records, runs and scenes save and load without loss.

use tangency::diff::{StateVector, gradient};
use tangency::{Param, Rollout, SceneDef, State};
use tangency_bench::scenes;

use crate::engine::{backends, built, near_relative, run};

/// Out to JSON and back.
fn reloaded<T: serde::Serialize + serde::de::DeserializeOwned>(value: &T) -> T {
    let text = serde_json::to_string(value).expect("it can be written");
    serde_json::from_str(&text).expect("it can be read")
}

fn tapes() -> Vec<(tangency::Scene, Rollout)> {
    let mut list = Vec::new();
    for solver in backends() {
        for mut def in [
            scenes::compound_tumble(),
            scenes::soft_bridge(4),
            scenes::sliding_box(1.0, 0.3, 1.0),
            scenes::spring_cart(),
        ] {
            def.controls.clear();
            let scene = built(&def);
            let tape = run(&scene, &*solver, 60);
            list.push((scene, tape));
        }
    }
    list
}

#[test]
fn runs_and_their_parts() {
    for (_, tape) in tapes() {
        assert_eq!(reloaded(&tape), tape);
        assert_eq!(&reloaded(tape.last()), tape.last());
        assert_eq!(reloaded(&tape.records[20]), tape.records[20]);
    }
}

#[test]
fn awkward_numbers() {
    let numbers = [0.1 + 0.2, 1.0 / 3.0, -0.0, f64::MIN_POSITIVE, 1.797e308, 5e-324];
    let state = State {
        time: numbers[0],
        q: vec![nalgebra::Vector3::new(numbers[1], numbers[2], numbers[3])],
        v: vec![nalgebra::Vector3::new(numbers[4], numbers[5], -numbers[1])],
    };
    let again = reloaded(&state);
    let bits =
        |s: &State| s.q.iter().chain(&s.v).flatten().map(|x| x.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&again), bits(&state));
}

#[test]
fn a_loaded_tape_has_the_same_gradient() {
    for (scene, tape) in tapes() {
        let last = tape.records.len();
        let seed = |k: usize, state: &State| {
            let mut seed = StateVector::like(state);
            seed.q.iter_mut().for_each(|q| (q.x, q.z) = (1.0, 0.5));
            (k == last).then_some(seed)
        };
        let by = |tape: &Rollout| {
            let by = gradient(&scene, tape, seed).expect("a gradient").by;
            by.by(&scene, Param::Velocity(scene.bodies().len() - 1, 0))
        };
        let (fresh, loaded) = (by(&tape), by(&reloaded(&tape)));
        near_relative("gradient of a loaded tape", loaded, fresh, 1e-10);
    }
}

#[test]
fn definitions() {
    for def in [
        scenes::motor_arm(),
        scenes::spring_cart(),
        scenes::soft_bridge(3),
        scenes::conveyor(),
        scenes::piston(),
        scenes::compound_tumble(),
        scenes::paper_chain(3, 7.0),
    ] {
        let again: SceneDef = reloaded(&def);
        assert_eq!(again, def);
    }
}
