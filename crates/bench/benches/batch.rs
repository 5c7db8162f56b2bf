//! Time of a batch, on one thread and on all.

mod settings;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use rayon::ThreadPool;
use tangency::batch::{Batch, Controls};
use tangency::core::{Scene, State};
use tangency::diff::StateVector;
use tangency_bench::scenes;

const STEPS: usize = 10;
const ROLLOUT: usize = 100;

fn cartpoles(environments: usize) -> Batch {
    let scene = Scene::new(&scenes::race_cartpole()).expect("a valid scene");
    Batch::new(scene, environments, tangency::default_solver())
}

fn pools() -> Vec<ThreadPool> {
    let all = std::thread::available_parallelism().map_or(1, usize::from);
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let mut sizes = vec![1, all];
    sizes.dedup();
    sizes.into_iter().map(|threads| pool(threads).expect("a pool of threads")).collect()
}

/// Ten steps of 1,024 cart-poles.
fn steps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("batch, 1024 cartpoles, 10 steps");
    group.throughput(Throughput::Elements(1024 * STEPS as u64));
    for pool in pools() {
        let mut batch = cartpoles(1024);
        let id = BenchmarkId::new("threads", pool.current_num_threads());
        group.bench_function(id, |bencher| {
            bencher.iter(|| pool.install(|| batch.advance(STEPS, Controls::Zero)));
        });
    }
}

/// The angle of the pole at the end of the rollout.
fn last_angle(_: usize, k: usize, state: &State, bar: &mut StateVector) -> f64 {
    if k < ROLLOUT {
        return 0.0;
    }
    bar.q[1].z += 1.0;
    state.q[1].z
}

/// Rollouts of 64 cart-poles, with the gradient of where each pole ends.
fn gradients(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("batch, 64 cartpoles, 100 steps and gradient");
    group.throughput(Throughput::Elements(64 * ROLLOUT as u64));
    for pool in pools() {
        let batch = cartpoles(64);
        let id = BenchmarkId::new("threads", pool.current_num_threads());
        let work = || batch.value_and_gradient(ROLLOUT, Controls::Zero, last_angle);
        group.bench_function(id, |bencher| bencher.iter(|| pool.install(work)));
    }
}

criterion_group! {
    name = benches;
    config = settings::brief();
    targets = steps, gradients
}
criterion_main!(benches);
