//! Forces, controls and pairs.

use tangency::{ControlDef, ControlInput, ForceDef, PairDef, SceneDef};

use super::check;

#[test]
fn forces_controls_and_pairs() {
    let force = |force: ForceDef| move |d: &mut SceneDef| d.forces = vec![force];
    let control = |input: ControlInput| {
        move |d: &mut SceneDef| d.controls = vec![ControlDef { name: "u".into(), input }]
    };
    check(
        force(ForceDef { body: "nobody".into(), ..ForceDef::default() }),
        "forces[0].body names \"nobody\", which is not a body; known: floor, box, ball",
    );
    check(
        force(ForceDef { body: "box".into(), force: [f64::NAN, 0.0], ..ForceDef::default() }),
        "forces[0].force[0] is NaN: give a finite number",
    );
    check(
        force(ForceDef {
            body: "box".into(),
            start: Some(2.0),
            end: Some(1.0),
            ..ForceDef::default()
        }),
        "forces[0].end is 1: give an end that is not before the start",
    );
    check(
        control(ControlInput::ForceX { body: "floor".into() }),
        "controls[0].input.force_x.body: a force moves dynamic bodies only",
    );
    check(
        control(ControlInput::MotorSpeed { joint: "pin".into() }),
        "controls[0].input.motor_speed.joint: the joint has no motor; give it one",
    );
    check(
        control(ControlInput::JointForce { joint: "nut".into() }),
        "controls[0].input.joint_force.joint names \"nut\", which is not a joint; known: pin",
    );
    let pair = |bodies: [&str; 2], friction| {
        let bodies = bodies.map(String::from);
        PairDef { bodies, friction, ..PairDef::default() }
    };
    let (same, rough) = (pair(["box", "box"], None), pair(["box", "ball"], Some(-1.0)));
    check(|d| d.pairs = vec![same], "pairs[0].bodies: a pair needs two different bodies");
    check(|d| d.pairs = vec![rough], "pairs[0].friction is -1: give a finite number of 0 or more");
}

#[test]
fn what_would_be_lost() {
    let force = ForceDef { body: "floor".into(), force: [1.0, 0.0], ..ForceDef::default() };
    check(|d| d.forces = vec![force], "forces[0].body: a force moves dynamic bodies only");
    let late = ForceDef { body: "box".into(), start: Some(f64::NAN), ..ForceDef::default() };
    check(|d| d.forces = vec![late], "forces[0].start is NaN: give a finite time, or leave it out");
    // JSON has no infinity: a scene with one would not survive being written.
    let endless = ForceDef { body: "box".into(), end: Some(f64::INFINITY), ..ForceDef::default() };
    check(
        |d| d.forces = vec![endless],
        "forces[0].end is inf: give a finite time, or leave it out",
    );
    let pair = |bodies: [&str; 2]| {
        let bodies = bodies.map(String::from);
        PairDef { bodies, friction: Some(0.1), ..PairDef::default() }
    };
    check(
        |d| d.pairs = vec![pair(["box", "ball"]), pair(["ball", "box"])],
        "pairs[1].bodies: this pair is given twice; merge both",
    );
}

#[test]
fn long_names() {
    let name = "é".repeat(200);
    let shown = "é".repeat(40);
    let twin = name.clone();
    check(
        |d| d.bodies[1].name = name,
        &format!("bodies[1].name is \"{shown}…\": this name is longer than 200 bytes; shorten it"),
    );
    check(
        |d| d.joints[0].bodies[1] = twin,
        &format!(
            "joints[0].bodies[1] names \"{shown}…\", which is not a body; known: floor, box, ball"
        ),
    );
}
