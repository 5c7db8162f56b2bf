//! Smoothed derivatives: what they are of one contact, both modes of them, and what they are good for.

use nalgebra::Vector3;
use tangency::control::{Dynamics, SceneDynamics};
use tangency::diff::{Coordinates, Direction, GaussNewton, ResidualSeed, step_jacobian, step_jvp};
use tangency::{
    BodyDef, ControlDef, ControlInput, Gradient, GradientMode, JointDef, JointKind, LcpSolver,
    Param, Rollout, RolloutVector, Scene, SceneDef, SceneVector, State, StateVector, WORLD,
    gradient, rollout, tangent,
};
use tangency_bench::retelling::{Retelling, Units};
use tangency_bench::scenes::{
    block, cradle, disc, floor, hanging_chain_hit, material, pushed_box, sliding_box, stack,
};

use crate::engine::{backends, built, near, near_relative, run, with_dt};
use crate::gradients::battery::battery;
use crate::gradients::loss::coefficients;
use crate::gradients::numbers::{controls, numbers};
use crate::impacts::resolved;

const SMOOTH: GradientMode = GradientMode::Smoothed { kappa: 1e-3 };

fn prepared(mut tape: Rollout, mode: GradientMode) -> Rollout {
    mode.prepare(&mut tape).unwrap_or_else(|error| panic!("{error}"));
    tape
}

fn of_all_states(scene: &Scene, tape: &Rollout) -> Gradient {
    gradient(scene, tape, |k, state| Some(coefficients(k, state))).expect("a gradient")
}

/// A box (1 kg) on a floor with μ = 1/2, pushed by a force: 4.905 N make it slip.
fn stuck_box() -> SceneDef {
    let cube = BodyDef { mass: Some(1.0), ..block("box", [0.4, 0.4], [0.0, 0.2]) };
    let input = ControlInput::ForceX { body: "box".into() };
    let controls = vec![ControlDef { name: "push".into(), input }];
    let def = SceneDef { dt: 0.02, bodies: vec![floor(), cube], controls, ..SceneDef::default() };
    material(def, 0.5, 0.0)
}

const STEPS: usize = 100;

/// x at the end, and its derivative by a constant push.
fn pushed(scene: &Scene, solver: &dyn LcpSolver, push: f64, mode: GradientMode) -> [f64; 2] {
    let tape = rollout(scene, solver, scene.initial_state(), STEPS, |_, _| vec![push]);
    let tape = prepared(tape.expect("a run"), mode);
    let seed = |state: &State| {
        let mut seed = StateVector::like(state);
        seed.q[1].x = 1.0;
        seed
    };
    let found = gradient(scene, &tape, |k, state| (k == STEPS).then(|| seed(state)));
    let by = found.expect("a gradient").by.controls;
    [tape.last().q[1].x, by.iter().map(|by| by[0]).sum()]
}

/// Descent on (x − 1)² from where its exact gradient vanishes.
#[test]
fn a_stuck_box_finds_its_goal() {
    let scene = built(&stuck_box());
    for solver in backends() {
        let [x, exact] = pushed(&scene, &*solver, 2.0, GradientMode::Exact);
        near("x of a stuck box", x, 0.0, 1e-12);
        near("exact derivative of a stuck box", exact, 0.0, 1e-12);
        let mut push = 2.0;
        for _ in 0..200 {
            let [x, slope] = pushed(&scene, &*solver, push, GradientMode::Smoothed { kappa: 0.1 });
            push -= 0.2 * 2.0 * (x - 1.0) * slope;
        }
        let [x, _] = pushed(&scene, &*solver, push, GradientMode::Exact);
        near("x after descent", x, 1.0, 1e-3);
        // ½ (F − μ m g) T (T + dt) = 1, T = 2.
        near("push after descent", push, 4.905 + 2.0 / (2.0 * 2.02), 1e-2);
    }
}

