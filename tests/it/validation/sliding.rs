//! V35 Friction and sticking, V15 (b) Conveyor, V24 the switch between stick and slip.

use tangency::{ForceDef, LcpSolver, Param, Rollout, Scene, SceneDef};
use tangency_bench::scenes::{block, conveyor, floor, material, sliding_box};

use crate::engine::{backends, built, near, order, run, steps, with_dt};
use crate::slope::{last_gradient, pick, slope};

const BLOCK: usize = 1;

fn friction() -> [(Param, f64); 2] {
    [(Param::Friction(0), 1.0), (Param::Friction(BLOCK), 1.0)]
}

fn slide(solver: &dyn LcpSolver, dt: f64) -> (Scene, Rollout) {
    let scene = built(&with_dt(sliding_box(1.5, 0.3, 3.0), dt));
    let tape = run(&scene, solver, steps(1.2, dt));
    (scene, tape)
}

/// The sums that semi-implicit steps of 0.01 s make, exactly: a wrong adjoint shows at once.
#[test]
fn v35_a_exact_sums() {
    for solver in backends() {
        let (scene, tape) = slide(&*solver, 0.01);
        let seed = pick(&scene, |s| s.q[BLOCK].x = 1.0);
        near("V35 (a) stop at dt=0.01", tape.last().q[BLOCK].x, 1.514_060_7, 1e-10);
        let check = |what: &str, direction: &[(Param, f64)], exact: f64| {
            near(what, slope(&scene, &tape, &seed, direction), exact, 1e-10);
        };
        check("V35 (a) dx/dmu at dt=0.01", &friction(), -5.053_131);
        check("V35 (a) dx/dv0 at dt=0.01", &[(Param::Velocity(BLOCK, 0), 1.0)], 1.01);
        check("V35 (a) dx/dm", &[(Param::Mass(BLOCK), 1.0)], 0.0);
    }
}

#[test]
fn v35_a_converges() {
    for solver in backends() {
        let derivative = |dt, direction: &[(Param, f64)]| {
            let (scene, tape) = slide(&*solver, dt);
            slope(&scene, &tape, &pick(&scene, |s| s.q[BLOCK].x = 1.0), direction)
        };
        let speed = [(Param::Velocity(BLOCK, 0), 1.0)];
        let (by_speed, by_friction) = (1.019_367_991_845_056_1, -5.096_839_959_225_280_3);
        near("V35 (a) dx/dv0", derivative(1e-3, &speed), by_speed, 2e-2 * by_speed);
        near("V35 (a) dx/dmu", derivative(1e-3, &friction()), by_friction, 2e-2 * 5.09);
        let stop = 1.529_051_987_767_584_1;
        order("V35 (a) stop", 0.9, |dt| slide(&*solver, dt).1.last().q[BLOCK].x - stop);
        // The stop falls between two steps: the exact sum −g dt² K(K+1)/2 is off by a saw-tooth,
        // g T dt (θ − 1/2) with θ the part of a step that is left over.
        order("V35 (a) dx/dmu", 0.7, |dt| derivative(dt, &friction()) - by_friction);
    }
}

fn pushed(force: f64, dt: f64) -> SceneDef {
    let mut def = with_dt(sliding_box(1.5, 0.5, 0.0), dt);
    def.forces =
        vec![ForceDef { body: "block".into(), force: [force, 0.0], ..ForceDef::default() }];
    def
}

#[test]
fn v35_b_sticks() {
    for solver in backends() {
        let scene = built(&pushed(4.0, 1e-2));
        let tape = run(&scene, &*solver, 80);
        near("V35 (b) 4 N", tape.last().q[BLOCK].x, 0.0, 1e-12);
        let seed = pick(&scene, |s| s.q[BLOCK].x = 1.0);
        for direction in [
            vec![(Param::Force(0, 0), 1.0)],
            friction().to_vec(),
            vec![(Param::Mass(BLOCK), 1.0)],
            vec![(Param::Gravity(1), 1.0)],
            vec![(Param::Velocity(BLOCK, 0), 1.0)],
        ] {
            let found = slope(&scene, &tape, &seed, &direction);
            near(&format!("V35 (b) 4 N, d/d{:?}", direction[0].0), found, 0.0, 1e-12);
        }
    }
}

