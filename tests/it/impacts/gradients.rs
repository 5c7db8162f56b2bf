//! Derivatives through located impacts, against those of the motion.

use tangency::diff::{
    Gradient, RolloutVector, StateVector, Switch, gradient, step_jacobian, tangent,
};
use tangency::{
    BodyDef, JointDef, JointKind, LcpSolver, Limits, Param, Rollout, Scene, SceneDef, Shape,
    Softness, WORLD,
};
use tangency_bench::finite_difference::derivative;
use tangency_bench::scenes::{block, disc, floor, hinge, material, plane, rod, unit_scene};

use super::{bounced, dropped, resolved};
use crate::engine::{backends, built, near, near_relative, run, with_dt};

/// The gradient of one number of the last state.
fn gradient_of(scene: &Scene, rollout: &Rollout, seed: &StateVector) -> Gradient {
    let last = rollout.records.len();
    gradient(scene, rollout, |k, _| (k == last).then(|| seed.clone())).expect("a gradient")
}

fn seed(bodies: usize, body: usize, axis: usize) -> StateVector {
    let mut seed = StateVector::zeros(bodies);
    seed.q[body][axis] = 1.0;
    seed
}

/// The same number along the change of one parameter.
fn forward(scene: &Scene, rollout: &Rollout, param: Param, seed: &StateVector) -> f64 {
    let mut along = RolloutVector::zeros(scene, rollout.records.len());
    along.add(scene, param, 1.0);
    let changes = tangent(scene, rollout, &along).expect("a tangent");
    seed.dot(changes.last().expect("a change per state"))
}

/// What the bouncing disc depends on, in the order of the closed form.
const NUMBERS: [Param; 5] = [
    Param::Position(1, 1),
    Param::Velocity(1, 1),
    Param::Restitution(1),
    Param::Gravity(1),
    Param::Radius(1, 0),
];

fn direction(index: usize) -> [f64; 5] {
    let mut d = [0.0; 5];
    d[index] = if index == 3 { -1.0 } else { 1.0 };
    d
}

/// The gradient by the restitution of the pair, which is mixed of both bodies'.
fn mixed(scene: &Scene, param: Param, value: f64) -> f64 {
    match param {
        Param::Restitution(_) => value / scene.pair_restitution(0, 1).d[1],
        _ => value,
    }
}

/// One, two and four bounces, rising and falling: forwards and backwards, at several dt.
#[test]
fn bounces_have_the_derivatives_of_the_motion() {
    for solver in backends() {
        for (y, v, e, dt, count) in [
            (1.0, 0.0, 0.5, 0.005, 150),
            (1.0, 0.0, 0.5, 0.005, 190),
            (1.0, 0.0, 0.5, 0.05, 19),
            (0.7, -1.3, 0.8, 0.004, 350),
            (0.4, 1.1, 0.9, 0.003, 500),
        ] {
            let scene = built(&with_dt(dropped(0.1, y, v, e), dt));
            let rollout = run(&scene, &*solver, count);
            let seed = seed(2, 1, 1);
            let found = gradient_of(&scene, &rollout, &seed);
            assert!(found.report.one_sided.is_empty(), "{:?}", found.report.one_sided);
            for (index, param) in NUMBERS.into_iter().enumerate() {
                let values = [y, v, e, 9.81, 0.1];
                let exact = bounced(values, direction(index), rollout.last().time);
                near("height", rollout.last().q[1].y, exact[0], 1e-11);
                let backward = mixed(&scene, param, found.by.by(&scene, param));
                near("backwards", backward, exact[1], 1e-10 * exact[1].abs().max(1.0));
                let along = mixed(&scene, param, forward(&scene, &rollout, param, &seed));
                near("forwards", along, backward, 1e-12 * backward.abs().max(1.0));
            }
        }
    }
}

/// The figures of the yardstick: a disc dropped from 1 m, after 0.75 s in steps of 5 ms.
#[test]
fn the_yardstick() {
    for solver in backends() {
        let scene = built(&dropped(0.1, 1.0, 0.0, 0.5));
        let rollout = run(&scene, &*solver, 150);
        let found = gradient_of(&scene, &rollout, &seed(2, 1, 1));
        let by = |param| mixed(&scene, param, found.by.by(&scene, param));
        near("height", rollout.last().q[1].y, 0.268_348, 5e-7);
        near("dy/dy0", by(NUMBERS[0]), 0.626_339, 5e-7);
        near("dy/dv0", by(NUMBERS[1]), 0.107_471, 5e-7);
        near("dy/de", by(NUMBERS[2]), 1.351_607, 5e-7);
    }
}

