//! What do more threads bring to a batch?
//!
//! For three scenes and 1,024 environments: environment steps per second on 1, 2, 4, … threads, and the
//! efficiency, which is the rate over that of as many times one thread. All numbers of threads take
//! turns, and the best of many short turns counts. An argument changes the number of turns.

#![expect(clippy::print_stdout, reason = "an example prints what it found")]

use std::time::Instant;

use rayon::ThreadPool;
use tangency::batch::{Batch, Controls};
use tangency::{Scene, SceneDef, default_solver};
use tangency_bench::scenes;

const ENVIRONMENTS: usize = 1024;

/// What is timed.
#[derive(Clone, Copy)]
enum Work {
    /// So many calls of one step each.
    Steps(usize),
    /// One call of so many steps.
    Advance(usize),
    /// A rollout of so many steps, and its gradient.
    Gradient(usize),
}

impl Work {
    fn steps(self) -> usize {
        let (Self::Steps(n) | Self::Advance(n) | Self::Gradient(n)) = self;
        n
    }

    fn of(self, batch: &mut Batch) {
        let controls = vec![0.0; batch.len() * batch.channels()];
        match self {
            Self::Steps(n) => (0..n).for_each(|_| batch.step(&controls).expect("all step")),
            Self::Advance(n) => {
                batch.advance(n, Controls::Held(&controls)).expect("all advance");
            }
            Self::Gradient(n) => {
                let loss =
                    |_, k: usize, state: &tangency::State, bar: &mut tangency::StateVector| {
                        bar.q[1].x += f64::from(u8::from(k == n));
                        if k == n { state.q[1].x } else { 0.0 }
                    };
                let outcomes = batch.value_and_gradient(n, Controls::Held(&controls), loss);
                outcomes.expect("controls that fit").all().expect("all gradients");
            }
        }
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let turns = std::env::args().nth(1).map_or(Ok(20), |turns| turns.parse())?;
    let cores = std::thread::available_parallelism()?.get();
    let sizes: Vec<usize> =
        std::iter::successors(Some(1), |n| Some(2 * n).filter(|n| *n <= cores)).collect();
    let pool = |threads: &usize| rayon::ThreadPoolBuilder::new().num_threads(*threads).build();
    let pools: Vec<ThreadPool> = sizes.iter().map(pool).collect::<Result<_, _>>()?;
    println!(
        "{:12} {:16} {:>8} {:>14} {:>10}",
        "scene", "work", "threads", "steps/s", "efficiency"
    );
    for def in [scenes::race_cartpole(), scenes::race_chain(10), scenes::race_stack(10)] {
        for (work, name) in [
            (Work::Steps(10), "10 × 1 step"),
            (Work::Advance(10), "10 steps"),
            (Work::Gradient(20), "20 + gradient"),
        ] {
            let rates = rates(&def, work, &pools, turns)?;
            for (threads, rate) in sizes.iter().zip(&rates) {
                let efficiency = 100.0 * rate / (*threads as f64 * rates[0]);
                println!("{:12} {name:16} {threads:8} {rate:14.0} {efficiency:8.1} %", def.name);
            }
        }
    }
    Ok(())
}

/// The best rate of each pool, environment steps per second.
fn rates(
    def: &SceneDef,
    work: Work,
    pools: &[ThreadPool],
    turns: usize,
) -> Result<Vec<f64>, Box<dyn std::error::Error>> {
    let mut best = vec![0.0_f64; pools.len()];
    let mut batches = Vec::new();
    for _ in pools {
        let mut batch = Batch::new(Scene::new(def)?, ENVIRONMENTS, default_solver());
        work.of(&mut batch);
        batches.push(batch);
    }
    for _ in 0..turns {
        for ((pool, batch), best) in pools.iter().zip(&mut batches).zip(&mut best) {
            let begin = Instant::now();
            pool.install(|| work.of(batch));
            let rate = (ENVIRONMENTS * work.steps()) as f64 / begin.elapsed().as_secs_f64();
            *best = best.max(rate);
        }
    }
    Ok(best)
}
