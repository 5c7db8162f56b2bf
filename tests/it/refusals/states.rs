//! States and controls of a step.

use tangency::{ControlDef, ControlInput, JointKind, SceneDef, State, StepScratch, inspect, step};
use tangency_bench::scenes::{disc, hinge};

use super::good;
use crate::engine::{backends, built};

/// The error of the first step from a spoilt state or control.
#[track_caller]
fn check_step(def: &SceneDef, spoil: impl Fn(&mut State, &mut Vec<f64>), message: &str) {
    let scene = built(def);
    for solver in backends() {
        let (mut state, mut control) = (scene.initial_state(), vec![0.0; scene.controls().len()]);
        spoil(&mut state, &mut control);
        let mut scratch = StepScratch::default();
        let result = step(&scene, &*solver, &state, &control, &mut scratch);
        assert_eq!(result.expect_err("it must be refused").to_string(), message);
    }
}

#[test]
fn states_and_controls() {
    let mut def = good();
    let input = ControlInput::ForceX { body: "box".into() };
    def.controls = vec![ControlDef { name: "push".into(), input }];
    check_step(
        &def,
        |state, _| state.q[1].x = f64::NAN,
        "pose of body 1 is not finite; look for an earlier division by zero",
    );
    check_step(
        &def,
        |state, _| state.v[2].z = f64::INFINITY,
        "velocity of body 2 is not finite; look for an earlier division by zero",
    );
    check_step(
        &def,
        |_, control| control[0] = f64::NAN,
        "control 0 is not finite; look for an earlier division by zero",
    );
    check_step(&def, |_, u| u.clear(), "the control has 0 numbers, the scene 1 control channels");
    check_step(&def, |state, _| state.q.truncate(2), "the state has 2 bodies, the scene 3");
}

#[test]
fn coincident_centres() {
    let bodies = vec![disc("a", 0.2, [1.0, 1.0]), disc("b", 0.3, [1.0, 1.0])];
    check_step(
        &SceneDef { bodies, ..SceneDef::default() },
        |_, _| {},
        "at time 0: the centres of touching round features of bodies 0 and 1 coincide, so that \
         their contact has no normal; move one of the bodies",
    );
}

/// A spring that is pressed through its own length of zero has no direction there.
#[test]
fn coincident_anchors() {
    let mut def = good();
    let (anchor_a, anchor_b) = ([0.0, 0.5], [3.0, 1.0]);
    let mut spring = hinge("coil", "box", "ball", [0.0; 2]);
    let (length, stiffness, damping) = (None, 10.0, 0.1);
    spring.kind = JointKind::Spring { anchor_a, anchor_b, length, stiffness, damping };
    def.joints = vec![spring];
    check_step(
        &def,
        |state, _| (state.q[1], state.time) = (state.q[2], 0.25),
        "at time 0.25: the anchors of joint coil coincide, so that their distance has no direction; \
         move one of its bodies or use a (soft) revolute joint",
    );
}

/// Discs that nearly coincide have a normal that is rounding.
#[test]
fn nearly_coincident_centres() {
    let bodies = vec![disc("a", 0.2, [0.0; 2]), disc("b", 0.3, [1e-161, 0.0])];
    check_step(
        &SceneDef { bodies, ..SceneDef::default() },
        |_, _| {},
        "at time 0: the centres of touching round features of bodies 0 and 1 coincide, so that \
         their contact has no normal; move one of the bodies",
    );
}

#[test]
fn states_to_inspect() {
    let scene = built(&good());
    let mut state = scene.initial_state();
    state.v.truncate(1);
    let message = "the state has 1 bodies, the scene 3";
    assert_eq!(inspect(&scene, &state).expect_err("refused").to_string(), message);
    assert_eq!(scene.penetration(&state).expect_err("refused").to_string(), message);
    let mut state = scene.initial_state();
    state.time = f64::NAN;
    let message = "the time of the state is NaN; give a finite number of seconds";
    assert_eq!(inspect(&scene, &state).expect_err("refused").to_string(), message);
}

/// A state that a step would leave behind infinite is refused, and so is a time without a value.
#[test]
fn states_that_overflow() {
    let bodies = vec![disc("ball", 0.2, [0.0; 2])];
    let def = SceneDef { bodies, dt: 10.0, ..SceneDef::default() };
    check_step(
        &def,
        |state, _| (state.q[0].x, state.v[0].x) = (f64::MAX, f64::MAX),
        "pose of body 0 is not finite; look for an earlier division by zero",
    );
    check_step(
        &def,
        |state, _| state.time = f64::INFINITY,
        "the time of the state is inf; give a finite number of seconds",
    );
}
