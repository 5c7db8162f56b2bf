//! Derivatives of accurate steps: those of the motion where it has a closed form, and those of the rollout
//! itself by central differences; forwards and backwards.

use tangency::diff::{
    Coordinates, Parameter, RolloutVector, StateVector, gradient, step_jacobian, tangent,
};
use tangency::{BodyDef, BodyKind, LcpSolver, Param, Rollout, Scene, SceneDef, Shape, State};
use tangency_bench::finite_difference::derivative;
use tangency_bench::retelling::params;
use tangency_bench::scenes::{
    block, conveyor, disc, double_pendulum, floor, groove, incline_block, ladder, material,
    motor_arm, pendulum, piston, plane, slider_crank, sliding_disc, soft_bridge, spring_cart,
};

use super::accurate;
use crate::engine::{backends, built, near, run, steps};

/// A seed that looks at every number of the dynamic bodies.
fn all_numbers(scene: &Scene) -> StateVector {
    let mut seed = StateVector::zeros(scene.bodies().len());
    for i in (0..scene.bodies().len()).filter(|i| scene.is_dynamic(*i)) {
        let k = i as f64;
        seed.q[i] = [0.3 + k, -0.7, 1.1 - 0.2 * k].into();
        seed.v[i] = [0.2, 0.5 - k, 0.4].into();
    }
    seed
}

fn seen(seed: &StateVector, rollout: &Rollout) -> f64 {
    let last = rollout.last();
    let inner = |a: &[nalgebra::Vector3<f64>], b: &[nalgebra::Vector3<f64>]| -> f64 {
        a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
    };
    inner(&seed.q, &last.q) + inner(&seed.v, &last.v)
}

/// The gradient of what a seed sees of the last state.
fn backward(scene: &Scene, rollout: &Rollout, seed: &StateVector) -> RolloutVector {
    let last = rollout.records.len();
    let seed = |k: usize, _: &State| (k == last).then(|| seed.clone());
    gradient(scene, rollout, seed).expect("a gradient").by
}

fn forward(
    scene: &Scene,
    rollout: &Rollout,
    direction: &[(Param, f64)],
    seed: &StateVector,
) -> f64 {
    let mut along = RolloutVector::zeros(scene, rollout.records.len());
    for (param, rate) in direction {
        along.add(scene, *param, *rate);
    }
    let changes = tangent(scene, rollout, &along).expect("a tangent");
    seed.dot(changes.last().expect("a change per state"))
}

/// A derivative along a direction in both modes, which agree.
#[track_caller]
fn slope(scene: &Scene, rollout: &Rollout, direction: &[(Param, f64)], seed: &StateVector) -> f64 {
    let by = backward(scene, rollout, seed);
    let found = direction.iter().map(|(param, rate)| rate * by.by(scene, *param)).sum::<f64>();
    let along = forward(scene, rollout, direction, seed);
    near("forwards", along, found, 1e-12 * found.abs().max(1.0));
    found
}

/// By every number of machines with hinges, rails, springs, motors, limits and forces in time; positions of
/// machines that rest on a limit are left out, which open or close it.
#[test]
fn machines_have_the_derivatives_of_their_rollout() {
    let scenes: [(SceneDef, f64, usize); 7] = [
        (pendulum(2.5), 0.01, 30),
        (double_pendulum([0.5, 0.3]), 0.01, 30),
        (slider_crank(0.5, 10.0), 0.005, 30),
        (spring_cart(), 0.01, 50),
        (soft_bridge(4), 0.01, 20),
        (motor_arm(), 0.01, 50),
        (piston(), 0.01, 30),
    ];
    for solver in backends() {
        for (def, dt, count) in &scenes {
            let scene = built(&accurate(def.clone(), *dt));
            let rollout = run(&scene, &*solver, *count);
            let seed = all_numbers(&scene);
            for param in params(&scene) {
                compare(&scene, &*solver, &rollout, param, &seed);
            }
        }
    }
}

/// A body that falls by a few centimetres onto what is fixed, and stays on it without a bounce.
fn landing(fixed: BodyDef, falling: BodyDef, friction: f64) -> SceneDef {
    let bodies = vec![fixed, BodyDef { mass: Some(1.0), ..falling }];
    let name = format!("{} on {}", bodies[1].name, bodies[0].name);
    accurate(material(SceneDef { name, bodies, ..SceneDef::default() }, friction, 0.0), 0.005)
}

