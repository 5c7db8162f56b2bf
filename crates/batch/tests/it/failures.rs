//! One environment fails; the others do not notice.

use tangency_batch::{Batch, BatchError, Controls, Failure};
use tangency_bench::scenes;
use tangency_core::StepError;

use crate::fleet::{ENVIRONMENTS, built, fleet, loss, on_threads, pushes, solver};

/// The one that fails.
const BAD: usize = 5;
const STEPS: usize = 4;
/// The step at which it fails.
const AT: usize = 2;

/// Controls for all steps, one of them not a number.
fn plan(batch: &Batch) -> Vec<f64> {
    let mut plan = pushes(batch.scene(0), ENVIRONMENTS * STEPS);
    plan[BAD * STEPS + AT] = f64::NAN;
    plan
}

fn cartpoles() -> Batch {
    fleet(&built(&scenes::race_cartpole()))
}

#[track_caller]
fn check_failure(failures: &[Failure]) {
    assert_eq!(failures.len(), 1, "{failures:?}");
    let expected =
        "environment 5, step 2: control 0 is not finite; look for an earlier division by zero";
    assert_eq!(failures[0].to_string(), expected);
    assert_eq!(failures[0].environment(), BAD);
    let cause = matches!(failures[0], Failure::Step { source: StepError::NotFinite { .. }, .. });
    assert!(cause);
}

#[test]
fn others_advance() {
    on_threads(|| {
        let (mut batch, mut well) = (cartpoles(), cartpoles());
        let bad = plan(&batch);
        let good: Vec<f64> = bad.iter().map(|u| if u.is_nan() { 0.0 } else { *u }).collect();
        let failed =
            batch.advance(STEPS, Controls::Planned(&bad)).expect_err("one is not a number");
        assert!(
            failed.to_string().starts_with("1 of 23 environments failed; the first: environment 5")
        );
        let BatchError::Failed { failures, .. } = failed else { panic!("{failed}") };
        check_failure(&failures);
        well.advance(STEPS, Controls::Planned(&good)).expect("all advance");
        for i in (0..ENVIRONMENTS).filter(|i| *i != BAD) {
            assert_eq!(batch.state(i), well.state(i));
        }
        let waits = batch.state(BAD).time;
        assert!((waits - AT as f64 * batch.scene(BAD).dt()).abs() < 1e-12, "{waits}");
        batch.reset(BAD);
        batch.step(&pushes(batch.scene(0), ENVIRONMENTS)).expect("all step");
    });
}

#[test]
fn others_have_rollouts_and_gradients() {
    let batch = cartpoles();
    let plan = plan(&batch);
    let tapes = batch.rollout(STEPS, Controls::Planned(&plan)).expect("controls that fit");
    check_failure(&tapes.failures);
    let gradients = batch.gradient(&tapes.results, |_, k, state, bar| {
        loss(k, state, bar);
    });
    let gradients = gradients.expect("a place per environment");
    let missing = matches!(gradients.failures[..], [Failure::NoRollout { environment: BAD }]);
    assert!(missing, "{:?}", gradients.failures);
    let term = |_, k, state: &_, bar: &mut _| loss(k, state, bar);
    let evaluations = batch.value_and_gradient(STEPS, Controls::Planned(&plan), term);
    let evaluations = evaluations.expect("controls that fit");
    check_failure(&evaluations.failures);
    for i in 0..ENVIRONMENTS {
        let evaluation = evaluations.results[i].as_ref();
        assert_eq!(gradients.results[i].as_ref(), evaluation.map(|it| &it.gradient));
        assert_eq!(evaluation.is_none(), i == BAD);
    }
    assert!(evaluations.all().is_err());
}

#[test]
fn a_loss_or_seed_that_is_not_a_number() {
    let batch = cartpoles();
    let spoilt = batch.value_and_gradient(STEPS, Controls::Zero, |environment, k, state, bar| {
        let value = loss(k, state, bar);
        if environment == BAD { f64::NAN } else { value }
    });
    let failures = spoilt.expect("no controls").failures;
    assert!(matches!(failures[..], [Failure::Loss { environment: BAD, .. }]), "{failures:?}");
    let spoilt = batch.value_and_gradient(STEPS, Controls::Zero, |environment, _, _, bar| {
        bar.q[0].x = if environment == BAD { f64::INFINITY } else { 1.0 };
        0.0
    });
    let failures = spoilt.expect("no controls").failures;
    assert!(matches!(failures[..], [Failure::Gradient { environment: BAD, .. }]), "{failures:?}");
}

#[test]
fn what_does_not_fit_is_refused() {
    let batch = cartpoles();
    let refused = batch.gradient(&[None], |_, _, _, _| ()).expect_err("one place for 23");
    assert_eq!(refused.to_string(), "1 rollouts were given for 23 environments");

    let scenes = vec![built(&scenes::race_cartpole()), built(&scenes::race_stack(1))];
    let refused = Batch::of_scenes(scenes, solver()).map(drop).expect_err("other channels");
    let said = "the scene of environment 1 has 0 control channels, that of environment 0 1; \
                give all scenes the same channels";
    assert_eq!(refused.to_string(), said);
}

#[test]
fn a_state_that_does_not_fit_is_refused() {
    let mut batch = cartpoles();
    let before = batch.state(BAD).clone();
    let mut state = before.clone();
    state.q[1].y = f64::NAN;
    let refused = batch.reset_to(BAD, state).expect_err("not a number");
    assert!(refused.to_string().starts_with("environment 5 cannot be reset: pose of body 1"));
    let mut state = before.clone();
    state.v.pop();
    let refused = batch.reset_to(BAD, state).expect_err("a body is missing");
    assert!(matches!(refused, BatchError::State { environment: BAD, .. }), "{refused}");
    assert_eq!(batch.state(BAD), &before);
}
