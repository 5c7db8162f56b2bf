//! Vectors that a derivative is asked for.

use nalgebra::Vector3;
use tangency::diff::DiffError;
use tangency::{RolloutVector, SceneDef, StateVector, gradient, simulate, tangent};
use tangency_bench::scenes::disc;

use super::good;
use crate::engine::{backends, built};

const AFTER: &str = "make it for this scene and rollout";
const NAN: &str = "is not finite; look for a division by zero in the loss, or for an overflow";

#[test]
fn seeds() {
    let scene = built(&good());
    let run = simulate(&scene, &*backends()[0], 2).expect("a run");
    let refusal = |spoil: fn(&mut StateVector)| {
        let mut seed = StateVector::like(run.last());
        spoil(&mut seed);
        gradient(&scene, &run, |_, _| Some(seed.clone())).expect_err("refused").to_string()
    };
    assert_eq!(
        refusal(|s| s.q.truncate(1)),
        format!("the seed of a state has 1 entries, expected 3; {AFTER}")
    );
    assert_eq!(
        refusal(|s| s.v.push(Vector3::zeros())),
        format!("the seed of a state has 4 entries, expected 3; {AFTER}")
    );
    assert_eq!(refusal(|s| s.q[1].x = f64::NAN), format!("the seed of a state {NAN}"));
    assert_eq!(refusal(|s| s.time = f64::INFINITY), format!("the seed of a state {NAN}"));
}

#[test]
fn directions() {
    let scene = built(&good());
    let run = simulate(&scene, &*backends()[0], 2).expect("a run");
    let refusal = |spoil: fn(&mut RolloutVector)| {
        let mut along = RolloutVector::zeros(&scene, 2);
        spoil(&mut along);
        tangent(&scene, &run, &along).expect_err("refused").to_string()
    };
    let state = "the direction of the state";
    assert_eq!(
        refusal(|a| a.initial.q.clear()),
        format!("{state} has 0 entries, expected 3; {AFTER}")
    );
    assert_eq!(refusal(|a| a.initial.v[2].z = f64::NAN), format!("{state} {NAN}"));
    assert_eq!(
        refusal(|a| a.controls.truncate(1)),
        format!("the direction of the controls has 1 entries, expected 2; {AFTER}")
    );
    assert_eq!(
        refusal(|a| a.controls[1].push(1.0)),
        format!("the direction of the control has 1 entries, expected 0; {AFTER}")
    );
    assert_eq!(
        refusal(|a| a.scene.joints.clear()),
        format!("the direction of the scene has 0 entries, expected 1; {AFTER}")
    );
    assert_eq!(
        refusal(|a| a.scene.bodies[1].radii.clear()),
        format!("the direction of the scene has 0 entries, expected 1; {AFTER}")
    );
    assert_eq!(refusal(|a| a.scene.dt = f64::NAN), format!("the direction of the scene {NAN}"));
}

#[test]
fn rollouts_of_another_scene() {
    let (scene, other) = (built(&good()), SceneDef::default());
    let other = built(&SceneDef { bodies: vec![disc("ball", 0.1, [0.0; 2])], ..other });
    let run = simulate(&other, &*backends()[0], 2).expect("a run");
    let refused = gradient(&scene, &run, |_, _| None).expect_err("refused");
    assert!(matches!(refused, DiffError::Size { expected: 3, found: 1, .. }), "{refused}");
    let along = RolloutVector::zeros(&scene, 2);
    let refused = tangent(&scene, &run, &along).expect_err("refused");
    assert!(matches!(refused, DiffError::Size { expected: 3, found: 1, .. }), "{refused}");
}
