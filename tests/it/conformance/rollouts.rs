//! Gradients of whole rollouts, backend against backend.

use tangency::diff::gradient;
use tangency::{LcpSolver, Param, State, rollout};

use crate::engine::{backends, built};
use crate::gradients::battery::battery;
use crate::gradients::loss::coefficients;
use crate::gradients::numbers::{controls, numbers};

/// The gradient by every number and control of a scene.
fn by_all(
    entry: &crate::gradients::battery::Entry,
    solver: &dyn LcpSolver,
) -> (Vec<Param>, Vec<f64>) {
    let scene = built(&entry.def);
    let controls = controls(scene.controls().len(), entry.steps);
    let control = |k: usize, _: &State| controls[k].clone();
    let tape = rollout(&scene, solver, scene.initial_state(), controls.len(), control)
        .unwrap_or_else(|error| panic!("{}, {}: {error}", entry.def.name, solver.name()));
    let by = gradient(&scene, &tape, |k, state| Some(coefficients(k, state)))
        .unwrap_or_else(|error| panic!("{}, {}: {error}", entry.def.name, solver.name()))
        .by;
    let mut params = numbers(&scene);
    params.retain(|param| !entry.except.contains(param));
    let mut all: Vec<f64> = params.iter().map(|&param| by.by(&scene, param)).collect();
    all.extend(by.controls.iter().flatten());
    (params, all)
}

#[test]
fn gradients_of_whole_rollouts_agree() {
    let solvers = backends();
    for entry in battery() {
        let (params, reference) = by_all(&entry, &*solvers[0]);
        let size = reference.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
        for solver in &solvers[1..] {
            let (_, found) = by_all(&entry, &**solver);
            for (i, (a, b)) in reference.iter().zip(&found).enumerate() {
                let (name, param) = (&entry.def.name, params.get(i));
                assert!(
                    (a - b).abs() <= 1e-8 * size,
                    "{name}, {}: {a} and {b} by {param:?}",
                    solver.name()
                );
            }
        }
    }
}
