//! What uses steps, in accurate ones: batches, Jacobians of a planner, motions that no law allows.

use nalgebra::Vector3;
use tangency::control::{Dynamics, SceneDynamics};
use tangency::diff::{Coordinates, RolloutVector, step_jacobian, tangent};
use tangency::{
    BodyDef, Gradient, Rollout, Scene, SceneDef, State, StateVector, gradient, rollout,
};
use tangency_bench::scenes::{floor, material, pushed_box, rod, unit_scene};

use super::accurate;
use crate::engine::{backends, built, near, run};
use crate::gradients::loss::coefficients;

const H: f64 = 0.02;

/// The box of 1 kg that slides at 2 m/s, its hand behind it: events are where it stops.
fn sliding() -> SceneDef {
    let mut def = accurate(pushed_box(), H);
    def.bodies[1].velocity = [2.0, 0.0];
    def
}

fn of_all_states(scene: &Scene, tape: &Rollout) -> Gradient {
    gradient(scene, tape, |k, state| Some(coefficients(k, state))).expect("a gradient")
}

/// Every environment has the bits of a run alone, through the end of sliding.
#[cfg(feature = "parallel")]
#[test]
fn batches_have_the_same_bits() {
    use tangency::batch::{Batch, Controls};
    let scene = built(&sliding());
    let pushes = [0.0, 1.0, 2.0];
    for solver in backends() {
        let alone = pushes.map(|push| {
            let tape = rollout(&scene, &*solver, scene.initial_state(), 40, |_, _| vec![push]);
            let tape = tape.expect("a run");
            assert!(tape.records.iter().any(|record| !record.parts.is_empty()));
            assert!(!tape.records.iter().any(tangency::StepRecord::fell_back));
            (tape.last().clone(), of_all_states(&scene, &tape))
        });
        let mut batch = Batch::new(scene.clone(), 3, solver);
        let found = batch.value_and_gradient(40, Controls::Held(&pushes), |_, k, state, bar| {
            bar.add(&coefficients(k, state));
            0.0
        });
        let found = found.expect("controls that fit").all().expect("gradients");
        for (found, (_, exact)) in found.iter().zip(&alone) {
            assert_eq!(found.gradient, *exact);
        }
        batch.advance(40, Controls::Held(&pushes)).expect("steps");
        for (state, (exact, _)) in batch.states().zip(&alone) {
            assert_eq!(state, exact);
        }
    }
}

/// The hand pushes with F for 30 steps (a = (F − μ m g)/(m + M)), then both slide on (−μ m g/(m + M)) and lie still:
/// x = a t²/2 + v²/(2 b), v = a t. Nothing happens there: steps are of one part, and neither motion nor
/// derivatives change.
#[test]
fn what_lies_still_stays_as_it_is() {
    let (force, t, mass, drag) = (5.0, 30.0 * H, 1.5, 0.3 * 9.81);
    let (a, b) = ((force - drag) / mass, drag / mass);
    let by_force = (0.5 * t * t + a * t * t / b) / mass;
    let scene = built(&accurate(pushed_box(), H));
    for solver in backends() {
        let push = |k: usize, _: &State| vec![if k < 30 { force } else { 0.0 }];
        let tape = rollout(&scene, &*solver, scene.initial_state(), 100, push).expect("a run");
        near("x", tape.last().q[1].x, 0.5 * a * t * t + (a * t).powi(2) / (2.0 * b), 1e-12);
        assert!(tape.records[51..].iter().all(|record| record.parts.is_empty()));

        let (x, v) = (0.7, 0.4);
        let mut seed = StateVector::like(tape.last());
        (seed.q[1].x, seed.v[1].x) = (x, v);
        let last = |k: usize, _: &State| (k == 100).then(|| seed.clone());
        let back = gradient(&scene, &tape, last).expect("a gradient").by;
        let mut along = RolloutVector::zeros(&scene, 100);
        along.controls[..30].iter_mut().for_each(|u| u[0] = 1.0);
        let ahead = tangent(&scene, &tape, &along).expect("a tangent");
        near("∂x/∂F", ahead[100].q[1].x, by_force, 1e-12);
        near("∂v/∂F", ahead[100].v[1].x, 0.0, 1e-12);
        let sum: f64 = back.controls[..30].iter().map(|u| u[0]).sum();
        near("backwards", sum, x * by_force, 1e-12);
    }
}

/// Steps of the box at rest, 0.1 m before its hand, the first one and one after it: poses stay; a box that had a
/// speed v would slide on for v²/(2 μ g) alone and stop, so that neither place nor speed depends on it at v = 0.
#[test]
fn a_box_at_rest_has_the_closed_form() {
    let mut def = accurate(pushed_box(), H);
    def.bodies[1].position[0] = 0.1;
    let scene = built(&def);
    let order = Coordinates::of(&scene);
    let place = |body| order.pose(body, 0).expect("a dynamic body");
    let speed = |body| order.velocity(body, 0).expect("a dynamic body");
    for solver in backends() {
        let tape = rollout(&scene, &*solver, scene.initial_state(), 2, |_, _| vec![0.0]);
        let tape = tape.expect("a run");
        for (before, record) in tape.states().zip(&tape.records) {
            let by = step_jacobian(&scene, before, record, &[]).expect("a Jacobian");
            for (to, from, exact) in [
                (place(1), place(1), 1.0),
                (place(1), speed(1), 0.0),
                (speed(1), place(1), 0.0),
                (speed(1), speed(1), 0.0),
                (place(1), speed(2), 0.0),
                (place(2), speed(2), H),
                (speed(2), speed(2), 1.0),
            ] {
                near("∂state", by.state[(to, from)], exact, 1e-12);
            }
            near("∂v/∂u", by.control[(speed(2), 0)], 2.0 * H, 1e-12);
            near("∂v/∂u of the box", by.control[(speed(1), 0)], 0.0, 1e-12);
        }
    }
}