#[test]
fn v35_b_slides() {
    for solver in backends() {
        let scene = built(&pushed(12.0, 1e-3));
        let tape = run(&scene, &*solver, 800);
        let seed = pick(&scene, |s| s.q[BLOCK].x = 1.0);
        near("V35 (b) 12 N", tape.last().q[BLOCK].x, 0.9904, 2e-3);
        let check = |what: &str, direction: &[(Param, f64)], exact: f64| {
            near(what, slope(&scene, &tape, &seed, direction), exact, 2e-2 * exact.abs());
        };
        check("V35 (b) 12 N, d/dF", &[(Param::Force(0, 0), 1.0)], 0.213_333_333_3);
        check("V35 (b) 12 N, d/dmu", &friction(), -3.1392);
        check("V35 (b) 12 N, d/dm", &[(Param::Mass(BLOCK), 1.0)], -1.706_666_666_7);
    }
}

#[test]
fn v15_b_conveyor() {
    for solver in backends() {
        let ride = |dt| {
            let scene = built(&with_dt(conveyor(), dt));
            let tape = run(&scene, &*solver, steps(1.0, dt));
            (scene, tape)
        };
        let exact = 1.490_316_004_077_472;
        for dt in [1e-2, 1e-3] {
            let (_, tape) = ride(dt);
            near("V15 (b) x(1), C=2", tape.last().q[BLOCK].x, exact, 2.0 * dt);
            near("V15 (b) v(1)", tape.last().v[BLOCK].x, 2.0, 1e-10);
            let rides = |k: &usize| (tape.state(*k).v[BLOCK].x - 2.0).abs() <= 1e-9;
            let first = (0..=tape.records.len()).find(rides).expect("it rides along");
            near("V15 (b) time", first as f64 * dt, 0.509_683_995_922_528_03, 2.0 * dt);
        }
        order("V15 (b) x(1)", 0.9, |dt| ride(dt).1.last().q[BLOCK].x - exact);
        let (scene, tape) = ride(1e-3);
        let seed = pick(&scene, |s| s.q[BLOCK].x = 1.0);
        let by_friction = slope(&scene, &tape, &seed, &friction());
        near("V15 (b) dx/dmu", by_friction, 1.274_209_989_806_320_1, 2e-2 * 1.274);
        let by_belt = slope(&scene, &tape, &seed, &[(Param::Velocity(0, 0), 1.0)]);
        near("V15 (b) dx/d belt", by_belt, 0.490_316_004_077_471_97, 2e-2 * 0.49);
    }
}

/// V24: friction exactly at its bound stops the box; the derivative is one-sided and says so.
#[test]
fn v24_weakly_active_friction() {
    let mut unit = block("box", [1.0, 1.0], [0.0, 0.5]);
    unit.velocity = [0.05, 0.0];
    let bodies = vec![floor(), unit];
    let def = SceneDef { gravity: [0.0, -10.0], bodies, ..SceneDef::default() };
    let scene = built(&material(def, 0.5, 0.0));
    for solver in backends() {
        let tape = run(&scene, &*solver, 1);
        near("V24 stops exactly", tape.last().v[BLOCK].x, 0.0, 1e-12);
        let seed = pick(&scene, |s| s.v[BLOCK].x = 1.0);
        let by_speed = slope(&scene, &tape, &seed, &[(Param::Velocity(BLOCK, 0), 1.0)]);
        near("V24 dv/dv0 in [0, 1]", by_speed.clamp(0.0, 1.0), by_speed, 1e-9);
        let report = last_gradient(&scene, &tape, &seed).report;
        assert!(!report.one_sided.is_empty(), "the report must name the weakly active friction");
    }
}
