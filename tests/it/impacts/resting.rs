//! What comes to rest, slides, rolls and hangs between impacts.

use tangency::{BodyDef, BodyKind, JointDef, JointKind, Limits, SceneDef, WORLD};
use tangency_bench::scenes::{
    disc, hinge, material, pendulum, race_chain, race_stack, sliding_disc,
};

use super::{dropped, resolved};
use crate::engine::{backends, built, near, run, steps, with_dt};

/// V04: infinitely many bounces end, within a step, when the closed form's do, and what rests stays.
#[test]
fn bounces_come_to_rest() {
    for e in [0.3_f64, 0.5, 0.8] {
        let first = (2.0 * 0.9 / 9.81_f64).sqrt();
        let end = first * (1.0 + e) / (1.0 - e);
        for solver in backends() {
            let scene = built(&dropped(0.1, 1.0, 0.0, e));
            let rollout = run(&scene, &*solver, steps(end + 1.0, 0.005));
            let moves = |v: f64| v.abs() > 1e-12;
            let last = rollout.states().filter(|state| moves(state.v[1].y)).last();
            near("end", last.expect("it falls").time, end, 0.01);
            near("height", rollout.last().q[1].y, 0.1, 1e-9);
            assert!(rollout.records.iter().all(|record| !record.fell_back()), "e = {e}");
        }
    }
}

/// V04: gaps after 1, 3, 6 and 19 impacts.
#[test]
fn gaps_of_many_bounces() {
    let gaps = [
        (1.0, 0.468_004_452_526_036_31),
        (2.0, 0.260_741_728_327_057_2),
        (3.0, 0.068_707_460_965_765_722),
    ];
    for solver in backends() {
        let rollout = run(&built(&dropped(0.1, 1.1, 0.0, 0.8)), &*solver, 600);
        for (time, gap) in gaps {
            near("gap", rollout.state(steps(time, 0.005)).q[1].y - 0.1, gap, 1e-9);
        }
    }
}

/// V29: at rest with e = 1, nothing moves.
#[test]
fn rest_is_quiet() {
    for solver in backends() {
        let rollout = run(&built(&dropped(0.1, 0.1, 0.0, 1.0)), &*solver, 1000);
        near("speed", rollout.last().v[1].norm(), 0.0, 1e-12);
        near("height", rollout.last().q[1].y, 0.1, 1e-12);
    }
}

/// A disc slides on the floor with constant deceleration: exact until it rolls, and then it rolls on.
#[test]
fn sliding_and_rolling_stay_closed() {
    for solver in backends() {
        let scene = built(&resolved(with_dt(sliding_disc(), 0.01)));
        let rollout = run(&scene, &*solver, 200);
        let mu = scene.pair_friction(0, 1).value;
        let [start, slid] = [0, 50].map(|k| rollout.state(k));
        let v = start.v[1].x;
        near("slid", slid.q[1].x - start.q[1].x, v * 0.5 - 0.5 * mu * 9.81 * 0.25, 1e-12);
        let rolled = rollout.last();
        near("rolls at", rolled.v[1].x, 2.0 / 3.0 * v, 1e-10);
        near("height", rolled.q[1].y, start.q[1].y, 1e-12);
    }
}

/// The ten boxes of the race: the top one slides off its speed, and nothing else moves.
#[test]
fn a_stack_stands() {
    for solver in backends() {
        let scene = built(&resolved(race_stack(10)));
        let rollout = run(&scene, &*solver, 200);
        let end = rollout.last();
        near("top", end.q[10].x, 0.25 / (2.0 * 0.2 * 9.81), 1e-5);
        for body in 1..10 {
            near("sideways", end.q[body].x, 0.0, 1e-9);
            near("height", end.q[body].y, 0.25 + 0.5 * (body - 1) as f64, 1e-8);
        }
    }
}

/// V02: the energy of a large pendulum, of second order in dt; its joint stays closed.
#[test]
fn a_pendulum_swings() {
    for solver in backends() {
        let error = |dt: f64| {
            let scene = built(&resolved(with_dt(pendulum(2.5), dt)));
            let rollout = run(&scene, &*solver, steps(2.0, dt));
            let energy = |k: usize| scene.energy(rollout.state(k));
            assert!(scene.joint_drift(rollout.last()) < 1e-9);
            let errors = (0..=rollout.records.len()).map(|k| (energy(k) - energy(0)).abs());
            errors.fold(0.0, f64::max)
        };
        let (coarse, fine) = (error(0.01), error(0.005));
        assert!(coarse < 0.02 && fine < 0.3 * coarse, "energy is off by {coarse:e}, {fine:e}");
    }
}

/// A chain swings without impacts, and stays together.
#[test]
fn a_chain_hangs_together() {
    for solver in backends() {
        let scene = built(&resolved(race_chain(10)));
        let rollout = run(&scene, &*solver, 200);
        assert!(scene.joint_drift(rollout.last()) < 1e-8, "{}", scene.joint_drift(rollout.last()));
    }
}

/// A disc slides off a fixed one: it follows the curve, and leaves where nothing presses any more,
///
/// ```text
///  cos φ = ⅔ + v₀²/(3 g (R + r))
/// ```
#[test]
fn curves_are_followed_until_nothing_presses() {
    let (sum, v) = (1.0, 0.5);
    let hill = BodyDef { kind: BodyKind::Static, ..disc("hill", 0.8, [0.0, 0.0]) };
    let ball = BodyDef { mass: Some(1.0), velocity: [v, 0.0], ..disc("ball", 0.2, [0.0, sum]) };
    let def = SceneDef { dt: 0.001, bodies: vec![hill, ball], ..SceneDef::default() };
    let scene = built(&resolved(material(def, 0.0, 0.0)));
    let exact = 2.0 / 3.0 + v * v / (3.0 * 9.81 * sum);
    for solver in backends() {
        let rollout = run(&scene, &*solver, 900);
        let apart = |k: usize| rollout.state(k).q[1].xy().norm() - sum;
        let follows = (0..=900).take_while(|k| apart(*k).abs() <= 1e-9).count();
        near("leaves at", rollout.state(follows - 1).q[1].y / sum, exact, 5e-3);
        assert!(apart(900) > 1e-3, "it leaves");
    }
}

/// A slider runs into its limit: it stops there at the time of the motion.
#[test]
fn limits_are_located() {
    let slider = BodyDef { mass: Some(2.0), ..disc("slider", 0.1, [0.0, 0.0]) };
    let rail = JointDef {
        kind: JointKind::Prismatic {
            anchor: [0.0, 0.0],
            axis: [1.0, 0.0],
            limits: Limits { lower: None, upper: Some(0.31) },
            motor: None,
        },
        ..hinge("rail", WORLD, "slider", [0.0, 0.0])
    };
    let bodies = vec![BodyDef { velocity: [1.0, 0.0], ..slider }];
    let def = SceneDef { bodies, joints: vec![rail], dt: 0.02, ..SceneDef::default() };
    for solver in backends() {
        let rollout = run(&built(&resolved(material(def.clone(), 0.0, 0.0))), &*solver, 30);
        near("before", rollout.state(15).q[0].x, 0.30, 1e-12);
        near("place", rollout.last().q[0].x, 0.31, 1e-12);
        near("speed", rollout.last().v[0].x, 0.0, 1e-12);
    }
}
