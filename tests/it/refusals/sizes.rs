//! Numbers too large or too small to compute with: what is accepted runs, at either end.

use tangency::{
    BodyDef, ForceDef, JointKind, Limits, Param, Scene, SceneDef, Shape, Softness, WORLD, simulate,
};
use tangency_bench::scenes::{block, disc, floor, hinge};

use super::{check, good};
use crate::engine::{backends, built};

const UNITS: &str = "numbers from 1e-50 to 1e50 can be computed with, change units";

#[test]
fn of_the_scene_and_its_bodies() {
    let body = |f: fn(&mut BodyDef)| move |d: &mut SceneDef| f(&mut d.bodies[1]);
    check(|d| d.dt = 1e-300, &format!("dt is 1e-300: {UNITS}"));
    check(|d| d.dt = 1e300, &format!("dt is 1e300: {UNITS}"));
    check(|d| d.gravity[0] = -1e60, &format!("gravity[0] is -1e60: {UNITS}"));
    check(body(|b| b.mass = Some(1e300)), &format!("bodies[1].mass is 1e300: {UNITS}"));
    check(body(|b| b.mass = Some(5e-324)), &format!("bodies[1].mass is 5e-324: {UNITS}"));
    check(body(|b| b.inertia = Some(1e-60)), &format!("bodies[1].inertia is 1e-60: {UNITS}"));
    check(body(|b| b.friction = 1e-320), &format!("bodies[1].friction is 1e-320: {UNITS}"));
    check(body(|b| b.position[1] = 1e200), &format!("bodies[1].position[1] is 1e200: {UNITS}"));
    check(body(|b| b.velocity[0] = -1e99), &format!("bodies[1].velocity[0] is -1e99: {UNITS}"));
}

#[test]
fn of_shapes() {
    let shape = |shape: Shape| move |d: &mut SceneDef| d.bodies[1].shapes = vec![shape];
    let lengths = "lengths from 1e-50 to 1e50 can be computed with, change units";
    check(
        shape(Shape::Circle { radius: 1e300, center: [0.0; 2] }),
        &format!("bodies[1].shapes[0]: radius is 1e300; {lengths}"),
    );
    check(
        shape(Shape::Circle { radius: 1e-200, center: [0.0; 2] }),
        &format!("bodies[1].shapes[0]: radius is 1e-200; {lengths}"),
    );
    check(
        shape(Shape::Polygon { points: vec![[0.0; 2], [1e200, 0.0], [0.0, 1e200]] }),
        &format!("bodies[1].shapes[0]: points is 1e200; {lengths}"),
    );
    check(
        shape(Shape::Polygon { points: vec![[0.0; 2], [1e-60, 0.0], [0.0, 1e-60]] }),
        &format!("bodies[1].shapes[0]: extent of points is 1e-60; {lengths}"),
    );
    check(
        shape(Shape::Rectangle { width: 1e-30, height: 1e-30, center: [0.0; 2], angle: 0.0 }),
        "bodies[1]: density and shapes make a mass of 1.0e-60 kg; from 1e-50 to 1e50 can be computed \
         with, give `mass`",
    );
    check(
        |d| d.bodies[0].shapes = vec![Shape::HalfPlane { normal: [0.0, 1e-160], offset: 0.0 }],
        "bodies[0].shapes[0]: normal is [0.0, 1e-160]; it must have a direction, give for example \
         [0, 1]",
    );
    check(
        |d| d.bodies[1].shapes = vec![Shape::Circle { radius: 1.0, center: [0.0; 2] }; 70_000],
        "bodies[1].shapes: shapes has 70000 entries; at most 65535 can be numbered, split the body",
    );
}