/// By every number, those of shapes among them, of what then slides on a corner, turns about one, rolls down a
/// slope, and over a disc: their rows bend by where points and lines are in the bodies. Not by dt, of which only
/// what the method is off by depends: times of lift-off leave as much out.
#[test]
fn shapes_of_what_lands() {
    let (sin, cos) = 0.3_f64.sin_cos();
    let tilted = |name| BodyDef { angle: 0.5, ..block(name, [0.4, 0.2], [0.0, 0.22]) };
    let round = |at| BodyDef { angular_velocity: -1.0, ..disc("disc", 0.2, at) };
    let hill = BodyDef { kind: BodyKind::Static, ..disc("hill", 0.5, [0.0, -0.5]) };
    let rod = Shape::Capsule { a: [-0.3, 0.02], b: [0.2, -0.05], radius: 0.05 };
    let rod = BodyDef { shapes: vec![rod], inertia: Some(0.1), ..tilted("rod") };
    let scenes = [
        landing(floor(), tilted("sliding box"), 0.1),
        landing(floor(), BodyDef { velocity: [0.3, 0.0], ..tilted("turning box") }, 2.0),
        landing(floor(), rod, 0.1),
        landing(plane("slope", [sin, cos], 0.0), round([0.0, 0.25]), 0.5),
        landing(hill, round([0.05, 0.23]), 0.5),
    ];
    for solver in backends() {
        for def in &scenes {
            let scene = built(def);
            let rollout = run(&scene, &*solver, 44);
            let last = rollout.records.last().expect("a step");
            assert!(!last.contact_impulses().is_empty(), "{} is in the air", def.name);
            let seed = all_numbers(&scene);
            for param in params(&scene).into_iter().filter(|param| *param != Param::Dt) {
                compare(&scene, &*solver, &rollout, param, &seed);
            }
        }
    }
}

#[track_caller]
fn compare(
    scene: &Scene,
    solver: &dyn LcpSolver,
    rollout: &Rollout,
    param: Param,
    seed: &StateVector,
) {
    let found = slope(scene, rollout, &[(param, 1.0)], seed);
    let value = scene.get(param).expect("a number of the scene");
    let (mut changed, step) = (scene.clone(), 1e-5 * value.abs().max(1.0));
    if changed.set(param, value - step).is_err() || changed.set(param, value + step).is_err() {
        return; // at the end of what it may be: no difference on both sides
    }
    let mut at = |x: f64| {
        changed.set(param, x).expect("a value near its own");
        seen(seed, &run(&changed, solver, rollout.records.len()))
    };
    let difference = derivative(&mut at, value, step);
    let (name, scale) = (&scene.def().name, found.abs().max(1.0));
    near(&format!("{name}, {param:?}"), found, difference.value, 1e-6 * scale);
}

fn seed_of(scene: &Scene, body: usize, axis: usize) -> StateVector {
    let mut seed = StateVector::zeros(scene.bodies().len());
    seed.q[body][axis] = 1.0;
    seed
}

/// V02 at t = 2: by the start angle and by gravity.
#[test]
fn a_pendulum() {
    let (sin, cos) = 2.5_f64.sin_cos();
    let start = [
        (Param::Position(0, 0), 0.5 * cos),
        (Param::Position(0, 1), 0.5 * sin),
        (Param::Position(0, 2), 1.0),
    ];
    for solver in backends() {
        let scene = built(&accurate(pendulum(2.5), 1e-3));
        let rollout = run(&scene, &*solver, 2000);
        let seed = seed_of(&scene, 0, 2);
        near(
            "by the angle",
            slope(&scene, &rollout, &start, &seed),
            -8.067_354_362_055_703_3,
            1e-8,
        );
        let by_g = slope(&scene, &rollout, &[(Param::Gravity(1), -1.0)], &seed);
        near("by gravity", by_g, 0.740_331_907_489_375_18, 1e-8);
        let heavier = [(Param::Mass(0), 1.0), (Param::Inertia(0), 1.0 / 12.0)];
        near("by mass", slope(&scene, &rollout, &heavier, &seed), 0.0, 1e-9);
    }
}

