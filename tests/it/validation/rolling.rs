//! V06 Disc on an incline, V07 Sliding to rolling.

use tangency::{LcpSolver, Param, Rollout, Scene};
use tangency_bench::scenes::{incline_disc, sliding_disc};

use crate::engine::{backends, built, near, order, run, steps, with_dt};
use crate::slope::{pick, slope};

const DISC: usize = 1;
const RADIUS: f64 = 0.25;

fn tilt() -> (f64, f64) {
    20.0_f64.to_radians().sin_cos()
}

fn descent(solver: &dyn LcpSolver, friction: f64, dt: f64, duration: f64) -> (Scene, Rollout) {
    let scene = built(&with_dt(incline_disc(friction), dt));
    let tape = run(&scene, solver, steps(duration, dt));
    (scene, tape)
}

/// Distance down the slope.
fn travel(tape: &Rollout) -> f64 {
    let (sin, cos) = tilt();
    let d = tape.last().q[DISC] - tape.initial.q[DISC];
    -(d.x * cos + d.y * sin)
}

/// Speed of the disc's lowest point along the slope.
fn slip(tape: &Rollout) -> f64 {
    let ((sin, cos), v) = (tilt(), tape.last().v[DISC]);
    v.x * cos + v.y * sin + v.z * RADIUS
}

#[test]
fn v06_motion() {
    for solver in backends() {
        for (friction, x, rate) in [
            (0.05, 3.256_085_672_470_487_2, 5.531_030_765_945_8),
            (0.3, 2.516_413_204_518_607_7, 13.420_870_424_099_241),
        ] {
            let (_, tape) = descent(&*solver, friction, 1e-3, 1.5);
            near("V06 x(1.5), C=3", travel(&tape), x, 3e-3);
            near("V06 |w|(1.5)", tape.last().v[DISC].z.abs(), rate, 1e-10);
            // Exact at any time: x(t) = x(1.5) (t/1.5)².
            let at = |dt: f64| steps(1.5, 8e-3) as f64 * 8e-3 / dt;
            order("V06 x", 0.9, |dt| {
                let t = at(dt) * dt;
                travel(&descent(&*solver, friction, dt, t).1) - x * (t / 1.5).powi(2)
            });
        }
        near("V06 rolling contact point", slip(&descent(&*solver, 0.3, 1e-3, 1.5).1), 0.0, 1e-10);
        near("V06 rolling, dt=0.01", slip(&descent(&*solver, 0.3, 1e-2, 1.5).1), 0.0, 1e-10);
        // It rolls iff mu >= 0.12132341142206745.
        near("V06 just rolls", slip(&descent(&*solver, 0.121_324, 1e-3, 1.5).1), 0.0, 1e-10);
        let barely = slip(&descent(&*solver, 0.121_32, 1e-3, 1.5).1);
        assert!(barely < -1e-6, "V06: below the threshold it must slip, not {barely}");
    }
}

#[test]
fn v06_derivatives() {
    for solver in backends() {
        let (sin, cos) = tilt();
        let friction = [(Param::Friction(0), 1.0), (Param::Friction(DISC), 1.0)];
        // A larger disc of the same mass: inertia m R²/2, centre R above the slope.
        let radius = [
            (Param::Radius(DISC, 0), 1.0),
            (Param::Inertia(DISC), RADIUS),
            (Param::Position(DISC, 0), -sin),
            (Param::Position(DISC, 1), cos),
        ];
        for (mu, by_friction) in [(0.05, -10.370_682_686_148_481), (0.3, 0.0)] {
            let (scene, tape) = descent(&*solver, mu, 1e-3, 1.5);
            let seed = pick(&scene, |s| (s.q[DISC].x, s.q[DISC].y) = (-cos, -sin));
            let tolerance = if mu < 0.1 { 2e-2 * 10.37 } else { 1e-10 };
            near("V06 dx/dmu", slope(&scene, &tape, &seed, &friction), by_friction, tolerance);
            near("V06 dx/dR", slope(&scene, &tape, &seed, &radius), 0.0, 1e-9);
        }
    }
}

fn roll(solver: &dyn LcpSolver, dt: f64, duration: f64) -> (Scene, Rollout) {
    let scene = built(&with_dt(sliding_disc(), dt));
    let tape = run(&scene, solver, steps(duration, dt));
    (scene, tape)
}

#[test]
fn v07_motion() {
    for solver in backends() {
        let exact = 5.695_775_285_989_353_2;
        for dt in [2e-2, 1e-2, 1e-3] {
            let (_, tape) = roll(&*solver, dt, 2.0);
            near("V07 v(2), any dt", tape.last().v[DISC].x, 8.0 / 3.0, 1e-10);
            near("V07 x(2), C=1", tape.last().q[DISC].x, exact, dt);
            let rolls = |k: &usize| {
                let v = tape.state(*k).v[DISC];
                (v.x + RADIUS * v.z).abs() <= 1e-9
            };
            let first = (1..=tape.records.len()).find(rolls).expect("it rolls");
            near("V07 rolls from", first as f64 * dt, 0.543_662_928_984_039_9, dt);
        }
        order("V07 x(2)", 0.9, |dt| roll(&*solver, dt, 2.0).1.last().q[DISC].x - exact);
    }
}

#[test]
fn v07_derivatives() {
    for solver in backends() {
        let (scene, tape) = roll(&*solver, 1e-3, 2.0);
        let friction = [(Param::Friction(0), 1.0), (Param::Friction(DISC), 1.0)];
        let speed = [(Param::Velocity(DISC, 0), 1.0)];
        let x = pick(&scene, |s| s.q[DISC].x = 1.0);
        let v = pick(&scene, |s| s.v[DISC].x = 1.0);
        let check = |what: &str, seed, direction, exact: f64, tolerance| {
            near(what, slope(&scene, &tape, seed, direction), exact, tolerance);
        };
        check("V07 dx/dv0", &x, &speed, 1.514_554_309_661_343_3, 2e-2 * 1.514);
        check("V07 dx/dmu", &x, &friction, -1.449_767_810_624_079_7, 2e-2 * 1.449);
        check("V07 dv/dmu", &v, &friction, 0.0, 1e-10);
        check("V07 dv/dv0", &v, &speed, 2.0 / 3.0, 1e-10);
    }
}
