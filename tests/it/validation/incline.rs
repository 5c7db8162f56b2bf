//! V05 Block on an incline.

use tangency::{LcpSolver, Param, Rollout, Scene};
use tangency_bench::scenes::incline_block;

use crate::engine::{backends, built, contact_sums, near, order, run, steps, with_dt};
use crate::slope::{pick, slope};

const BLOCK: usize = 1;

fn slide(
    solver: &dyn LcpSolver,
    friction: f64,
    speed: f64,
    dt: f64,
    duration: f64,
) -> (Scene, Rollout) {
    let scene = built(&with_dt(incline_block(slope_angle(), friction, speed), dt));
    let tape = run(&scene, solver, steps(duration, dt));
    (scene, tape)
}

fn slope_angle() -> f64 {
    30.0_f64.to_radians()
}

/// Distance travelled up the slope.
fn travel(tape: &Rollout) -> f64 {
    let (sin, cos) = slope_angle().sin_cos();
    let d = tape.last().q[BLOCK] - tape.initial.q[BLOCK];
    d.x * cos + d.y * sin
}

#[test]
fn v05_slides_from_rest() {
    for solver in backends() {
        let exact = 0.328_572_697_218_664_22;
        let down = |dt| -travel(&slide(&*solver, 0.5, 0.0, dt, 1.0).1);
        near("V05 (a) s(1), C=0.5", down(1e-3), exact, 0.5e-3);
        near("V05 (a) s(1), C=0.5, dt=0.01", down(1e-2), exact, 0.5e-2);
        order("V05 (a) s(1)", 0.9, |dt| down(dt) - exact);
    }
}

#[test]
fn v05_stops_and_stays() {
    for solver in backends() {
        let (stop, at) = (0.414_670_242_627_784_71, 0.276_446_828_418_523_14);
        for dt in [1e-2, 1e-3] {
            let (_, tape) = slide(&*solver, 0.7, 3.0, dt, 0.5);
            near("V05 (b) stop, C=2", travel(&tape), stop, 2.0 * dt);
            let stands = |k: &usize| tape.state(*k).v[BLOCK].norm() <= 1e-9;
            let first = (0..=tape.records.len()).find(stands).expect("it stops");
            near("V05 (b) time, C=2", first as f64 * dt, at, 2.0 * dt);
        }
        order("V05 (b) stop", 0.9, |dt| travel(&slide(&*solver, 0.7, 3.0, dt, 0.5).1) - stop);
        let (_, tape) = slide(&*solver, 0.7, 3.0, 1e-2, 100.5);
        let creep = (tape.last().q[BLOCK] - tape.state(50).q[BLOCK]).norm();
        near("V05 (b) creep over 100 s", creep, 0.0, 1e-9);
        let (normal, friction) = contact_sums(tape.records.last().expect("steps"));
        near("V05 (b) friction at rest", friction.abs() / 1e-2, 9.81 / 2.0, 1e-9);
        near("V05 (b) normal force", normal / 1e-2, 9.81 * slope_angle().cos(), 1e-9);
    }
}

#[test]
fn v05_derivatives() {
    for solver in backends() {
        check(
            &*solver,
            "V05 (a)",
            (0.5, 0.0, 1.0),
            -1.0,
            &[
                ("mu", &by_friction(), -4.247_854_605_562_671_6),
                ("angle", &by_angle(0.0), 5.474_104_605_562_671_6),
                ("g", &[(Param::Gravity(1), -1.0)], 0.033_493_649_053_890_338),
            ],
        );
        check(
            &*solver,
            "V05 (b)",
            (0.7, 3.0, 0.5),
            1.0,
            &[
                ("v0", &by_speed(), 0.276_446_828_418_523_14),
                ("mu", &by_friction(), -0.324_633_150_851_300_21),
                ("angle", &by_angle(3.0), -0.193_434_224_928_988_01),
            ],
        );
    }
}

type Entry<'a> = (&'a str, &'a [(Param, f64)], f64);

/// d(sign · travel) of a run (friction, speed, duration).
#[track_caller]
fn check(
    solver: &dyn LcpSolver,
    case: &str,
    (friction, speed, duration): (f64, f64, f64),
    sign: f64,
    table: &[Entry<'_>],
) {
    let (scene, tape) = slide(solver, friction, speed, 1e-3, duration);
    let (sin, cos) = slope_angle().sin_cos();
    let seed = pick(&scene, |s| (s.q[BLOCK].x, s.q[BLOCK].y) = (sign * cos, sign * sin));
    for (what, direction, exact) in table {
        let mut found = slope(&scene, &tape, &seed, direction);
        if *what == "angle" {
            // The slope that the travel is measured along turns too, and so does the start.
            let d = tape.last().q[BLOCK] - tape.initial.q[BLOCK];
            let start = tape.initial.q[BLOCK];
            let moved = sign * (cos * -start.y + sin * start.x);
            found += sign * (-d.x * sin + d.y * cos) - moved;
        }
        near(&format!("{case} ds/d{what}"), found, *exact, 2e-2 * exact.abs());
    }
}

/// Both bodies have the pair's coefficient: √(μμ) = μ changes at rate one.
fn by_friction() -> [(Param, f64); 2] {
    [(Param::Friction(0), 1.0), (Param::Friction(BLOCK), 1.0)]
}

fn by_speed() -> [(Param, f64); 2] {
    let (sin, cos) = slope_angle().sin_cos();
    [(Param::Velocity(BLOCK, 0), cos), (Param::Velocity(BLOCK, 1), sin)]
}

/// The slope turns about the origin, with the block and its velocity.
fn by_angle(speed: f64) -> [(Param, f64); 6] {
    let (sin, cos) = slope_angle().sin_cos();
    [
        (Param::Position(0, 2), 1.0),
        (Param::Position(BLOCK, 0), -0.1 * cos),
        (Param::Position(BLOCK, 1), -0.1 * sin),
        (Param::Position(BLOCK, 2), 1.0),
        (Param::Velocity(BLOCK, 0), -speed * sin),
        (Param::Velocity(BLOCK, 1), speed * cos),
    ]
}
