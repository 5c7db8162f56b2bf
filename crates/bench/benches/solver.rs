//! The solver alone, on problems recorded from runs.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use tangency::core::lcp::{Lcp, Scratch};
use tangency::core::{Path, Scene, SceneDef, simulate};
use tangency::lcp_ipm::InteriorPoint;
use tangency::{LcpSolver, read_scene};
use tangency_bench::scenes;

/// The largest complementarity problem of a run.
fn recorded(def: &SceneDef, steps: usize) -> Lcp {
    let scene = Scene::new(def).expect("a valid scene");
    let run = simulate(&scene, &*tangency::default_solver(), steps).expect("a run");
    let islands = run.records.into_iter().flat_map(|record| record.islands);
    let hard = islands.filter(|island| island.path == Path::Complementarity);
    hard.map(|island| island.problem)
        .max_by_key(|problem| problem.rows.len())
        .expect("a step with contacts")
}

/// The same of a shipped scene.
fn shipped(name: &str, steps: usize) -> Lcp {
    let file = format!("{}/../../scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    recorded(&read_scene(file).expect("a scene file"), steps)
}

/// The shipped solvers, and the interior point without modes read at the free velocities.
fn candidates() -> Vec<(&'static str, Box<dyn LcpSolver>)> {
    let alone = InteriorPoint { cold_modes: false, ..InteriorPoint::default() };
    let shipped = tangency::solvers().into_iter().map(|solver| (solver.name(), solver));
    let mut all: Vec<(&'static str, Box<dyn LcpSolver>)> = shipped.collect();
    all.push(("interior point alone", Box::new(alone)));
    all
}

fn solve_time(criterion: &mut Criterion) {
    let problems = [
        ("sliding block", recorded(&scenes::sliding_box(1.0, 0.3, 3.0), 5)),
        ("box on 10 points", recorded(&scenes::redundant_floor(10), 5)),
        ("stack of 10", recorded(&scenes::stack(&[1.0; 10]), 5)),
        ("bridge of 10", recorded(&scenes::soft_bridge(10), 30)),
        ("chain of 10 struck", recorded(&scenes::hanging_chain_hit(), 5)),
        ("pyramid of 55", recorded(&scenes::pyramid(10), 5)),
        ("ragdoll", shipped("ragdoll", 500)),
        ("wrecking ball", shipped("wrecking_ball", 500)),
    ];
    for (solver_name, solver) in candidates() {
        let mut group = criterion.benchmark_group(solver_name);
        for (name, problem) in &problems {
            let mut scratch = Scratch::default();
            group.bench_function(*name, |bencher| {
                bencher.iter(|| {
                    let found = solver.solve(black_box(problem), None, &mut scratch);
                    found.map(|solution| scratch.recycle(solution))
                });
            });
        }
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(20)
        .warm_up_time(std::time::Duration::from_millis(200))
        .measurement_time(std::time::Duration::from_millis(800));
    targets = solve_time
}
criterion_main!(benches);
