//! The ways to say what drives a batch.

use tangency_batch::{BatchError, Controls};
use tangency_bench::scenes;
use tangency_core::State;

use crate::fleet::{ENVIRONMENTS, built, fleet, pushes};

const STEPS: usize = 6;

#[test]
fn the_same_controls_in_every_form() {
    let scene = built(&scenes::race_cartpole());
    let held = pushes(&scene, ENVIRONMENTS);
    let planned: Vec<f64> = held.iter().flat_map(|u| [*u; STEPS]).collect();
    let policy = |environment: usize, _: usize, _: &State, control: &mut [f64]| {
        control[0] += held[environment];
    };
    let forms = [Controls::Held(&held), Controls::Planned(&planned), Controls::Policy(&policy)];
    let states = forms.map(|controls| {
        let mut batch = fleet(&scene);
        batch.advance(STEPS, controls).expect("all advance");
        batch.states().cloned().collect::<Vec<_>>()
    });
    assert_eq!(states[0], states[1]);
    assert_eq!(states[0], states[2]);
}

#[test]
fn a_policy_sees_environment_step_and_state() {
    let mut batch = fleet(&built(&scenes::race_cartpole()));
    let dt = batch.scene(0).dt();
    let policy = |environment: usize, k: usize, state: &State, control: &mut [f64]| {
        assert!((state.time - k as f64 * dt).abs() < 1e-12);
        assert_eq!(control, [0.0]);
        control[0] = (100 * environment + k) as f64;
    };
    batch.advance(STEPS, Controls::Policy(&policy)).expect("all advance");
    for environment in 0..ENVIRONMENTS {
        let record = batch.record(environment).expect("a last step");
        assert_eq!(record.control, [(100 * environment + STEPS - 1) as f64]);
    }
}

#[test]
fn controls_of_a_wrong_size_move_nothing() {
    let mut batch = fleet(&built(&scenes::race_cartpole()));
    let before: Vec<State> = batch.states().cloned().collect();
    let few = vec![0.0; ENVIRONMENTS - 1];
    let refused = batch.step(&few).expect_err("one number is missing");
    let said = "the controls have 22 numbers; environments × channels is 23";
    assert_eq!(refused.to_string(), said);
    let plan = Controls::Planned(&few);
    for refused in [
        batch.advance(2, plan).expect_err("a plan of one step"),
        batch.rollout(2, plan).map(drop).expect_err("the same"),
        batch.value_and_gradient(2, plan, |_, _, _, _| 0.0).map(drop).expect_err("the same"),
    ] {
        let ok = matches!(refused, BatchError::ControlSize { expected: 46, found: 22, .. });
        assert!(ok, "{refused}");
    }
    assert!(batch.states().eq(&before));
}

#[test]
fn scenes_without_channels_need_no_controls() {
    let mut batch = fleet(&built(&scenes::race_stack(2)));
    batch.step(&[]).expect("all step");
    batch.advance(2, Controls::Zero).expect("all advance");
    assert_eq!(batch.channels(), 0);
}