/// V34 (a) and (b): without and with gravity, e = 1 and less.
#[test]
fn through_an_impact() {
    for solver in backends() {
        let mut def = dropped(0.1, 1.0, -2.0, 1.0);
        def.gravity = [0.0, 0.0];
        let scene = built(&with_dt(def, 0.01));
        let rollout = run(&scene, &*solver, 100);
        let found = gradient_of(&scene, &rollout, &seed(2, 1, 1));
        let by = |param| mixed(&scene, param, found.by.by(&scene, param));
        near("height", rollout.last().q[1].y, 1.2, 1e-12);
        for (param, exact) in [(0, -1.0), (1, -1.0), (2, 1.1), (4, 2.0)] {
            near("derivative", by(NUMBERS[param]), exact, 1e-12);
        }
        let scene = built(&dropped(0.1, 1.0, -2.0, 1.0));
        let rollout = run(&scene, &*solver, 120);
        let found = gradient_of(&scene, &rollout, &seed(2, 1, 1));
        let by = |param| mixed(&scene, param, found.by.by(&scene, param));
        near("height", rollout.last().q[1].y, 1.100_864_653_950_683, 1e-12);
        let exact = [
            0.389_047_015_202_521,
            -0.224_232_956_984_510_95,
            1.533_332_326_975_341_5,
            -0.020_617_372_711_456_898,
            0.610_952_984_797_479,
        ];
        for (param, exact) in NUMBERS.into_iter().zip(exact) {
            near("derivative", by(param), exact, 1e-11);
        }
    }
}

/// V34 (d): two discs of 1 and 3 kg; V08: a row of discs passes its derivative on.
#[test]
fn through_the_impact_of_two_discs() {
    let ball = |name: &str, r: f64, m: f64, x: f64, v: f64| BodyDef {
        mass: Some(m),
        velocity: [v, 0.0],
        ..disc(name, r, [x, 0.0])
    };
    let bodies = vec![ball("a", 0.1, 1.0, 0.0, 2.0), ball("b", 0.2, 3.0, 1.2, -0.5)];
    let scene = built(&resolved(material(with_dt(unit_scene("two", bodies), 0.01), 0.0, 0.6)));
    let params = [
        (Param::Position(0, 0), [-0.2, 0.4]),
        (Param::Position(1, 0), [1.2, 0.6]),
        (Param::Velocity(0, 0), [-0.2, 0.4]),
        (Param::Velocity(1, 0), [1.2, 0.6]),
        (Param::Mass(0), [0.48, 0.48]),
        (Param::Mass(1), [-0.16, -0.16]),
        (Param::Radius(0, 0), [-1.2, 0.4]),
        (Param::Radius(1, 0), [-1.2, 0.4]),
    ];
    for solver in backends() {
        let rollout = run(&scene, &*solver, 100);
        for (body, place) in [0.08, 1.34].into_iter().enumerate() {
            near("place", rollout.last().q[body].x, place, 1e-12);
            let found = gradient_of(&scene, &rollout, &seed(2, body, 0));
            for (param, exact) in params {
                near("derivative", found.by.by(&scene, param), exact[body], 1e-11);
            }
        }
    }
}

/// V36 (a): a bank shot off floor and wall.
#[test]
fn a_bank_shot() {
    let shot = BodyDef { mass: Some(1.0), velocity: [5.0, -5.0], ..disc("shot", 0.1, [-0.5, 1.0]) };
    let bodies = vec![floor(), plane("wall", [-1.0, 0.0], -1.75), shot];
    let def = SceneDef { gravity: [0.0, -9.8], dt: 0.01, bodies, ..SceneDef::default() };
    let scene = built(&resolved(material(def, 0.0, 0.92)));
    for solver in backends() {
        let rollout = run(&scene, &*solver, 60);
        let [x, y, _] = rollout.last().q[2].into();
        near("loss", (x + 2.0).powi(2) + (y - 1.5).powi(2), 8.316_138_582_201_789_2, 1e-10);
        let mut seed = StateVector::zeros(3);
        (seed.q[2].x, seed.q[2].y) = (2.0 * (x + 2.0), 2.0 * (y - 1.5));
        let found = gradient_of(&scene, &rollout, &seed);
        for (param, exact) in [
            (Param::Position(2, 0), -5.27712),
            (Param::Position(2, 1), 0.216_285_754_846_219_35),
            (Param::Velocity(2, 0), -3.166_272),
            (Param::Velocity(2, 1), -0.212_229_548_006_031_56),
        ] {
            near_relative("derivative", found.by.by(&scene, param), exact, 1e-10);
        }
        let e = found.by.by(&scene, Param::Restitution(2)) / scene.pair_restitution(0, 2).d[1];
        near_relative("by e", e, -3.129_588_067_683_528_7, 1e-10);
    }
}

