//! Environments that differ, and threads to run them on.

use tangency_batch::Batch;
use tangency_bench::scenes;
use tangency_core::{Scene, SceneDef, State};
use tangency_diff::StateVector;
use tangency_lcp::LcpSolver;
use tangency_lcp_ipm::InteriorPoint;

/// Environments per batch: not a multiple of any number of threads that is tried.
pub(crate) const ENVIRONMENTS: usize = 23;

pub(crate) fn solver() -> Box<dyn LcpSolver> {
    Box::new(InteriorPoint::default())
}

pub(crate) fn built(def: &SceneDef) -> Scene {
    Scene::new(def).expect("a valid scene")
}

/// Scenes with contacts, joints and controls that between them use all paths of a step.
pub(crate) fn busy() -> Vec<Scene> {
    [
        scenes::race_cartpole(),
        scenes::race_stack(3),
        scenes::pyramid(3),
        scenes::compound_tumble(),
        scenes::paper_chain(4, 7.0),
        scenes::piston(),
    ]
    .iter()
    .map(built)
    .collect()
}

/// A number in [−½, ½) that looks random: the golden ratio's multiples modulo 1.
pub(crate) fn scatter(i: usize) -> f64 {
    (i as f64 * 0.618_033_988_749_894_9).fract() - 0.5
}

/// The scene's initial state with other velocities of the dynamic bodies, for an environment.
pub(crate) fn start(scene: &Scene, environment: usize) -> State {
    let mut state = scene.initial_state();
    for (i, v) in state.v.iter_mut().enumerate().filter(|(i, _)| scene.is_dynamic(*i)) {
        v.x += 0.3 * scatter(7 * environment + i);
        v.y += 0.3 * scatter(7 * environment + i + 3);
    }
    state
}

/// A batch in which every environment starts elsewhere.
pub(crate) fn fleet(scene: &Scene) -> Batch {
    let mut batch = Batch::new(scene.clone(), ENVIRONMENTS, solver());
    for i in 0..ENVIRONMENTS {
        batch.reset_to(i, start(scene, i)).expect("a state of the scene");
    }
    batch
}

/// Row-major controls for so many rows of a scene's channels, N.
pub(crate) fn pushes(scene: &Scene, rows: usize) -> Vec<f64> {
    (0..rows * scene.controls().len()).map(|i| 4.0 * scatter(i)).collect()
}

/// A loss that sees every second state: ℓ = ½ Σ x² + Σ ω of all bodies, and its gradient.
pub(crate) fn loss(k: usize, state: &State, bar: &mut StateVector) -> f64 {
    if k % 2 == 1 {
        return 0.0;
    }
    let mut value = 0.0;
    for i in 0..state.q.len() {
        value += 0.5 * state.q[i].x * state.q[i].x + state.v[i].z;
        bar.q[i].x += state.q[i].x;
        bar.v[i].z += 1.0;
    }
    value
}

/// What `work` returns on pools of 1, 2, 4 and 7 threads.
pub(crate) fn on_threads<T: Send>(work: impl Fn() -> T + Sync) -> Vec<(usize, T)> {
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        (threads, pool.expect("a pool of threads").install(&work))
    };
    [1, 2, 4, 7].map(on).into()
}

/// Text with every bit: floats are printed so that they are read back the same, zeros with their sign.
pub(crate) fn bits(value: &impl std::fmt::Debug) -> String {
    format!("{value:?}")
}
