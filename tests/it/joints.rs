//! Joints hold what they say and leave free the rest.

use tangency::{BodyDef, ForceDef, JointDef, JointKind, Limits, SceneDef, Shape, WORLD};
use tangency_bench::scenes::{block, hinge, unit_scene};

use crate::engine::{backends, built, near, run, steps, with_dt};

fn joint(a: &str, b: &str, kind: JointKind) -> JointDef {
    JointDef {
        name: "joint".into(),
        bodies: [a.into(), b.into()],
        kind,
        collide: false,
        softness: None,
    }
}

/// A block of 1 kg that a wrench acts on, held by one joint to the world.
fn held(kind: JointKind) -> SceneDef {
    let body = BodyDef { mass: Some(1.0), ..block("body", [0.4, 0.2], [0.5, 0.2]) };
    let push =
        ForceDef { body: "body".into(), force: [3.0, 1.0], torque: 0.4, ..ForceDef::default() };
    SceneDef {
        joints: vec![joint(WORLD, "body", kind)],
        forces: vec![push],
        ..unit_scene("held", vec![body])
    }
}

#[test]
fn locks_hold_exactly() {
    for solver in backends() {
        for bits in 1..8_u8 {
            let [x, y, rotation] = [0, 1, 2].map(|k| bits & (1 << k) != 0);
            let scene = built(&held(JointKind::Lock { x, y, rotation }));
            let tape = run(&scene, &*solver, 100);
            let moved = tape.last().q[0] - tape.initial.q[0];
            let free = [3.0, 1.0, 0.4 / (0.2 / 12.0)].map(|a| a * 0.01 * 0.01 * 5050.0);
            for (axis, locked) in [x, y, rotation].into_iter().enumerate() {
                let exact = if locked { 0.0 } else { free[axis] };
                near("lock", moved[axis], exact, 1e-11);
            }
        }
    }
}

#[test]
fn prismatic_leaves_only_its_axis() {
    let axis = [0.8, 0.6];
    let (limits, motor) = (Limits::default(), None);
    let def = held(JointKind::Prismatic { anchor: [0.5, 0.2], axis, limits, motor });
    for solver in backends() {
        let tape = run(&built(&def), &*solver, 100);
        let (q, v) = (tape.last().q[0] - tape.initial.q[0], tape.last().v[0]);
        near("prismatic, across", q.y * 0.8 - q.x * 0.6, 0.0, 1e-12);
        near("prismatic, turn", q.z, 0.0, 1e-12);
        near("prismatic, along", v.x * 0.8 + v.y * 0.6, 3.0 * 0.8 + 0.6, 1e-12);
    }
}

#[test]
fn slot_leaves_its_axis_and_the_turn() {
    let (limits, motor) = (Limits::default(), None);
    let def = held(JointKind::Slot { anchor: [0.5, 0.2], axis: [1.0, 0.0], limits, motor });
    for solver in backends() {
        let tape = run(&built(&def), &*solver, 100);
        let (q, v) = (tape.last().q[0], tape.last().v[0]);
        near("slot, across", q.y, 0.2, 1e-12);
        near("slot, along", v.x, 3.0, 1e-12);
        near("slot, turn", v.z, 0.4 / (0.2 / 12.0), 1e-10);
    }
}

#[test]
fn distance_is_kept() {
    let mut def =
        held(JointKind::Distance { anchor_a: [0.0; 2], anchor_b: [0.45, 0.2], length: None });
    (def.gravity, def.forces[0].torque) = ([0.0, -9.81], 0.0);
    for solver in backends() {
        for dt in [1e-2, 1e-3] {
            let scene = built(&with_dt(def.clone(), dt));
            let tape = run(&scene, &*solver, 500);
            let drift = tape.states().map(|s| scene.joint_drift(s)).fold(0.0, f64::max);
            near("distance joint, 100 dt²", drift, 0.0, 100.0 * dt * dt);
        }
    }
}

const SPIN: f64 = 3.0;
/// Centre of mass of blocks of 1 kg at the origin and 0.5 kg at (0.5, −0.3).
const CENTER: [f64; 2] = [0.5 / 3.0, -0.1];

/// Two blocks welded to an L, spinning, pushed for the first step.
fn welded_pair(dt: f64) -> SceneDef {
    let part = |name: &str, size, at: [f64; 2], mass| BodyDef {
        mass: Some(mass),
        velocity: [1.0 - SPIN * (at[1] - CENTER[1]), SPIN * (at[0] - CENTER[0])],
        angular_velocity: SPIN,
        ..block(name, size, at)
    };
    let a = part("a", [0.8, 0.2], [0.0; 2], 1.0);
    let b = part("b", [0.2, 0.5], [0.5, -0.3], 0.5);
    let push =
        ForceDef { body: "a".into(), force: [10.0, 20.0], end: Some(dt), ..ForceDef::default() };
    let def = SceneDef {
        joints: vec![joint("a", "b", JointKind::Weld { anchor: [0.4, 0.0] })],
        forces: vec![push],
        ..unit_scene("welded", vec![a, b])
    };
    with_dt(def, dt)
}