/// A spinning box on one corner, with friction: no closed form, but the differences of the runs.
fn tumbling() -> SceneDef {
    let thrown = BodyDef {
        mass: Some(1.3),
        angle: 0.4,
        angular_velocity: 2.0,
        velocity: [1.0, -0.5],
        ..block("box", [0.4, 0.2], [0.0, 0.6])
    };
    let other = BodyDef { mass: Some(0.8), velocity: [-0.5, 0.3], ..disc("disc", 0.1, [0.7, 0.5]) };
    let bodies = vec![floor(), thrown, other];
    let def = SceneDef { name: "tumbling".into(), dt: 0.01, bodies, ..SceneDef::default() };
    resolved(material(def, 0.3, 0.6))
}

fn differences(def: &SceneDef, count: usize, params: &[Param], step: f64) {
    let scene = built(def);
    for solver in backends() {
        let solver: &dyn LcpSolver = &*solver;
        let rollout = run(&scene, solver, count);
        let impacts = rollout.records.iter().map(|record| record.counts(&scene).impacts);
        assert!(impacts.sum::<usize>() > 0, "{}: nothing is hit", def.name);
        let mut seed = StateVector::zeros(scene.bodies().len());
        for (i, (q, v)) in seed.q.iter_mut().zip(&mut seed.v).enumerate() {
            let s = 1.0 + i as f64;
            (q.x, q.y, q.z, v.x, v.y, v.z) = (0.7 * s, -0.4 * s, 0.3, 0.2 * s, 0.5, -0.1 * s);
        }
        let value = |rollout: &Rollout| {
            let last =
                StateVector { time: 0.0, q: rollout.last().q.clone(), v: rollout.last().v.clone() };
            seed.dot(&last)
        };
        let found = gradient_of(&scene, &rollout, &seed);
        for param in params {
            let at = |x: f64| {
                let mut other = scene.clone();
                other.set(*param, x).expect("a value");
                value(&run(&other, solver, count))
            };
            let middle = scene.get(*param).expect("a number of the scene");
            let estimate = derivative(at, middle, step);
            let exact = found.by.by(&scene, *param);
            let tolerance = 1e-7 * exact.abs().max(1.0) + 2.0 * estimate.error;
            near(&format!("{param:?}"), exact, estimate.value, tolerance);
            let along = forward(&scene, &rollout, *param, &seed);
            near(&format!("{param:?} forwards"), along, exact, 1e-11 * exact.abs().max(1.0));
        }
    }
}

#[test]
fn tumbling_matches_central_differences() {
    let params = [
        Param::Position(1, 0),
        Param::Position(1, 1),
        Param::Position(1, 2),
        Param::Velocity(1, 1),
        Param::Velocity(1, 2),
        Param::Velocity(2, 0),
        Param::Mass(1),
        Param::Inertia(1),
        Param::Friction(1),
        Param::Restitution(1),
        Param::Radius(2, 0),
        Param::Gravity(1),
        Param::Dt,
    ];
    differences(&tumbling(), 40, &params, 1e-5);
}

