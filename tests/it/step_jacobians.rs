//! Jacobians of single steps: against closed forms, against forward and reverse mode column by column
//! and row by row, against differences, and multiplied along a run.

use nalgebra::{DMatrix, DVector, Vector3};
use tangency::diff::{
    Coordinates, Direction, GradientReport, Parameter, RolloutVector, SceneVector, StateVector,
    StepJacobian, step_jacobian, step_jvp, step_vjp, tangent,
};
use tangency::{
    BodyDef, ControlDef, ControlInput, JointDef, JointKind, LcpSolver, Limits, Param, Rollout,
    Scene, State, StepRecord, StepScratch, rollout, step,
};
use tangency_bench::finite_difference::derivative;
use tangency_bench::scenes::{conveyor, disc, pendulum, race_cartpole, unit_scene};

use crate::engine::{backends, built, first_step, near};
use crate::gradients::battery::{Entry, battery};
use crate::gradients::numbers::{controls, numbers};

/// Steps of a run at which Jacobians are looked at.
fn moments(steps: usize) -> [usize; 3] {
    [0, steps / 2, steps - 1]
}

fn play(scene: &Scene, solver: &dyn LcpSolver, steps: usize) -> Rollout {
    let controls = controls(scene.controls().len(), steps);
    rollout(scene, solver, scene.initial_state(), steps, |k, _| controls[k].clone())
        .unwrap_or_else(|error| panic!("{}: {error}", scene.def().name))
}

/// One parameter per number of the scene.
fn parameters(scene: &Scene) -> Vec<Parameter> {
    let of = |param: Param| Parameter { name: format!("{param:?}"), targets: vec![(param, 1.0)] };
    numbers(scene).into_iter().map(of).collect()
}

#[track_caller]
fn jacobian(scene: &Scene, before: &State, record: &StepRecord) -> StepJacobian {
    step_jacobian(scene, before, record, &parameters(scene))
        .unwrap_or_else(|error| panic!("{}: {error}", scene.def().name))
}

/// Every number of `found` against `exact`, relative to the greatest of them.
#[track_caller]
fn close(what: &str, found: &DMatrix<f64>, exact: &DMatrix<f64>, tolerance: f64) {
    assert_eq!(found.shape(), exact.shape(), "{what}");
    let off = (found - exact).amax();
    assert!(off <= tolerance * exact.amax().max(1.0), "{what}: off by {off:e}\n{found}{exact}");
}

/// Hinges 10⁻⁸ of a length apart amplify rounding by 10⁸.
fn rounding(scene: &Scene) -> f64 {
    if scene.def().name == "misfit hinges" { 1e-8 } else { 1e-12 }
}

/// v⁺ = v + dt g, q⁺ = q + dt v⁺, dt = 0.01; a force of 1 N for a step is dt/m.
#[test]
fn free_flight() {
    let stone = BodyDef { mass: Some(2.0), ..disc("stone", 0.1, [0.0; 2]) };
    let input = ControlInput::ForceX { body: "stone".into() };
    let mut def = unit_scene("free flight", vec![stone]);
    def.controls = vec![ControlDef { name: "push".into(), input }];
    let scene = built(&def);
    for solver in backends() {
        let run = play(&scene, &*solver, 1);
        let found = jacobian(&scene, &run.initial, &run.records[0]);
        let mut exact = DMatrix::identity(6, 6);
        (0..3).for_each(|axis| exact[(axis, 3 + axis)] = 0.01);
        close("A", &found.state, &exact, 1e-16);
        let push = DMatrix::from_column_slice(6, 1, &[5e-5, 0.0, 0.0, 5e-3, 0.0, 0.0]);
        close("B", &found.control, &push, 1e-16);
    }
}

/// A pendulum turned about its pin by dα keeps to it: the tangent of its circle is mapped to that of
/// the next, by the derivative of the step in its angle alone,
///
/// ```text
///  ω⁺ = ω − dt (3 g / 2 L) sin α        α⁺ = α + dt ω⁺           (rod of L = 1 m, at rest)
/// ```
///
/// which the step of a rod obeys at rest: the pin's error at the end of the step is of second order
/// in ω, and ω = 0.
#[test]
fn pendulum_at_rest() {
    let alpha = 0.7_f64;
    let scene = built(&pendulum(alpha));
    let dt = scene.dt();
    for solver in backends() {
        let record = first_step(&scene, &*solver);
        let found = jacobian(&scene, &scene.initial_state(), &record);
        // The rod's centre at ½ (sin α, −cos α); α turns with the rod.
        let along = [0.5 * alpha.cos(), 0.5 * alpha.sin(), 1.0];
        let turned = DVector::from_iterator(6, along.into_iter().chain([0.0; 3]));
        let change = &found.state * turned;
        let rate = -dt * 1.5 * 9.81 * alpha.cos();
        near("change of ω", change[5], rate, 1e-12);
        near("change of θ", change[2], 1.0 + dt * rate, 1e-12);
    }
}