#[test]
fn of_joints_and_forces() {
    let joint = |kind: JointKind| move |d: &mut SceneDef| d.joints[0].kind = kind;
    let no = Limits::default();
    check(
        joint(JointKind::Slot { anchor: [0.0; 2], axis: [1e-160, 0.0], limits: no, motor: None }),
        "joints[0].kind.slot.axis: an axis needs a direction",
    );
    check(
        joint(JointKind::Slot { anchor: [0.0; 2], axis: [1e200, 0.0], limits: no, motor: None }),
        &format!("joints[0].kind.slot.axis[0] is 1e200: {UNITS}"),
    );
    check(
        joint(JointKind::Distance {
            anchor_a: [0.0, 1.0],
            anchor_b: [1e-160, 1.0],
            length: Some(1.0),
        }),
        "joints[0].kind.distance.anchor_b: the anchors coincide, so their distance has no \
         direction; use a (soft) revolute joint",
    );
    check(
        |d| d.joints[0].softness = Some(Softness { stiffness: 1e-310, damping: 0.0 }),
        &format!("joints[0].softness.stiffness is 1e-310: {UNITS}"),
    );
    check(
        |d| {
            let force = [1e99, 0.0];
            d.forces = vec![ForceDef { body: "box".into(), force, ..ForceDef::default() }];
        },
        &format!("forces[0].force[0] is 1e99: {UNITS}"),
    );
}

/// A scene with everything at `size`: lengths, masses, springs.
fn at(size: f64) -> SceneDef {
    let radius = 0.1 * size;
    let bodies = vec![
        floor(),
        BodyDef { mass: Some(size), ..block("box", [size, size], [0.0, 0.5 * size]) },
        BodyDef { mass: Some(size), ..disc("ball", radius, [3.0 * size, size]) },
        BodyDef { mass: Some(size), ..disc("twin", radius, [3.0 * size, 3.0 * size]) },
    ];
    let mut spring = hinge("spring", "ball", "twin", [0.0; 2]);
    let (anchor_a, anchor_b) = ([3.0 * size, size], [3.0 * size, 3.0 * size]);
    let (length, stiffness, damping) = (None, size, size);
    spring.kind = JointKind::Spring { anchor_a, anchor_b, length, stiffness, damping };
    let joints = vec![hinge("pin", WORLD, "ball", [3.0 * size, 2.0 * size]), spring];
    SceneDef { bodies, joints, ..SceneDef::default() }
}

/// What is accepted has finite states, or its steps are refused.
#[test]
fn at_both_ends_of_the_range() {
    for size in [1e-49, 1e-30, 1e-9, 1.0, 1e9, 1e30, 1e49] {
        for (dt, gravity) in [(1e-50, 1e50), (0.01, 9.81), (1e50, 1e50)] {
            let scene = built(&SceneDef { dt, gravity: [0.0, -gravity], ..at(size) });
            for solver in backends() {
                let Ok(run) = simulate(&scene, &*solver, 3) else { continue };
                let finite = |x: &f64| x.is_finite();
                for state in run.states() {
                    let numbers = state.q.iter().chain(&state.v).flatten();
                    assert!(numbers.into_iter().all(finite), "{size} {dt}: {state:?}");
                }
            }
        }
    }
}

/// Ordinary motion does not depend on the unit of length.
#[test]
fn of_other_units() {
    let fall = |unit: f64| {
        let scene = built(&SceneDef { gravity: [0.0, -9.81 * unit], ..at(unit) });
        let solver = &backends()[0];
        let run = simulate(&scene, &**solver, 20).expect("a run in other units");
        run.last().q[1].y / unit
    };
    let metres = fall(1.0);
    for unit in [1e-20, 1e-6, 1e6, 1e20] {
        assert!((fall(unit) - metres).abs() < 1e-9, "{unit}");
    }
}

#[test]
fn of_lists() {
    let mut many = good();
    many.bodies = (0..3000).map(|i| disc(&i.to_string(), 0.1, [f64::from(i), 0.0])).collect();
    many.joints = vec![hinge("pin", WORLD, "ball", [0.0; 2])];
    assert_eq!(
        Scene::new(&many).expect_err("no such body").to_string(),
        "joints[0].bodies[1] names \"ball\", which is not a body; known: 0, 1, 2, 3, 4, 5, 6, 7, 8, \
         9, 10, 11, and 2988 more"
    );
    let mut scene = built(&good());
    assert!(scene.set(Param::Mass(usize::MAX), 1.0).is_err());
    let empty = built(&SceneDef::default());
    for solver in backends() {
        assert_eq!(simulate(&empty, &*solver, 2).expect("nothing moves").records.len(), 2);
    }
}