/// One step of a disc that cannot turn, pushed along the floor it lies on. With λ, h = μ λₙ at
///
/// ```text
///  λₙ uₙ = ε,   uₙ = λₙ/m − g dt         u = (F dt + λ)/m = ε/(h + λ) − ε/(h − λ)
///  a = ε/(h + λ)² + ε/(h − λ)²           du/dF = dt a/(1 + a m)              ε = κ m (g dt)²
/// ```
#[test]
fn one_contact_has_a_closed_form() {
    let kind = JointKind::Lock { x: false, y: false, rotation: true };
    let bodies = [WORLD.into(), "ball".into()];
    let lock = JointDef { name: "lock".into(), bodies, kind, collide: true, softness: None };
    let ball = BodyDef { mass: Some(3.0), ..disc("ball", 0.1, [0.0, 0.1]) };
    let input = ControlInput::ForceX { body: "ball".into() };
    let def = SceneDef {
        dt: 0.02,
        bodies: vec![floor(), ball],
        joints: vec![lock],
        controls: vec![ControlDef { name: "push".into(), input }],
        ..SceneDef::default()
    };
    let scene = built(&material(def, 0.5, 0.0));
    let (m, mu, fall, dt, force) = (3.0_f64, 0.5, 9.81 * 0.02, 0.02, 7.0);
    for kappa in [1e-4, 1e-2] {
        let energy = kappa * m * fall * fall;
        let normal = 0.5 * (m * fall + (m * fall * m * fall + 4.0 * m * energy).sqrt());
        let h = mu * normal;
        let [mut low, mut high] = [-h, h];
        for _ in 0..200 {
            let y = 0.5 * (low + high);
            let excess = (force * dt + y) / m - energy / (h + y) + energy / (h - y);
            if excess > 0.0 { high = y } else { low = y }
        }
        let a = energy / (h + low).powi(2) + energy / (h - low).powi(2);
        let exact = dt * a / (1.0 + a * m);
        for solver in backends() {
            let tape = rollout(&scene, &*solver, scene.initial_state(), 1, |_, _| vec![force]);
            let tape = prepared(tape.expect("a step"), GradientMode::Smoothed { kappa });
            near("speed", tape.last().v[1].x, 0.0, 1e-14);
            let mut seed = StateVector::like(tape.last());
            seed.v[1].x = 1.0;
            let found = gradient(&scene, &tape, |k, _| (k == 1).then(|| seed.clone()));
            let by = found.expect("a gradient").by.controls[0][0];
            near_relative("dv/dF", by, exact, 1e-9);
        }
    }
}

/// Reverse and forward mode by every third number, on the scenes of the exact derivatives and on
/// scenes at switches; fixed steps and divided ones.
#[test]
fn both_modes_agree() {
    let short = |def: SceneDef| with_dt(def, 0.01);
    let more = [
        stack(&[1.0, 5.0, 1.0]),
        cradle(3, 0.0, 1.0, 1.0),
        hanging_chain_hit(),
        resolved(short(sliding_box(1.0, 0.3, 1.0))),
        resolved(short(stack(&[1.0, 2.0]))),
        resolved(short(cradle(3, 0.01, 1.0, 0.8))),
    ];
    let scenes = battery().into_iter().map(|entry| (entry.def, entry.steps));
    for (def, steps) in scenes.chain(more.into_iter().map(|def| (def, 15))) {
        let scene = built(&def);
        let controls = controls(scene.controls().len(), steps);
        for solver in backends() {
            let control = |k: usize, _: &State| controls[k].clone();
            let tape = rollout(&scene, &*solver, scene.initial_state(), steps, control);
            let tape = prepared(tape.expect("a run"), SMOOTH);
            let by = of_all_states(&scene, &tape).by;
            let params = numbers(&scene);
            let scale = params.iter().fold(1.0, |s: f64, p| s.max(by.by(&scene, *p).abs()));
            for param in params.into_iter().step_by(3) {
                let mut along = RolloutVector::zeros(&scene, steps);
                along.add(&scene, param, 1.0);
                let changes = tangent(&scene, &tape, &along).expect("a tangent");
                let term = |(k, state): (usize, &State)| coefficients(k, state).dot(&changes[k]);
                let forward: f64 = tape.states().enumerate().map(term).sum();
                let what = format!("{}, {param:?}", def.name);
                near(&what, forward, by.by(&scene, param), 1e-10 * scale);
            }
        }
    }
}

#[test]
fn states_stay_and_exact_derivatives_come_back() {
    for solver in backends() {
        let scene = built(&stack(&[1.0, 5.0, 1.0]));
        let tape = run(&scene, &*solver, 20);
        let exact = of_all_states(&scene, &tape);
        let smooth = prepared(tape.clone(), SMOOTH);
        assert_eq!(smooth, tape);
        assert_ne!(of_all_states(&scene, &smooth).by, exact.by);
        assert_eq!(of_all_states(&scene, &prepared(smooth, GradientMode::Exact)), exact);
    }
}