/// Two bodies on a slider that turns with the first; a control pushes them apart, so that the direction
/// of its force depends on poses.
fn slider() -> Entry {
    let [a, b] = [("a", 0.0), ("b", 0.5)].map(|(name, x)| BodyDef {
        angular_velocity: 1.5,
        mass: Some(1.0 + x),
        ..disc(name, 0.1, [x, 0.3 * x])
    });
    let (limits, motor) = (Limits::default(), None);
    let kind = JointKind::Prismatic { anchor: [0.2, 0.1], axis: [1.0, 0.4], limits, motor };
    let bodies = ["a".into(), "b".into()];
    let rail = JointDef { name: "rail".into(), bodies, kind, collide: false, softness: None };
    let mut def = unit_scene("slider", vec![a, b]);
    def.joints = vec![rail];
    let input = ControlInput::JointForce { joint: "rail".into() };
    def.controls = vec![ControlDef { name: "apart".into(), input }];
    Entry { def, steps: 10, except: Vec::new() }
}

/// Columns are JVPs, rows are VJPs.
#[test]
fn columns_and_rows() {
    for solver in backends() {
        for Entry { def, steps, .. } in battery().into_iter().chain([slider()]) {
            let scene = built(&def);
            let run = play(&scene, &*solver, steps);
            for k in moments(steps) {
                let (before, record) = (run.state(k), &run.records[k]);
                let found = jacobian(&scene, before, record);
                let what = format!("{}, step {k}", def.name);
                check_columns(&what, &scene, before, record, &found);
                check_rows(&what, &scene, before, record, &found);
            }
        }
    }
}

fn check_columns(
    what: &str,
    scene: &Scene,
    before: &State,
    record: &StepRecord,
    found: &StepJacobian,
) {
    let (coordinates, channels) = (Coordinates::of(scene), scene.controls().len());
    let column = |x: usize, u: usize, numbers: &SceneVector| {
        let mut unit = DVector::zeros(coordinates.size());
        unit.iter_mut().skip(x).take(1).for_each(|x| *x = 1.0);
        let mut control = vec![0.0; channels];
        control.iter_mut().skip(u).take(1).for_each(|u| *u = 1.0);
        let state = &coordinates.spread(unit.as_view());
        let along = Direction { state, control: &control, scene: numbers };
        coordinates.flatten(&step_jvp(scene, before, record, &along).expect("forward mode"))
    };
    let (none, still) = (usize::MAX, SceneVector::like(scene));
    let by_state: Vec<_> = (0..coordinates.size()).map(|x| column(x, none, &still)).collect();
    close(what, &found.state, &DMatrix::from_columns(&by_state), rounding(scene));
    for u in 0..channels {
        let exact = DMatrix::from_columns(&[column(none, u, &still)]);
        close(what, &found.control.columns(u, 1).into(), &exact, rounding(scene));
    }
    for (p, parameter) in parameters(scene).iter().enumerate() {
        let numbers = parameter.direction(scene, 0).scene;
        let exact = DMatrix::from_columns(&[column(none, none, &numbers)]);
        close(what, &found.parameters.columns(p, 1).into(), &exact, rounding(scene));
    }
}

fn check_rows(
    what: &str,
    scene: &Scene,
    before: &State,
    record: &StepRecord,
    found: &StepJacobian,
) {
    let coordinates = Coordinates::of(scene);
    let all = parameters(scene);
    let mut exact = found.clone();
    for row in 0..coordinates.size() {
        let mut unit = DVector::zeros(coordinates.size());
        unit[row] = 1.0;
        let seed = coordinates.spread(unit.as_view());
        let mut by = RolloutVector::zeros(scene, 1);
        let (controls, numbers) = (&mut by.controls[0], &mut by.scene);
        let mut report = GradientReport::default();
        let pulled = step_vjp(scene, before, record, &seed, controls, numbers, &mut report);
        let state = coordinates.flatten(&pulled.expect("reverse mode"));
        exact.state.row_mut(row).copy_from(&state.transpose());
        by.controls[0].iter().enumerate().for_each(|(u, x)| exact.control[(row, u)] = *x);
        for (p, parameter) in all.iter().enumerate() {
            exact.parameters[(row, p)] = parameter.gradient(scene, &by);
        }
    }
    close(what, &found.state, &exact.state, rounding(scene));
    close(what, &found.control, &exact.control, rounding(scene));
    close(what, &found.parameters, &exact.parameters, 10.0 * rounding(scene));
}

