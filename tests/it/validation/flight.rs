//! V01 Free flight with spin.

use nalgebra::Vector3;
use tangency::lcp::{Guess, Lcp, LcpError, LcpSolution, LcpSolver, Scratch};
use tangency::{Param, Scene};
use tangency_bench::scenes::free_flight;

use crate::engine::{built, near, run, steps, with_dt};
use crate::slope::{pick, slope};

/// A backend that may not be asked.
struct Forbidden;

impl LcpSolver for Forbidden {
    fn name(&self) -> &'static str {
        "forbidden"
    }

    fn solve(&self, _: &Lcp, _: Option<&Guess>, _: &mut Scratch) -> Result<LcpSolution, LcpError> {
        panic!("no solver may run in free flight")
    }
}

const T: f64 = 1.5;

fn flight() -> Scene {
    built(&with_dt(free_flight(), 1e-3))
}

#[test]
fn v01_motion() {
    let scene = flight();
    let end = run(&scene, &Forbidden, steps(T, 1e-3));
    let (q, v) = (end.last().q[0], end.last().v[0]);
    near("V01 x", q.x, 4.5, 1e-12);
    near("V01 y", q.y, -4.036_25 - 7.357_5e-3, 1e-12);
    near("V01 angle", q.z, -10.3, 1e-12);
    near("V01 vy", v.y, -10.715, 1e-12);
    assert_eq!((v.x, v.z), (3.0, -7.0));
}

#[test]
fn v01_derivatives() {
    let scene = flight();
    let tape = run(&scene, &Forbidden, steps(T, 1e-3));
    let by = |axis: usize, param| {
        let seed = pick(&scene, |s| s.q[0][axis] = 1.0);
        slope(&scene, &tape, &seed, &[(param, 1.0)])
    };
    near("V01 dx/dvx", by(0, Param::Velocity(0, 0)), 1.5, 1e-12);
    near("V01 dy/dvy", by(1, Param::Velocity(0, 1)), 1.5, 1e-12);
    near("V01 dy/dg", -by(1, Param::Gravity(1)), -1.125 - 7.5e-4, 1e-12);
    for seed in [Vector3::x(), Vector3::y(), Vector3::z()] {
        let seed = pick(&scene, |s| (s.q[0], s.v[0]) = (seed, seed));
        near("V01 d/dm", slope(&scene, &tape, &seed, &[(Param::Mass(0), 1.0)]), 0.0, 1e-12);
    }
}