/// κ has no unit.
#[test]
fn units_do_not_matter() {
    let units = Units { length: 1024.0, mass: 128.0, time: 0.125 };
    for solver in backends() {
        for def in [stuck_box(), sliding_box(2.0, 0.3, 1.0), stack(&[1.0, 5.0])] {
            let [one, other] = [def.clone(), units.scene(&def)].map(|def| {
                let scene = built(&def);
                let tape = rollout(&scene, &*solver, scene.initial_state(), 20, |_, _| {
                    vec![0.0; scene.controls().len()]
                });
                let tape = prepared(tape.expect("a run"), SMOOTH);
                let mut seed = StateVector::like(tape.last());
                seed.q[1].x = 1.0;
                let found = gradient(&scene, &tape, |k, _| (k == 20).then(|| seed.clone()));
                let by = found.expect("a gradient").by;
                [Param::Velocity(1, 0), Param::Friction(1), Param::Position(1, 2)]
                    .map(|param| by.by(&scene, param))
            });
            for ((one, other), unit) in one.iter().zip(other).zip([0.125, 1024.0, 1024.0]) {
                near_relative(&def.name, other / unit, *one, 1e-10);
            }
        }
    }
}

/// Jacobians, plans, products and batches take what is prepared.
#[test]
fn every_derivative_of_a_tape_is_smoothed() {
    let scene = built(&pushed_box());
    for solver in backends() {
        let push = |_: usize, _: &State| vec![1.0];
        let tape = rollout(&scene, &*solver, scene.initial_state(), 5, push).expect("a run");
        let (before, record) = (tape.state(4), &tape.records[4]);
        let plain = step_jacobian(&scene, before, record, &[]).expect("a Jacobian");
        let smooth = prepared(tape.clone(), SMOOTH);
        let jacobian = step_jacobian(&scene, before, &smooth.records[4], &[]).expect("a Jacobian");
        assert!((&jacobian.state - &plain.state).amax() > 1e-3);
        let order = Coordinates::of(&scene);
        let zeros = SceneVector::like(&scene);
        for k in 0..order.size() {
            let unit = nalgebra::DVector::from_fn(order.size(), |i, _| f64::from(u8::from(i == k)));
            let state = order.spread(unit.column(0));
            let along = Direction { state: &state, control: &[0.0], scene: &zeros };
            let change = step_jvp(&scene, before, &smooth.records[4], &along).expect("a tangent");
            let off = (jacobian.state.column(k) - order.flatten(&change)).amax();
            near("column of a Jacobian", off, 0.0, 1e-10);
        }
        let dynamics = SceneDynamics::new(&scene, &*solver).with_gradient_mode(SMOOTH);
        let linear = dynamics.linearise(before, record).expect("a linearisation");
        assert_eq!([linear.state, linear.control], [jacobian.state, jacobian.control]);

        let mut seed = StateVector::like(before);
        seed.q[1] = Vector3::x();
        let seeds = vec![ResidualSeed { entry: 0, step: 5, gradient: seed.clone() }];
        let products = GaussNewton::new(&scene, &smooth, 1, seeds).expect("it fits");
        let found = gradient(&scene, &smooth, |k, _| (k == 5).then(|| seed.clone()));
        assert_eq!(products.pull(&[1.0]).expect("a product"), found.expect("a gradient"));
    }
}

#[cfg(feature = "parallel")]
#[test]
fn batches_are_smoothed() {
    use tangency::batch::{Batch, Controls};
    let scene = built(&stuck_box());
    for solver in backends() {
        let tape = rollout(&scene, &*solver, scene.initial_state(), 9, |_, _| vec![2.0]);
        let alone = of_all_states(&scene, &prepared(tape.expect("a run"), SMOOTH));
        let mut batch = Batch::new(scene.clone(), 3, solver);
        batch.set_gradient_mode(SMOOTH);
        let found = batch.value_and_gradient(9, Controls::Held(&[2.0; 3]), |_, k, state, bar| {
            bar.add(&coefficients(k, state));
            0.0
        });
        for one in found.expect("controls that fit").all().expect("gradients") {
            assert_eq!(one.gradient, alone);
        }
    }
}

#[test]
fn wrong_kappas_are_named() {
    let scene = built(&stuck_box());
    let mut tape = rollout(&scene, &*backends()[0], scene.initial_state(), 2, |_, _| vec![1.0])
        .expect("a run");
    let refused = GradientMode::Smoothed { kappa: -1.0 }.prepare(&mut tape).expect_err("refused");
    assert_eq!(
        refused.to_string(),
        "step 0: kappa is -1; give a positive, finite number, such as 1e-4"
    );
}
