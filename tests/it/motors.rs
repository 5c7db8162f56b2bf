//! Motors and kinematic bodies.

use tangency::{
    BodyDef, BodyKind, JointDef, JointKind, Limits, Motor, Path, SceneDef, WORLD, inspect,
};
use tangency_bench::scenes::{block, disc, unit_scene};

use crate::engine::{backends, built, near, run};

/// A wheel of inertia 0.5 on an axle with a motor.
fn wheel(motor: Motor) -> SceneDef {
    let body = BodyDef { mass: Some(2.0), inertia: Some(0.5), ..disc("wheel", 0.3, [0.0; 2]) };
    let (limits, motor) = (Limits::default(), Some(motor));
    let kind = JointKind::Revolute { anchor: [0.0; 2], anchor_b: None, limits, motor };
    let bodies = [WORLD.into(), "wheel".into()];
    let axle = JointDef { name: "axle".into(), bodies, kind, collide: false, softness: None };
    SceneDef { joints: vec![axle], ..unit_scene("wheel", vec![body]) }
}

#[test]
fn unbounded_motor_reaches_its_speed_at_once() {
    for solver in backends() {
        let scene = built(&wheel(Motor { speed: 4.0, max: None }));
        let tape = run(&scene, &*solver, 3);
        near("motor speed", tape.state(1).v[0].z, 4.0, 1e-12);
        assert_eq!(tape.records[0].islands[0].path, Path::Linear);
    }
}

/// ω = τ t / I until the target is reached.
#[test]
fn weak_motor_saturates() {
    for solver in backends() {
        for sign in [1.0, -1.0] {
            let scene = built(&wheel(Motor { speed: 4.0 * sign, max: Some(1.0) }));
            let tape = run(&scene, &*solver, 250);
            for (k, state) in tape.states().enumerate() {
                let exact = (k as f64 * 0.01 / 0.5).min(4.0) * sign;
                assert!((state.v[0].z - exact).abs() <= 1e-10, "{} at {k}", state.v[0].z);
            }
            near("weak motor, ω(1)", tape.state(100).v[0].z, 2.0 * sign, 1e-10);
            near("weak motor, ω(2.5)", tape.last().v[0].z, 4.0 * sign, 1e-10);
        }
    }
}

#[test]
fn motor_brakes_against_its_limit() {
    let mut def = wheel(Motor { speed: 4.0, max: Some(1.0) });
    if let JointKind::Revolute { limits, .. } = &mut def.joints[0].kind {
        limits.upper = Some(0.25);
    }
    for solver in backends() {
        let tape = run(&built(&def), &*solver, 200);
        let beyond = tape.states().map(|s| s.q[0].z - 0.25).fold(0.0, f64::max);
        near("motor at a limit, overshoot", beyond, 0.0, 1e-9);
        near("motor at a limit, rest", tape.last().q[0].z, 0.25, 1e-9);
    }
}

#[test]
fn prismatic_motor_lifts_a_weight() {
    let weight = BodyDef { mass: Some(2.0), ..block("cage", [0.5, 0.5], [0.0; 2]) };
    let lift = |max| {
        let motor = Some(Motor { speed: 0.5, max: Some(max) });
        let (anchor, axis, limits) = ([0.0; 2], [0.0, 1.0], Limits::default());
        let kind = JointKind::Prismatic { anchor, axis, limits, motor };
        let bodies = [WORLD.into(), "cage".into()];
        let rail = JointDef { name: "rail".into(), bodies, kind, collide: false, softness: None };
        let bodies = vec![weight.clone()];
        built(&SceneDef { bodies, joints: vec![rail], ..SceneDef::default() })
    };
    for solver in backends() {
        let strong = run(&lift(100.0), &*solver, 100).last().v[0];
        near("strong lift", strong.y, 0.5, 1e-10);
        let weak = run(&lift(10.0), &*solver, 100).last().v[0];
        near("weak lift falls", weak.y, 10.0 / 2.0 - 9.81, 1e-10);
    }
}

#[test]
fn kinematic_bodies_keep_their_velocity() {
    let pusher = BodyDef {
        kind: BodyKind::Kinematic,
        velocity: [0.5, 0.0],
        angular_velocity: 0.0,
        ..block("pusher", [0.2, 1.0], [-0.6, 0.0])
    };
    let pushed = BodyDef { mass: Some(1e3), ..block("crate", [0.8, 0.4], [0.0; 2]) };
    let scene = built(&unit_scene("pusher", vec![pusher, pushed]));
    assert_eq!(inspect(&scene, &scene.initial_state()).expect("a state").dynamic_bodies, 1);
    for solver in backends() {
        let tape = run(&scene, &*solver, 100);
        assert_eq!(tape.last().v[0].x, 0.5);
        near("pusher", tape.last().q[0].x, -0.1, 1e-12);
        near("pushed along, v", tape.last().v[1].x, 0.5, 1e-10);
        near("pushed along, gap", tape.last().q[1].x - tape.last().q[0].x, 0.5, 1e-9);
    }
}
