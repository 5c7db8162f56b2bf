//! Batches: how fast many environments step side by side, and what further threads add.

use std::sync::Arc;

use rayon::ThreadPool;
use tangency_batch::{Batch, Controls};
use tangency_core::lcp::LcpSolver;
use tangency_core::{Scene, SceneDef};

use crate::engine::Refusal;
use crate::scenes;
use crate::timing::{Patience, Quartiles, Work, interleaved, timed};

/// A batch on some threads.
#[derive(Clone, Debug)]
pub struct Throughput {
    /// The scene.
    pub scene: String,
    /// Environments.
    pub environments: usize,
    /// Threads.
    pub threads: usize,
    /// Time per step of one environment, s.
    pub step: Quartiles,
    /// Times faster than on the first pool, per thread that there is more.
    pub efficiency: f64,
}

/// Steps per run.
const STEPS: usize = 20;

/// The scenes that are run in batches.
#[must_use]
pub fn batched_scenes() -> [SceneDef; 3] {
    [scenes::race_cartpole(), scenes::race_chain(10), scenes::race_stack(10)]
}

/// Steps of a batch on each pool of threads, the least pool first; they take turns. Environments begin
/// with different velocities.
///
/// # Errors
/// A [`Refusal`] where the scene, a state or a step is refused.
pub fn measure(
    def: &SceneDef,
    solver: &Arc<dyn LcpSolver>,
    environments: usize,
    pools: &[ThreadPool],
    patience: &Patience,
) -> Result<Vec<Throughput>, Refusal> {
    let scene = Scene::new(def)?;
    let works = pools.iter().map(|pool| {
        let mut batch = Batch::new(scene.clone(), environments, solver.clone());
        let work: Work<'_, Refusal> = Box::new(move || {
            scatter(&mut batch)?;
            let (time, result) = timed(|| pool.install(|| batch.advance(STEPS, Controls::Zero)));
            Ok(result.map(|()| time)?)
        });
        work
    });
    let mut all: Vec<Throughput> = Vec::new();
    for (pool, time) in pools.iter().zip(interleaved(works.collect(), patience)) {
        let step = time?.scaled(1.0 / (environments * STEPS) as f64);
        let (scene, threads) = (def.name.clone(), pool.current_num_threads());
        let first = all.first().map_or((threads, step.least), |one| (one.threads, one.step.least));
        let efficiency = first.1 * first.0 as f64 / (step.least * threads as f64);
        all.push(Throughput { scene, environments, threads, step, efficiency });
    }
    Ok(all)
}

/// Greatest change of a velocity, m/s.
const SPREAD: f64 = 0.1;

/// Puts the environments back, the last body of each a little faster than that of the one before.
fn scatter(batch: &mut Batch) -> Result<(), Refusal> {
    let share = SPREAD / batch.len() as f64;
    for environment in 0..batch.len() {
        let mut state = batch.scene(environment).initial_state();
        state.v.last_mut().into_iter().for_each(|v| v.x += share * environment as f64);
        batch.reset_to(environment, state)?;
    }
    Ok(())
}
