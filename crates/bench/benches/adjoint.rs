//! The paper's chain with one mass per link: forward pass, reverse pass, finite differences.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use tangency::core::{Param, Rollout, Scene, State, simulate};
use tangency::diff::{StateVector, gradient};
use tangency_bench::{finite_difference::derivative, scenes};

const STEPS: usize = 60;

fn final_pose(_: usize, state: &State) -> StateVector {
    let mut seed = StateVector::like(state);
    seed.q.iter_mut().for_each(|q| q.x = 1.0);
    seed
}

fn loss(rollout: &Rollout) -> f64 {
    rollout.last().q.iter().map(|q| q.x).sum()
}

fn forward_and_reverse(criterion: &mut Criterion) {
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

/// Value and gradient of the four scenes of the race, by everything, beside the value alone.
fn race(criterion: &mut Criterion) {
    let solver = tangency::default_solver();
    let mut group = criterion.benchmark_group("race, 200 steps");
    let race = [
        scenes::race_bounce(),
        scenes::race_stack(10),
        scenes::race_chain(10),
        scenes::race_cartpole(),
    ];
    for def in race {
        let scene = Scene::new(&def).expect("a valid scene");
        group.bench_function(BenchmarkId::new("value", &def.name), |bencher| {
            bencher.iter(|| simulate(black_box(&scene), &*solver, 200));
        });
        group.bench_function(BenchmarkId::new("value and gradient", &def.name), |bencher| {
            bencher.iter(|| {
                let tape = simulate(black_box(&scene), &*solver, 200).expect("a run");
                gradient(&scene, &tape, |k, state| (k == 200).then(|| final_pose(k, state)))
            });
        });
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(10)
        .warm_up_time(std::time::Duration::from_millis(200))
        .measurement_time(std::time::Duration::from_millis(800));
    targets = forward_and_reverse, race
}
criterion_main!(benches);
