//! Forces in time and controls: their impulses are exact.

use tangency::{
    BodyDef, ControlDef, ControlInput, ForceDef, LcpSolver, Scene, SceneDef, State, rollout,
};
use tangency_bench::scenes::{disc, floor, hinge, material, motor_arm, rod, unit_scene};

use crate::engine::{backends, built, near, run};

fn floating(force: &ForceDef) -> Scene {
    let body = BodyDef { mass: Some(2.0), inertia: Some(0.5), ..disc("body", 0.1, [0.0; 2]) };
    let force = ForceDef { body: "body".into(), ..force.clone() };
    built(&SceneDef { forces: vec![force], ..unit_scene("pushed", vec![body]) })
}

/// 0.5 s at dt = 0.01 under a force of (3, −1) N and 0.2 N·m: how long it acted.
#[track_caller]
fn check_window(start: Option<f64>, end: Option<f64>, acted: f64) {
    let force = ForceDef { force: [3.0, -1.0], torque: 0.2, start, end, ..ForceDef::default() };
    let scene = floating(&force);
    for solver in backends() {
        let v = run(&scene, &*solver, 50).last().v[0];
        near("force in a window, x", v.x, 3.0 * acted / 2.0, 1e-12);
        near("force in a window, y", v.y, -acted / 2.0, 1e-12);
        near("force in a window, turn", v.z, 0.2 * acted / 0.5, 1e-12);
    }
}

#[test]
fn windows() {
    check_window(None, None, 0.5);
    check_window(None, Some(0.1), 0.1);
    check_window(Some(0.2), None, 0.3);
    check_window(Some(0.013), Some(0.147), 0.134);
    check_window(Some(0.0711), Some(0.0743), 0.0032); // within one step
    check_window(Some(0.6), Some(0.9), 0.0);
}

fn controlled(
    scene: &Scene,
    solver: &dyn LcpSolver,
    steps: usize,
    control: impl Fn(usize) -> Vec<f64>,
) -> State {
    rollout(scene, solver, scene.initial_state(), steps, |k, _| control(k))
        .expect("a run")
        .last()
        .clone()
}

#[test]
fn wrench_controls() {
    let body = BodyDef { mass: Some(2.0), inertia: Some(0.5), ..disc("body", 0.1, [0.0; 2]) };
    let channel = |name: &str, input| ControlDef { name: name.into(), input };
    let controls = vec![
        channel("turn", ControlInput::Torque { body: "body".into() }),
        channel("right", ControlInput::ForceX { body: "body".into() }),
        channel("up", ControlInput::ForceY { body: "body".into() }),
    ];
    let scene = built(&SceneDef { controls, ..unit_scene("controlled", vec![body]) });
    for solver in backends() {
        let v = controlled(&scene, &*solver, 10, |k| vec![k as f64, 1.0, -0.5]).v[0];
        near("torque control", v.z, 45.0 * 0.01 / 0.5, 1e-12);
        near("force control, x", v.x, 0.1 / 2.0, 1e-12);
        near("force control, y", v.y, -0.05 / 2.0, 1e-12);
    }
}

#[test]
fn motor_speed_control_adds_to_the_target() {
    for solver in backends() {
        let mut def = motor_arm();
        def.joints.truncate(1);
        def.bodies.truncate(1);
        def.controls.truncate(1);
        let scene = built(&def);
        for (k, extra) in [0.0, 1.0, -4.0].into_iter().enumerate() {
            let v = controlled(&scene, &*solver, k + 1, |_| vec![extra]).v[0];
            near("motor speed control", v.z, 1.5 + extra, 1e-10);
        }
    }
}

#[test]
fn joint_force_control_acts_on_both_bodies() {
    let bodies = vec![rod("a", 1.0, 1.0, [-0.5, 0.0], 0.0), rod("b", 1.0, 2.0, [0.5, 0.0], 0.0)];
    let input = ControlInput::JointForce { joint: "pin".into() };
    let def = SceneDef {
        joints: vec![hinge("pin", "a", "b", [0.0; 2])],
        controls: vec![ControlDef { name: "twist".into(), input }],
        ..unit_scene("two rods", bodies)
    };
    let scene = built(&def);
    for solver in backends() {
        let end = controlled(&scene, &*solver, 1, |_| vec![0.3]);
        let momentum = scene.total_momentum(&end);
        near("an inner torque keeps momentum", momentum.amax(), 0.0, 1e-15);
        assert!(end.v[1].z > 0.0 && end.v[0].z < 0.0, "b turns against a");
        // The pin's reaction is along y: v_b − v_a = (ω_a + ω_b) h, reduced mass m_a m_b/(m_a + m_b).
        let (ia, ib, h, reduced) = (1.0 / 12.0, 2.0 / 12.0, 0.5, 2.0 / 3.0);
        let (a11, a22, a12) = (ia + reduced * h * h, ib + reduced * h * h, reduced * h * h);
        let det = a11 * a22 - a12 * a12;
        let torque = 0.3 * 0.01;
        near("joint force, b", end.v[1].z, torque * (a11 + a12) / det, 1e-12);
        near("joint force, a", end.v[0].z, -torque * (a22 + a12) / det, 1e-12);
    }
}

/// V15 (a): spool of inertia 0.03 pulled by 2 N at an angle, with the string's moment.
#[test]
fn v15_a_spool() {
    let check = |degrees: f64, exact: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let spool =
            BodyDef { mass: Some(1.0), inertia: Some(0.03), ..disc("spool", 0.3, [0.0, 0.3]) };
        let pull = ForceDef {
            body: "spool".into(),
            force: [2.0 * cos, 2.0 * sin],
            torque: 0.2,
            ..ForceDef::default()
        };
        let def =
            SceneDef { bodies: vec![floor(), spool], forces: vec![pull], ..SceneDef::default() };
        for solver in backends() {
            let tape = run(&built(&material(def.clone(), 0.5, 0.0)), &*solver, 100);
            near("V15 (a) acceleration", tape.last().v[1].x, exact, 1e-10);
            near("V15 (a) x(1), C=1", tape.last().q[1].x, exact / 2.0, 0.01);
        }
    };
    check(0.0, 1.0);
    check(40.0, 0.649_066_664_678_467_06);
    check(90.0, -0.5);
    check(70.528_779_365_509_309, 0.0);
}