/// V05 (b), V07, V15 (b): through the end of sliding.
#[test]
fn through_the_end_of_sliding() {
    let friction = |body: usize| [(Param::Friction(0), 1.0), (Param::Friction(body), 1.0)];
    for solver in backends() {
        let (sin, cos) = 30.0_f64.to_radians().sin_cos();
        let scene = built(&accurate(incline_block(30.0_f64.to_radians(), 0.7, 3.0), 0.01));
        let rollout = run(&scene, &*solver, 50);
        let mut seed = StateVector::zeros(2);
        seed.q[1] = [cos, sin, 0.0].into();
        let by_speed = [(Param::Velocity(1, 0), cos), (Param::Velocity(1, 1), sin)];
        near(
            "block, v0",
            slope(&scene, &rollout, &by_speed, &seed),
            0.276_446_828_418_523_14,
            1e-11,
        );
        let by_mu = slope(&scene, &rollout, &friction(1), &seed);
        near("block, mu", by_mu, -0.324_633_150_851_300_21, 1e-11);

        let scene = built(&accurate(sliding_disc(), 0.01));
        let rollout = run(&scene, &*solver, 200);
        let by_speed = [(Param::Velocity(1, 0), 1.0)];
        let seed = seed_of(&scene, 1, 0);
        near("disc, v0", slope(&scene, &rollout, &by_speed, &seed), 1.514_554_309_661_343_3, 1e-10);
        let by_mu = slope(&scene, &rollout, &friction(1), &seed);
        near("disc, mu", by_mu, -1.449_767_810_624_079_7, 1e-10);

        let scene = built(&accurate(conveyor(), 0.01));
        let rollout = run(&scene, &*solver, 100);
        let seed = seed_of(&scene, 1, 0);
        let by_mu = slope(&scene, &rollout, &friction(1), &seed);
        near("belt, mu", by_mu, 1.274_209_989_806_320_1, 1e-10);
        let by_belt = slope(&scene, &rollout, &[(Param::Velocity(0, 0), 1.0)], &seed);
        near("belt, speed", by_belt, 0.490_316_004_077_471_97, 1e-10);
    }
}

/// V11: through a lift-off, whose time drops out. V18: sliding at two walls.
#[test]
fn through_lift_off_and_along_two_walls() {
    for solver in backends() {
        let (sin, cos) = 70.0_f64.to_radians().sin_cos();
        let scene = built(&accurate(ladder(70.0_f64.to_radians()), 2e-3));
        let rollout = run(&scene, &*solver, 400);
        let angle = [
            (Param::Position(2, 0), -sin),
            (Param::Position(2, 1), cos),
            (Param::Position(2, 2), -1.0),
        ];
        let mut seed = StateVector::zeros(3);
        seed.v[2].x = 1.0;
        near("ladder", slope(&scene, &rollout, &angle, &seed), 0.734_284_056_914_434_28, 1e-7);

        let scene = built(&accurate(groove(0.3), 0.01));
        let rollout = run(&scene, &*solver, 30);
        let body = scene.bodies().len() - 1;
        let mut seed = StateVector::zeros(body + 1);
        seed.v[body].z = rollout.last().v[body].z.signum();
        let by_mu: Vec<_> = (0..=body).map(|i| (Param::Friction(i), 1.0)).collect();
        near("groove", slope(&scene, &rollout, &by_mu, &seed), -31.878_190_116_978_8, 1e-8);
    }
}

/// The matrices of a step are the same derivatives: a step later, along the change of the one before.
#[test]
fn jacobians_of_steps() {
    for solver in backends() {
        let scene = built(&accurate(slider_crank(0.5, 10.0), 0.01));
        let rollout = run(&scene, &*solver, steps(0.1, 0.01));
        let mut along = RolloutVector::zeros(&scene, rollout.records.len());
        along.add(&scene, Param::Gravity(1), 1.0);
        let changes = tangent(&scene, &rollout, &along).expect("a tangent");
        let coordinates = Coordinates::of(&scene);
        let targets = vec![(Param::Gravity(1), 1.0)];
        let parameter = Parameter { name: "gravity".into(), targets };
        for (k, record) in rollout.records.iter().enumerate() {
            let found =
                step_jacobian(&scene, rollout.state(k), record, std::slice::from_ref(&parameter));
            let found = found.expect("a Jacobian");
            let before = coordinates.flatten(&changes[k]);
            let after = found.state * before + found.parameters.column(0);
            let exact = coordinates.flatten(&changes[k + 1]);
            near("change", (after - &exact).norm(), 0.0, 1e-11 * exact.norm().max(1.0));
        }
    }
}
