//! Time per step, scene by scene.

mod settings;

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use tangency::core::{Scene, SceneDef, StepScratch, simulate, step};
use tangency_bench::scenes;

fn named() -> Vec<(String, SceneDef)> {
    let mut list = vec![
        ("free flight".into(), scenes::free_flight()),
        ("pendulum".into(), scenes::pendulum(2.5)),
        ("sliding block".into(), scenes::sliding_box(1.0, 0.3, 3.0)),
        ("soft bridge, 10 planks".into(), scenes::soft_bridge(10)),
    ];
    let race = scenes::race_scenes().into_iter();
    list.extend(race.map(|def| (format!("race: {}", def.name), def)));
    for n in [1, 10, 40] {
        list.push((format!("chain of {n}"), scenes::chain(n, 0.2, 0.1)));
        list.push((format!("stack of {n}"), scenes::stack(&vec![1.0; n])));
    }
    list
}

/// One step from the state after a tenth of a second.
fn step_time(criterion: &mut Criterion) {
    let solver = tangency::default_solver();
    let mut group = criterion.benchmark_group("step");
    for (name, def) in named() {
        let scene = Scene::new(&def).expect("a valid scene");
        let state = simulate(&scene, &*solver, 10).expect("ten steps").last().clone();
        let control = vec![0.0; scene.controls().len()];
        let mut scratch = StepScratch::default();
        group.bench_function(name, |bencher| {
            bencher.iter(|| step(&scene, &*solver, black_box(&state), &control, &mut scratch));
        });
    }
}

criterion_group! {
    name = benches;
    config = settings::brief();
    targets = step_time
}
criterion_main!(benches);
