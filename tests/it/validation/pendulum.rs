//! V02 Large pendulum.

use tangency::{LcpSolver, Param, Rollout, Scene};
use tangency_bench::scenes::{pendulum, slender_inertia};

use crate::engine::{backends, built, held_impulse, near, order, run, steps, with_dt};
use crate::slope::{pick, slope};

const START: f64 = 2.5;
const ANGLE_AT_2: f64 = -0.133_402_730_266_384_21;

/// Angle from hanging: the rod's own angle is zero along +x.
fn angle(tape: &Rollout, step: usize) -> f64 {
    tape.state(step).q[0].z + std::f64::consts::FRAC_PI_2
}

fn swing(solver: &dyn LcpSolver, dt: f64, duration: f64) -> (Scene, Rollout) {
    let scene = built(&with_dt(pendulum(START), dt));
    let tape = run(&scene, solver, steps(duration, dt));
    (scene, tape)
}

#[test]
fn v02_motion() {
    for solver in backends() {
        for dt in [4e-3, 1e-3] {
            let (_, tape) = swing(&*solver, dt, 2.0);
            near("V02 angle(2), C=5", angle(&tape, steps(2.0, dt)), ANGLE_AT_2, 5.0 * dt);
        }
        order("V02 angle(2)", 0.9, |dt| {
            angle(&swing(&*solver, dt, 2.0).1, steps(2.0, dt)) - ANGLE_AT_2
        });
    }
}

#[test]
fn v02_energy_and_hinge() {
    for solver in backends() {
        for dt in [4e-3, 1e-3] {
            let (scene, tape) = swing(&*solver, dt, 10.0);
            let exact = 3.929_609_434_257_709_9;
            let off = |s| (scene.energy(s) - exact).abs();
            let worst = tape.states().map(off).fold(0.0, f64::max);
            near("V02 energy error over 10 s, 30 dt", worst, 0.0, 30.0 * dt);
            let drift = tape.states().map(|s| scene.joint_drift(s)).fold(0.0, f64::max);
            near("V02 hinge gap, 100 dt²", drift, 0.0, 100.0 * dt * dt);
        }
        let (_, tape) = swing(&*solver, 1e-3, 1.0);
        let force = |r| held_impulse(r, 0, 0).hypot(held_impulse(r, 0, 1)) / 1e-3;
        let greatest = tape.records.iter().map(force).fold(0.0, f64::max);
        near("V02 hinge force at the bottom", greatest, 36.313_828_302_773_13, 0.1);
    }
}

#[test]
fn v02_derivatives() {
    for solver in backends() {
        let (scene, tape) = swing(&*solver, 1e-3, 2.0);
        let seed = pick(&scene, |s| s.q[0].z = 1.0);
        let (sin, cos) = START.sin_cos();
        let start = [
            (Param::Position(0, 0), 0.5 * cos),
            (Param::Position(0, 1), 0.5 * sin),
            (Param::Position(0, 2), 1.0),
        ];
        // A longer rod: its end stays at the pivot and its inertia grows, at the same mass.
        let length = [
            (Param::Position(0, 0), 0.5 * sin),
            (Param::Position(0, 1), -0.5 * cos),
            (Param::AnchorB(0, 0), -0.5),
            (Param::Inertia(0), 2.0 * slender_inertia(1.0, 1.0)),
        ];
        let mass = [(Param::Mass(0), 1.0), (Param::Inertia(0), slender_inertia(1.0, 1.0))];
        let check = |what: &str, direction: &[(Param, f64)], exact: f64| {
            near(what, slope(&scene, &tape, &seed, direction), exact, 2e-2 * exact.abs());
        };
        check("V02 d angle(2)/d start angle", &start, -8.067_354_362_055_703_3);
        check("V02 d angle(2)/dL", &length, -7.262_656_012_358_544_1);
        check("V02 d angle(2)/dg", &[(Param::Gravity(1), -1.0)], 0.740_331_907_477_935_18);
        near("V02 d angle(2)/dm", slope(&scene, &tape, &seed, &mass), 0.0, 1e-9);
    }
}
