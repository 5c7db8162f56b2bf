//! Motion without events: of order 4, joints closed to rounding.

use std::f64::consts::FRAC_PI_2;

use tangency::{
    BodyDef, ForceDef, JointDef, JointKind, LcpSolver, SceneDef, State, Stepping, WORLD,
};
use tangency_bench::scenes::{
    block, double_pendulum, free_flight, parallelogram, pendulum, slider_crank, unit_scene,
};

use super::accurate;
use crate::engine::{backends, built, near, run, steps};

fn last(def: SceneDef, dt: f64, duration: f64, solver: &dyn LcpSolver) -> State {
    run(&built(&accurate(def, dt)), solver, steps(duration, dt)).last().clone()
}

/// Halving dt divides the error by 2⁴, within a seventh of a power.
#[track_caller]
fn fourth_order(what: &str, error: impl Fn(f64) -> f64) {
    let errors = [8e-3, 4e-3, 2e-3].map(error);
    for pair in errors.windows(2) {
        near(&format!("{what}, order"), (pair[0] / pair[1]).abs().log2(), 4.0, 0.15);
    }
}

/// V02: the pendulum after 2 s, its energy, its hinge.
#[test]
fn a_large_pendulum() {
    const ANGLE: f64 = -0.133_402_730_266_384_21;
    const RATE: f64 = 7.262_656_012_358_544_1;
    for solver in backends() {
        let swing = |dt| last(pendulum(2.5), dt, 2.0, &*solver);
        fourth_order("angle", |dt| swing(dt).q[0].z + FRAC_PI_2 - ANGLE);
        fourth_order("rate", |dt| swing(dt).v[0].z - RATE);
        let scene = built(&accurate(pendulum(2.5), 1e-3));
        let tape = run(&scene, &*solver, 2000);
        near("angle(2)", tape.last().q[0].z + FRAC_PI_2, ANGLE, 1e-10);
        near("rate(2)", tape.last().v[0].z, RATE, 1e-10);
        near("energy", scene.energy(tape.last()), scene.energy(&tape.initial), 1e-9);
        let drift = tape.states().map(|state| scene.joint_drift(state)).fold(0.0, f64::max);
        near("hinge", drift, 0.0, 1e-14);
        let counts = tape.records[1].counts(&scene);
        assert_eq!((counts.linear_islands, counts.lcp_islands), (1, 0));
    }
}

/// V03 after 2 s, started from (0.5, 0.3).
#[test]
fn a_double_pendulum() {
    const AFTER: [f64; 4] = [
        0.217_337_047_845_467_2,
        0.329_510_924_385_965_3,
        0.113_148_670_439_624_4,
        2.736_441_413_154_619,
    ];
    for solver in backends() {
        let s = last(double_pendulum([0.5, 0.3]), 1e-3, 2.0, &*solver);
        let found = [s.q[0].z + FRAC_PI_2, s.q[1].z + FRAC_PI_2, s.v[0].z, s.v[1].z];
        for (found, exact) in found.into_iter().zip(AFTER) {
            near("double pendulum", found, exact, 1e-9);
        }
    }
}

/// V12: more hinges than are needed, unique motion.
#[test]
fn a_parallelogram() {
    for solver in backends() {
        for (n, exact) in [(2, -1.198_471_068_689_249_5), (3, -1.188_816_387_291_319_7)] {
            let s = last(parallelogram(n, 1.2), 4e-3, 3.0, &*solver);
            let cranks: Vec<f64> = s.q[..n].iter().map(|q| q.z + FRAC_PI_2).collect();
            near("crank", cranks[0], exact, 1e-8);
            near("cranks apart", cranks[1], cranks[0], 1e-12);
        }
    }
}

/// V13 (a) after 1 s.
#[test]
fn a_slider_crank() {
    for solver in backends() {
        let s = last(slider_crank(0.5, 10.0), 1e-3, 1.0, &*solver);
        near("angle", s.q[0].z, 10.051_575_636_715_08, 1e-7);
        near("rate", s.v[0].z, 13.789_201_607_996_32, 1e-6);
    }
}

/// V01: exact, and nothing is solved.
#[test]
fn free_flight_is_exact() {
    for solver in backends() {
        let scene = built(&accurate(free_flight(), 0.25));
        let tape = run(&scene, &*solver, 6);
        near("x", tape.last().q[0].x, 4.5, 1e-13);
        near("y", tape.last().q[0].y, -4.036_25, 1e-13);
        near("angle", tape.last().q[0].z, -10.3, 1e-13);
        let counts = tape.records[0].counts(&scene);
        assert_eq!((counts.free_bodies, counts.rows, counts.factorisations), (1, 0, 0));
    }
}

/// A mass on a spring with a damper is the closed form's, to order 4.
#[test]
fn a_damped_spring() {
    let (m, k, d) = (2.0, 50.0, 3.0);
    let mass = BodyDef { mass: Some(m), ..block("mass", [0.1, 0.1], [1.3, 0.0]) };
    let kind = JointKind::Spring {
        anchor_a: [0.0; 2],
        anchor_b: [1.3, 0.0],
        length: Some(1.0),
        stiffness: k,
        damping: d,
    };
    let bodies = [WORLD.into(), "mass".into()];
    let spring = JointDef { name: "spring".into(), bodies, kind, collide: false, softness: None };
    let def = SceneDef { joints: vec![spring], ..unit_scene("oscillator", vec![mass]) };
    let (decay, turn) = (d / (2.0 * m), (k / m - (d / (2.0 * m)).powi(2)).sqrt());
    let exact = |t: f64| {
        let (sin, cos) = (turn * t).sin_cos();
        0.3 * (-decay * t).exp() * (cos + decay / turn * sin)
    };
    for solver in backends() {
        let x = |dt| last(def.clone(), dt, 0.96, &*solver).q[0].x - 1.0;
        fourth_order("spring", |dt| x(dt) - exact(0.96));
        near("spring", x(1e-3), exact(0.96), 1e-10);
    }
}

/// A force that begins and ends within steps acts for exactly as long as it should.
#[test]
fn forces_begin_and_end_at_their_time() {
    let (start, end, force) = (0.123, 0.456, 3.0);
    let body = BodyDef { mass: Some(2.0), ..block("body", [0.1, 0.1], [0.0; 2]) };
    let push = ForceDef {
        body: "body".into(),
        force: [force, 0.0],
        start: Some(start),
        end: Some(end),
        ..ForceDef::default()
    };
    let def = SceneDef { forces: vec![push], ..unit_scene("push", vec![body]) };
    for solver in backends() {
        let s = last(def.clone(), 0.1, 1.0, &*solver);
        let v = force / 2.0 * (end - start);
        near("speed", s.v[0].x, v, 1e-14);
        near("place", s.q[0].x, v * (1.0 - 0.5 * (start + end)), 1e-14);
    }
}

/// What is told in a scene file.
#[test]
fn a_scene_file_may_ask_for_it() {
    let told: Stepping = serde_json::from_str(r#"{ "accurate": {} }"#).expect("a stepping");
    assert_eq!(told, Stepping::Accurate { max_events: 32 });
}
