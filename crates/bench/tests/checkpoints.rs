//! Memory of a run of which few records are kept, in a process in which nothing else runs.

use tangency::{Scene, checkpointed_rollout, default_solver, simulate};
use tangency_bench::memory::per_copy;
use tangency_bench::scenes::chain;

const STEPS: usize = 1024;

/// 31 records instead of 1024, and the controls, of which the chain has none.
#[test]
fn few_records_take_little() {
    let (solver, scene) = (default_solver(), Scene::new(&chain(10, 0.3, 0.2)).expect("a scene"));
    let sparse = per_copy(16, || {
        let initial = scene.initial_state();
        checkpointed_rollout(&scene, &*solver, initial, STEPS, |_, _| Vec::new())
    });
    let full = per_copy(4, || simulate(&scene, &*solver, STEPS));
    if let Some((sparse, full)) = sparse.expect("a run").zip(full.expect("a run")) {
        assert!(sparse < full / 8.0, "{sparse} bytes, all records {full}");
    }
}