/// Two rods on a hinge strike a wall, a disc on a spring a floor that it rubs against.
#[test]
fn joints_and_springs_through_impacts() {
    let upper = rod("upper", 0.5, 0.7, [0.25, 0.0], 0.0);
    let lower = rod("lower", 0.5, 1.1, [0.75, 0.0], 0.0);
    let end = Shape::Circle { radius: 0.05, center: [0.25, 0.0] };
    let lower = BodyDef { shapes: vec![end], angular_velocity: -1.0, ..lower };
    let joints = vec![
        hinge("pivot", WORLD, "upper", [0.0, 0.0]),
        hinge("elbow", "upper", "lower", [0.5, 0.0]),
    ];
    let bodies = vec![plane("wall", [1.0, 0.0], 0.1), upper, lower];
    let def = SceneDef { name: "flail".into(), dt: 0.01, bodies, joints, ..SceneDef::default() };
    let params = [
        Param::Velocity(2, 2),
        Param::Mass(1),
        Param::Inertia(2),
        Param::Restitution(2),
        Param::Friction(2),
        Param::Radius(2, 0),
        Param::Gravity(1),
        Param::Dt,
    ];
    differences(&resolved(material(def, 0.2, 0.5)), 70, &params, 1e-5);

    let ball = BodyDef { mass: Some(1.0), velocity: [0.4, 0.0], ..disc("ball", 0.1, [0.0, 0.5]) };
    let spring = JointDef {
        kind: JointKind::Distance { anchor_a: [0.0, 1.0], anchor_b: [0.0, 0.5], length: None },
        softness: Some(Softness { stiffness: 20.0, damping: 0.3 }),
        ..hinge("spring", WORLD, "ball", [0.0, 0.0])
    };
    let (bodies, joints) = (vec![floor(), ball], vec![spring]);
    let def = SceneDef { name: "sprung".into(), dt: 0.01, bodies, joints, ..SceneDef::default() };
    let params = [
        Param::Position(1, 1),
        Param::Velocity(1, 0),
        Param::Stiffness(0),
        Param::Damping(0),
        Param::Length(0),
        Param::Restitution(1),
        Param::Dt,
    ];
    differences(&resolved(material(def, 0.2, 0.5)), 60, &params, 1e-5);
}

/// A slider is driven into its limit and falls back; nothing bounces.
#[test]
fn limits_through_impacts() {
    let (upper, axis) = (0.31, [1.0, 0.0]);
    let rail = JointDef {
        kind: JointKind::Prismatic {
            anchor: [0.0, 0.0],
            axis,
            limits: Limits { lower: None, upper: Some(upper) },
            motor: None,
        },
        ..hinge("rail", WORLD, "slider", [0.0, 0.0])
    };
    let slider =
        BodyDef { mass: Some(2.0), velocity: [1.0, 0.0], ..disc("slider", 0.1, [0.0, 0.0]) };
    let (gravity, joints) = ([-0.7, -1.0], vec![rail]);
    let def = SceneDef { name: "stop".into(), gravity, joints, ..SceneDef::default() };
    let def = resolved(SceneDef { dt: 0.01, bodies: vec![slider], ..def });
    let params = [
        Param::Velocity(0, 0),
        Param::Position(0, 0),
        Param::Upper(0),
        Param::Gravity(0),
        Param::Mass(0),
        Param::Dt,
    ];
    differences(&def, 60, &params, 1e-5);
}

/// All columns of one divided step.
#[test]
fn jacobians_of_divided_steps() {
    let scene = built(&with_dt(dropped(0.1, 1.0, 0.0, 0.5), 0.5));
    for solver in backends() {
        let rollout = run(&scene, &*solver, 1);
        let record = &rollout.records[0];
        assert_eq!(record.counts(&scene).impacts, 1);
        let jacobian = step_jacobian(&scene, &rollout.initial, record, &[]).expect("a Jacobian");
        for (column, index) in [(1, 0), (4, 1)] {
            let exact = bounced([1.0, 0.0, 0.5, 9.81, 0.1], direction(index), 0.5)[1];
            near("column", jacobian.state[(1, column)], exact, 1e-11);
        }
    }
}

/// A box that lands flat: two gaps close at once, and the report says so.
#[test]
fn several_gaps_at_once_are_told() {
    let fallen = BodyDef { mass: Some(1.0), ..block("box", [0.4, 0.2], [0.0, 0.6]) };
    let def = SceneDef { dt: 0.005, bodies: vec![floor(), fallen], ..SceneDef::default() };
    let scene = built(&resolved(material(def, 0.0, 0.5)));
    for solver in backends() {
        let rollout = run(&scene, &*solver, 100);
        let found = gradient_of(&scene, &rollout, &seed(2, 1, 1));
        let exact = bounced([0.6, 0.0, 0.5, 9.81, 0.1], direction(0), 0.5)[1];
        near("by height", found.by.by(&scene, Param::Position(1, 1)), exact, 1e-10);
        let kinds: Vec<_> = found.report.one_sided.iter().map(|row| row.kind).collect();
        assert_eq!(kinds, [Switch::Together]);
    }
}