/// A and B of the cartpole against differences of the step itself, pushed and moving.
#[test]
fn differences() {
    let scene = built(&race_cartpole());
    let coordinates = Coordinates::of(&scene);
    for solver in backends() {
        let run =
            rollout(&scene, &*solver, scene.initial_state(), 40, |_, _| vec![3.0]).expect("a run");
        let (before, record) = (run.state(39), &run.records[39]);
        let found = jacobian(&scene, before, record);
        let after = |state: &State, u: f64| {
            let taken = step(&scene, &*solver, state, &[u], &mut StepScratch::default());
            coordinates.of_state(&taken.expect("a step").after)
        };
        for row in 0..coordinates.size() {
            for column in 0..coordinates.size() {
                let moved = |x: f64| {
                    let mut state = before.clone();
                    let (body, axis) = ((column % 6) / 3, column % 3);
                    let list = if column < 6 { &mut state.q } else { &mut state.v };
                    list[body][axis] += x;
                    after(&state, 3.0)[row]
                };
                let exact = derivative(moved, 0.0, 1e-2).value;
                near(&format!("A[{row}, {column}]"), found.state[(row, column)], exact, 1e-9);
            }
            let exact = derivative(|u| after(before, u)[row], 3.0, 1e-2).value;
            near(&format!("B[{row}]"), found.control[(row, 0)], exact, 1e-10);
        }
    }
}

/// The product of the Jacobians of two steps is the derivative of both, and a control of the first
/// reaches the end through the second.
#[test]
fn two_steps() {
    for solver in backends() {
        for Entry { def, .. } in battery() {
            let scene = built(&def);
            let run = play(&scene, &*solver, 2);
            let coordinates = Coordinates::of(&scene);
            let [one, two] = [0, 1].map(|k| jacobian(&scene, run.state(k), &run.records[k]));
            let end = |along: &RolloutVector| {
                let changes = tangent(&scene, &run, along).expect("forward mode");
                DMatrix::from_columns(&[coordinates.flatten(&changes[2])])
            };
            let both = &two.state * &one.state;
            for column in 0..coordinates.size() {
                let mut along = RolloutVector::zeros(&scene, 2);
                let mut unit = DVector::zeros(coordinates.size());
                unit[column] = 1.0;
                along.initial = coordinates.spread(unit.as_view());
                close(&def.name, &both.columns(column, 1).into(), &end(&along), rounding(&scene));
            }
            for u in 0..scene.controls().len() {
                let mut along = RolloutVector::zeros(&scene, 2);
                along.controls[0][u] = 1.0;
                let found = &two.state * one.control.columns(u, 1);
                close(&def.name, &found, &end(&along), rounding(&scene));
            }
        }
    }
}

/// A record that has lost its factorisations is factored again.
#[test]
fn without_factorisations() {
    for solver in backends() {
        for Entry { def, .. } in battery() {
            let scene = built(&def);
            let run = play(&scene, &*solver, 1);
            let mut bare = run.records[0].clone();
            StepScratch::default().recycle_systems(&mut bare);
            let kept = jacobian(&scene, &run.initial, &run.records[0]);
            let again = jacobian(&scene, &run.initial, &bare);
            let rounding = rounding(&scene);
            close(&def.name, &again.state, &kept.state, rounding);
            close(&def.name, &again.parameters, &kept.parameters, rounding);
        }
    }
}

/// What coordinates are taken apart into comes together again.
#[test]
fn coordinates_of_dynamic_bodies() {
    let scene = built(&conveyor());
    let coordinates = Coordinates::of(&scene);
    assert_eq!(coordinates.bodies(), [1]); // the belt is driven
    assert_eq!((coordinates.pose(1, 2), coordinates.velocity(1, 0)), (Some(2), Some(3)));
    assert_eq!((coordinates.pose(0, 0), coordinates.pose(1, 3)), (None, None));
    let vector = StateVector {
        time: 0.0,
        q: vec![Vector3::zeros(), Vector3::new(1.0, 2.0, 3.0)],
        v: vec![Vector3::zeros(), Vector3::new(4.0, 5.0, 6.0)],
    };
    let flat = coordinates.flatten(&vector);
    assert_eq!(flat.as_slice(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(coordinates.spread(flat.as_view()), vector);
}
