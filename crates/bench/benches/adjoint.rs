//! What a gradient costs beside the run that it is of: the scenes of the races, and the paper's chain
//! with one mass per link, against finite differences.

mod settings;

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use tangency::core::{Param, Rollout, Scene, State, simulate};
use tangency::diff::{StateVector, gradient, gradient_adding};
use tangency_bench::{finite_difference::derivative, scenes};

const STEPS: usize = 60;
const RACE_STEPS: usize = 200;

fn final_pose(_: usize, state: &State) -> StateVector {
    let mut seed = StateVector::like(state);
    seed.q.iter_mut().for_each(|q| q.x = 1.0);
    seed
}

fn loss(rollout: &Rollout) -> f64 {
    rollout.last().q.iter().map(|q| q.x).sum()
}

/// Value, and gradient by all numbers of the scene, all controls and the initial state; the loss sees
/// every state.
fn races(criterion: &mut Criterion) {
    let solver = tangency::default_solver();
    let mut group = criterion.benchmark_group("race scenes, 200 steps");
    for def in scenes::race_scenes() {
        let scene = Scene::new(&def).expect("a valid scene");
        let tape = simulate(&scene, &*solver, RACE_STEPS).expect("a run");
        group.bench_function(BenchmarkId::new("forward", &def.name), |bencher| {
            bencher.iter(|| simulate(black_box(&scene), &*solver, RACE_STEPS));
        });
        group.bench_function(BenchmarkId::new("reverse", &def.name), |bencher| {
            bencher.iter(|| {
                gradient_adding(&scene, black_box(&tape), |_, _, bar| {
                    bar.q.iter_mut().for_each(|q| q.x += 1.0);
                })
            });
        });
    }
}

fn paper_chain(criterion: &mut Criterion) {
    let solver = tangency::default_solver();
    let mut group = criterion.benchmark_group("paper chain, 60 steps");
    for n in [1, 2, 5, 10, 20, 40] {
        let scene = Scene::new(&scenes::paper_chain(n, 7.0)).expect("a valid scene");
        let tape = simulate(&scene, &*solver, STEPS).expect("a run");
        group.bench_function(BenchmarkId::new("forward", n), |bencher| {
            bencher.iter(|| simulate(black_box(&scene), &*solver, STEPS));
        });
        group.bench_function(BenchmarkId::new("reverse", n), |bencher| {
            bencher.iter(|| {
                gradient(&scene, black_box(&tape), |k, state| {
                    (k == STEPS).then(|| final_pose(k, state))
                })
            });
        });
    }
    for n in [1, 2, 5] {
        let scene = Scene::new(&scenes::paper_chain(n, 7.0)).expect("a valid scene");
        group.bench_function(BenchmarkId::new("finite differences", n), |bencher| {
            bencher.iter(|| {
                let by_mass = |link: usize| {
                    let mut changed = scene.clone();
                    let at = |mass: f64| {
                        changed.set(Param::Mass(link), mass).expect("a positive mass");
                        loss(&simulate(&changed, &*solver, STEPS).expect("a run"))
                    };
                    derivative(at, 7.0 / n as f64, 1e-3).value
                };
                (0..n).map(by_mass).collect::<Vec<f64>>()
            });
        });
    }
}

criterion_group! {
    name = benches;
    config = settings::brief();
    targets = races, paper_chain
}
criterion_main!(benches);
