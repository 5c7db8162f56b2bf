//! V22 Redundant contacts and joints.

use tangency::{LcpSolver, Param, Rollout, Scene};
use tangency_bench::scenes::{doubled_hinge, redundant_floor};

use crate::engine::{backends, built, contact_sums, held_impulse, near, run, steps, with_dt};
use crate::slope::{pick, slope};

const BOX: usize = 1;

fn slide(solver: &dyn LcpSolver, k: usize, dt: f64) -> (Scene, Rollout) {
    let scene = built(&with_dt(redundant_floor(k), dt));
    let tape = run(&scene, solver, steps(1.1, dt));
    (scene, tape)
}

#[test]
fn v22_a_motion() {
    for solver in backends() {
        let (_, plain) = slide(&*solver, 2, 0.01);
        for k in [2, 3, 10, 100] {
            let (scene, tape) = slide(&*solver, k, 0.01);
            assert_eq!(tape.records[0].contacts.len(), k, "contact points");
            for record in &tape.records {
                near("V22 (a) normal sum", contact_sums(record).0, 9.81 * scene.dt(), 1e-9);
            }
            let end = tape.last().q[BOX];
            near("V22 (a) stop, exact sum", end.x, 1.514_060_7, 1e-9);
            near("V22 (a) same for all k", (end - plain.last().q[BOX]).norm(), 0.0, 1e-9);
            near("V22 (a) no turn", end.z, 0.0, 1e-9);
            near("V22 (a) stands", tape.last().v[BOX].norm(), 0.0, 1e-9);
        }
        let (_, fine) = slide(&*solver, 3, 1e-3);
        near("V22 (a) stop", fine.last().q[BOX].x, 1.529_051_987_767_584_1, 2e-3);
    }
}

#[test]
fn v22_a_derivatives() {
    for solver in backends() {
        for k in [2, 3, 10, 100] {
            let (scene, tape) = slide(&*solver, k, 0.01);
            let seed = pick(&scene, |s| s.q[BOX].x = 1.0);
            let friction = [(Param::Friction(0), 1.0), (Param::Friction(BOX), 1.0)];
            let check = |what: &str, direction: &[(Param, f64)], exact: f64| {
                near(what, slope(&scene, &tape, &seed, direction), exact, 1e-8);
            };
            check("V22 (a) dx/dmu", &friction, -5.053_131);
            check("V22 (a) dx/dv0", &[(Param::Velocity(BOX, 0), 1.0)], 1.01);
            check(
                "V22 (a) dx/dm",
                &[(Param::Mass(BOX), 1.0), (Param::Inertia(BOX), 1.0 / 6.0)],
                0.0,
            );
        }
    }
}

#[test]
fn v22_b_hinge_entered_again() {
    for solver in backends() {
        let swing = |k| run(&built(&with_dt(doubled_hinge(2.5, k), 1e-3)), &*solver, 2000);
        let single = swing(1);
        for k in [2_u32, 5] {
            let again = swing(k as usize);
            for (one, many) in single.records.iter().zip(&again.records) {
                let off = (one.after.q[0] - many.after.q[0]).norm();
                assert!(off <= 1e-9, "V22 (b) same motion: off by {off:e}");
                for row in 0..2 {
                    let sum: f64 = (0..k).map(|j| held_impulse(many, j, row)).sum();
                    let off = (sum - held_impulse(one, 0, row)).abs();
                    assert!(off <= 1e-9, "V22 (b) multipliers' sum: off by {off:e}");
                }
            }
            let off = (single.last().q[0] - again.last().q[0]).norm();
            near("V22 (b) same motion", off, 0.0, 1e-9);
        }
    }
}
