//! Numbers that are changed after a scene was built.

use tangency::{JointKind, Limits, Param, Parameter, Scene, Shape};

use super::good;
use crate::engine::built;

#[test]
fn numbers_set_later() {
    let mut scene = built(&good());
    let mut refusal = |param, value| scene.set(param, value).expect_err("refused").to_string();
    assert_eq!(refusal(Param::Mass(1), -1.0), "Mass(1) is -1: give a positive finite number");
    assert_eq!(
        refusal(Param::Mass(9), 1.0),
        "Mass(9): the scene has no such number; check its index and kind"
    );
    assert_eq!(
        refusal(Param::Restitution(1), 2.0),
        "Restitution(1) is 2: give a number from 0 to 1"
    );
}

/// The message of a change that is refused, which leaves the scene as it was.
#[track_caller]
fn refused(scene: &Scene, param: Param, value: f64, message: &str) {
    let mut changed = scene.clone();
    let error = changed.set(param, value).expect_err("refused");
    assert_eq!(error.to_string(), message);
    assert_eq!(changed.get(param), scene.get(param));
}

#[test]
fn numbers_that_contradict_others() {
    let mut def = good();
    def.bodies[1].shapes = vec![Shape::Capsule { a: [0.0; 2], b: [1.0, 0.0], radius: 0.1 }];
    let limits = Limits { lower: Some(-1.0), upper: Some(1.0) };
    let anchor = [3.0, 2.0];
    def.joints[0].kind = JointKind::Revolute { anchor, anchor_b: None, limits, motor: None };
    let scene = built(&def);
    refused(
        &scene,
        Param::Lower(0),
        1.5,
        "Lower(0) is 1.5: give a lower limit that is not above the upper one",
    );
    refused(
        &scene,
        Param::Upper(0),
        -1.5,
        "Upper(0) is -1.5: give an upper limit that is not below the lower one",
    );
    refused(
        &scene,
        Param::Velocity(0, 1),
        1.0,
        "Velocity(0, 1): a static body cannot move; make it kinematic",
    );
    refused(
        &scene,
        Param::Radius(1, 0),
        1e12,
        "Radius(1, 0): a and b of the capsule are 1 m apart; use a circle of radius 1000000000000 \
         instead",
    );
    refused(
        &scene,
        Param::Mass(2),
        1e-200,
        "Mass(2) is 1e-200: numbers from 1e-50 to 1e50 can be computed with, change units",
    );
    let mut large = good();
    large.bodies[1].shapes = vec![Shape::Circle { radius: 1e20, center: [0.0; 2] }];
    refused(
        &built(&large),
        Param::Density(1),
        1e20,
        "Density(1): density and shapes make a mass of 3.1e60 kg; from 1e-50 to 1e50 \
         can be computed with, give `mass`",
    );
}

/// A parameter sets all its numbers, or none.
#[test]
fn parameters_in_part() {
    let mut scene = built(&good());
    let mass = [1, 2].map(|i| scene.get(Param::Mass(i)));
    let parameter = Parameter {
        name: "mass and friction".into(),
        targets: vec![(Param::Mass(1), 1.0), (Param::Mass(2), -1.0)],
    };
    let error = parameter.set(&mut scene, 2.0).expect_err("a negative mass");
    assert_eq!(error.to_string(), "Mass(2) is -2: give a positive finite number");
    assert_eq!([1, 2].map(|i| scene.get(Param::Mass(i))), mass);
}