#[test]
fn a_weld_makes_one_body() {
    let inertia = |m: f64, size: [f64; 2], at: [f64; 2]| {
        let arm = (at[0] - CENTER[0]).powi(2) + (at[1] - CENTER[1]).powi(2);
        m * ((size[0].powi(2) + size[1].powi(2)) / 12.0 + arm)
    };
    let whole = inertia(1.0, [0.8, 0.2], [0.0; 2]) + inertia(0.5, [0.2, 0.5], [0.5, -0.3]);
    for solver in backends() {
        for dt in [1e-2, 1e-3] {
            let scene = built(&welded_pair(dt));
            let tape = run(&scene, &*solver, steps(1.0, dt));
            // The push on a's centre, as a wrench on the whole.
            let moment = -CENTER[0] * 20.0 + CENTER[1] * 10.0;
            let rate = SPIN + dt * moment / whole;
            let v = [1.0 + dt * 10.0 / 1.5, dt * 20.0 / 1.5];
            for (body, at) in [[0.0, 0.0], [0.5, -0.3]].into_iter().enumerate() {
                let arm = [at[0] - CENTER[0], at[1] - CENTER[1]];
                let first = tape.state(1).v[body];
                near("weld, first step, x", first.x, v[0] - rate * arm[1], 1e-12);
                near("weld, first step, y", first.y, v[1] + rate * arm[0], 1e-12);
                near("weld, first step, turn", first.z, rate, 1e-12);
            }
            let q = &tape.last().q;
            near("weld, relative angle", q[1].z - q[0].z, 0.0, 1e-9);
            near("weld, angle(1), C=5", q[0].z, rate, 5.0 * dt);
            near("weld, centre, x", (q[0].x + 0.5 * q[1].x) / 1.5, CENTER[0] + v[0], 1e-9);
            near("weld, centre, y", (q[0].y + 0.5 * q[1].y) / 1.5, CENTER[1] + v[1], 1e-9);
            let drift = tape.states().map(|s| scene.joint_drift(s)).fold(0.0, f64::max);
            near("weld, drift, 100 dt²", drift, 0.0, 100.0 * dt * dt);
        }
    }
}

#[test]
fn limits_hold() {
    let limits = Limits { lower: Some(-0.3), upper: Some(0.2) };
    let kind = JointKind::Revolute { anchor: [0.3, 0.2], anchor_b: None, limits, motor: None };
    for solver in backends() {
        for torque in [2.0, -2.0] {
            let mut def = held(kind.clone());
            def.forces[0] = ForceDef { body: "body".into(), torque, ..ForceDef::default() };
            let tape = run(&built(&def), &*solver, 200);
            let bound: f64 = if torque > 0.0 { 0.2 } else { -0.3 };
            let beyond = |s: &tangency::State| (s.q[0].z * torque.signum() - bound.abs()).max(0.0);
            near("limit, overshoot", tape.states().map(beyond).fold(0.0, f64::max), 0.0, 1e-9);
            near("limit, rest at it", tape.last().q[0].z, bound, 1e-9);
            near("limit, still", tape.last().v[0].norm(), 0.0, 1e-9);
        }
    }
}

#[test]
fn jointed_bodies_do_not_collide_unless_asked() {
    let pair = |collide| {
        let bodies = vec![
            BodyDef { velocity: [1.0, 0.0], ..block("a", [1.0, 1.0], [0.0; 2]) },
            block("b", [1.0, 1.0], [1.0, 0.0]),
        ];
        let mut pin = hinge("pin", "a", "b", [0.5, 2.0]);
        pin.collide = collide;
        built(&SceneDef { joints: vec![pin], ..unit_scene("neighbours", bodies) })
    };
    for solver in backends() {
        assert!(run(&pair(false), &*solver, 1).records[0].contacts.is_empty());
        assert!(!run(&pair(true), &*solver, 1).records[0].contacts.is_empty());
    }
}

/// A compound has the mass, the centre and the inertia of its parts.
#[test]
fn compound_is_the_sum_of_its_parts() {
    let rectangle = |center| Shape::Rectangle { width: 0.4, height: 0.4, center, angle: 0.0 };
    let parts = BodyDef {
        name: "compound".into(),
        shapes: vec![rectangle([-0.2, 0.0]), rectangle([0.2, 0.0])],
        density: Some(2.0),
        ..BodyDef::default()
    };
    let whole = BodyDef { density: Some(2.0), ..block("whole", [0.8, 0.4], [0.0; 2]) };
    let scene = built(&unit_scene("compound", vec![parts, whole]));
    let [one, two] = [0, 1].map(|i| scene.bodies()[i].mass);
    near("compound mass and inertia", (one - two).amax(), 0.0, 1e-15);
}