/// One step of the sliding box, 0.1 m before its hand: x⁺ = x + v h − μ g h²/2, v⁺ = v − μ g h, and of the
/// hand x⁺ = x + v h + u h²/(2 m), v⁺ = v + u h/m. With a speed w downwards its impact takes μ w of v.
#[test]
fn a_planner_gets_the_closed_form() {
    let mut def = sliding();
    def.bodies[1].position[0] = 0.1;
    let scene = built(&def);
    for solver in backends() {
        let mut dynamics = SceneDynamics::new(&scene, &*solver);
        let state = scene.initial_state();
        let step = dynamics.step(&state, None, &[3.0]).expect("a step");
        let after = &step.after;
        near("x", after.q[1].x, 0.1 + 2.0 * H - 0.15 * 9.81 * H * H, 1e-13);
        near("v", after.v[1].x, 2.0 - 0.3 * 9.81 * H, 1e-13);
        let linear = dynamics.linearise(&state, &step).expect("a Jacobian");
        let order = dynamics.order();
        let place = |body| order.pose(body, 0).expect("a dynamic body");
        let speed = |body| order.velocity(body, 0).expect("a dynamic body");
        let down = order.velocity(1, 1).expect("a dynamic body");
        for (to, from, exact) in [
            (place(1), place(1), 1.0),
            (place(1), speed(1), H),
            (speed(1), speed(1), 1.0),
            (speed(1), place(1), 0.0),
            (speed(1), down, 0.3),
            (place(1), down, 0.3 * H),
            (place(2), speed(2), H),
            (speed(1), speed(2), 0.0),
        ] {
            near("∂state", linear.state[(to, from)], exact, 1e-12);
        }
        near("∂x/∂u", linear.control[(place(2), 0)], H * H, 1e-13);
        near("∂v/∂u", linear.control[(speed(2), 0)], 2.0 * H, 1e-13);
        near("∂v/∂u of the box", linear.control[(speed(1), 0)], 0.0, 1e-13);
    }
}

/// Painlevé's rod (2 m, 1 kg, μ = 2), 60 degrees steep and pushed into the floor by sliding: with
/// `1 + 3 cos²θ − 3 μ sin θ cos θ < 0` no acceleration obeys all laws. The rest of such a step is one of fixed
/// length, its record says so, and so does the report of a gradient.
#[test]
fn a_rod_that_no_law_allows_falls_back() {
    let (sin, cos) = 60.0_f64.to_radians().sin_cos();
    assert!(1.0 + 3.0 * cos * cos - 6.0 * sin * cos < 0.0);
    let radius = 1e-3;
    let ends = tangency::Shape::Capsule { a: [-1.0, 0.0], b: [1.0, 0.0], radius };
    for solver in backends() {
        for (speed, falls) in [(-2.0, true), (2.0, false)] {
            let stick = BodyDef {
                velocity: [speed, 0.0],
                shapes: vec![ends.clone()],
                ..rod("rod", 2.0, 1.0, [cos, sin + radius], 60.0_f64.to_radians())
            };
            let def = unit_scene("Painlevé's rod", vec![floor(), stick]);
            let gravity = [0.0, -9.81];
            let scene = built(&accurate(material(SceneDef { gravity, ..def }, 2.0, 0.0), 0.01));
            let tape = run(&scene, &*solver, 5);
            let fell = |k: &usize| tape.records[*k].fell_back();
            let fell: Vec<usize> = (0..5).filter(fell).collect();
            assert_eq!(fell.contains(&0), falls, "{speed} m/s: {fell:?}");
            for state in tape.states() {
                let foot = state.q[1].y - state.q[1].z.sin() - radius;
                assert!(foot > -1e-6, "{foot}");
                assert!(energy(state) <= energy(&tape.initial) * (1.0 + 1e-9), "{speed} m/s");
            }
            let found = of_all_states(&scene, &tape);
            assert_eq!(found.report.fell_back, fell);
            let by: &StateVector = &found.by.initial;
            assert!(by.q.iter().chain(&by.v).flatten().all(|x| x.is_finite()));
        }
    }
}

/// Of the rod, J.
fn energy(state: &State) -> f64 {
    let (q, v): (&Vector3<f64>, &Vector3<f64>) = (&state.q[1], &state.v[1]);
    0.5 * (v.xy().norm_squared() + v.z * v.z / 3.0) + 9.81 * q.y
}
