//! Products with the Jacobian of a residual over a rollout: against the matrix itself, multiplied out
//! of the Jacobians of the steps.

use nalgebra::{DMatrix, DVector};
use tangency::diff::{
    Coordinates, DiffError, GaussNewton, ResidualSeed, RolloutVector, StateVector, StepJacobian,
    step_jacobian,
};
use tangency::{LcpSolver, Rollout, Scene, SceneDef, rollout};
use tangency_bench::scenes::race_cartpole;

use crate::accurate::accurate;
use crate::engine::{backends, built, near};

const STEPS: usize = 25;
const POLE: usize = 1;

fn play(scene: &Scene, solver: &dyn LcpSolver) -> Rollout {
    let push = |k: usize| 4.0 * (0.3 * k as f64).sin();
    rollout(scene, solver, scene.initial_state(), STEPS, |k, _| vec![push(k)]).expect("a run")
}

/// rₖ = θₖ + 0.1 ωₖ of the pole for every state, and the place of the cart at the end.
fn seeds() -> Vec<ResidualSeed> {
    let mut seeds: Vec<ResidualSeed> = (0..=STEPS)
        .map(|k| {
            let mut gradient = StateVector::zeros(2);
            (gradient.q[POLE].z, gradient.v[POLE].z) = (1.0, 0.1);
            ResidualSeed { entry: k, step: k, gradient }
        })
        .collect();
    let mut gradient = StateVector::zeros(2);
    gradient.q[0].x = 1.0;
    seeds.insert(3, ResidualSeed { entry: STEPS + 1, step: STEPS, gradient });
    seeds
}

/// ∂r/∂u, entries × steps: ∂x_k/∂u_j = A_k−1 … A_j+1 B_j.
fn dense(scene: &Scene, run: &Rollout) -> DMatrix<f64> {
    let coordinates = Coordinates::of(scene);
    let step = |k: usize| step_jacobian(scene, run.state(k), &run.records[k], &[]);
    let steps: Vec<StepJacobian> = (0..STEPS).map(|k| step(k).expect("a Jacobian")).collect();
    let mut all = DMatrix::zeros(STEPS + 2, STEPS);
    for j in 0..STEPS {
        let mut by: DMatrix<f64> = steps[j].control.clone();
        for k in j + 1..=STEPS {
            for seed in seeds().iter().filter(|seed| seed.step == k) {
                let row = coordinates.flatten(&seed.gradient);
                all[(seed.entry, j)] += row.dot(&by.column(0));
            }
            if let Some(step) = steps.get(k) {
                by = &step.state * by;
            }
        }
    }
    all
}

fn along(scene: &Scene, controls: &DVector<f64>) -> RolloutVector {
    let controls = controls.iter().map(|u| vec![*u]).collect();
    RolloutVector { controls, ..RolloutVector::zeros(scene, STEPS) }
}

fn controls(vector: &RolloutVector) -> DVector<f64> {
    DVector::from_iterator(STEPS, vector.controls.iter().map(|u| u[0]))
}

fn wave(n: usize, phase: f64) -> DVector<f64> {
    DVector::from_fn(n, |i, _| (1.7 * i as f64 + phase).sin())
}

#[test]
fn products_with_the_matrix() {
    check_products(&race_cartpole());
}

#[test]
fn products_of_accurate_steps() {
    check_products(&accurate(race_cartpole(), race_cartpole().dt));
}

fn check_products(def: &SceneDef) {
    let scene = built(def);
    for solver in backends() {
        let run = play(&scene, &*solver);
        let jacobian = dense(&scene, &run);
        let products = GaussNewton::new(&scene, &run, STEPS + 2, seeds()).expect("it fits");
        let (d, w) = (wave(STEPS, 0.3), wave(STEPS + 2, 1.1));
        let pushed = DVector::from_vec(products.push(&along(&scene, &d)).expect("forward mode"));
        near("J d", (&jacobian * &d - pushed).amax(), 0.0, 1e-12);
        let pulled = controls(&products.pull(w.as_slice()).expect("reverse mode").by);
        near("Jᵀ w", (jacobian.tr_mul(&w) - pulled).amax(), 0.0, 1e-12);
        let product = controls(&products.product(&along(&scene, &d)).expect("both"));
        near("JᵀJ d", (jacobian.tr_mul(&(&jacobian * &d)) - product).amax(), 0.0, 1e-12);
    }
}

/// d·JᵀJ e = e·JᵀJ d, and d·JᵀJ d = |J d|² ≥ 0, initial states and the scene's numbers included.
#[test]
fn symmetric_and_positive() {
    let scene = built(&race_cartpole());
    for solver in backends() {
        let run = play(&scene, &*solver);
        let products = GaussNewton::new(&scene, &run, STEPS + 2, seeds()).expect("it fits");
        let direction = |phase: f64| {
            let mut all = along(&scene, &wave(STEPS, phase));
            all.initial.v[POLE].z = phase.cos();
            all.scene.bodies[POLE].mass.x = phase.sin();
            all
        };
        let inner = |a: &RolloutVector, b: &RolloutVector| {
            let masses = a.scene.bodies[POLE].mass.x * b.scene.bodies[POLE].mass.x;
            controls(a).dot(&controls(b)) + a.initial.v[POLE].z * b.initial.v[POLE].z + masses
        };
        let (d, e) = (direction(0.4), direction(2.3));
        let [by_d, by_e] = [&d, &e].map(|along| products.product(along).expect("a product"));
        near("symmetry", inner(&e, &by_d), inner(&d, &by_e), 1e-12);
        let pushed: f64 = products.push(&d).expect("forward mode").iter().map(|x| x * x).sum();
        near("d·JᵀJ d", inner(&d, &by_d), pushed, 1e-12);
    }
}

#[test]
fn refusals() {
    let scene = built(&race_cartpole());
    let run = play(&scene, &*backends()[0]);
    let refused = |entry, step, bodies| {
        let seed = ResidualSeed { entry, step, gradient: StateVector::zeros(bodies) };
        GaussNewton::new(&scene, &run, 2, vec![seed]).map(|_| ()).expect_err("it does not fit")
    };
    assert!(matches!(refused(2, 0, 2), DiffError::Index { count: 2, found: 2, .. }));
    assert!(matches!(refused(0, 26, 2), DiffError::Index { count: 26, found: 26, .. }));
    assert!(matches!(refused(0, 0, 3), DiffError::Size { expected: 2, found: 3, .. }));
    let products = GaussNewton::new(&scene, &run, 2, Vec::new()).expect("nothing is seen");
    assert!(matches!(products.pull(&[1.0]), Err(DiffError::Size { expected: 2, found: 1, .. })));
    let not_finite = products.pull(&[1.0, f64::NAN]);
    assert!(matches!(not_finite, Err(DiffError::NotFinite { .. })));
}
