//! What is measured, and how long.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use core_affinity::CoreId;
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use tangency::solvers_at;
use tangency_bench::recorded::Candidate;
use tangency_bench::timing::Patience;

use super::{Arguments, Part};

/// What is measured, and how long.
pub(super) struct Plan {
    parts: Vec<Part>,
    pub(super) quick: bool,
    pub(super) scenes: PathBuf,
    /// Of times per step.
    pub(super) patience: Patience,
    /// Of runs over the time step.
    pub(super) sweep: Patience,
    /// Of sizes.
    pub(super) growth: Patience,
    pub(super) longest_chain: usize,
    pub(super) most_rows: usize,
    /// Halvings of dt from 1/30 s.
    pub(super) halvings: i32,
    /// Base of the pyramid in the sweep.
    pub(super) base: usize,
    /// Most differences that a gradient is compared with.
    pub(super) differences: usize,
    /// Sizes of batches.
    pub(super) environments: &'static [usize],
    /// Steps of every scene whose problems are recorded, and most problems that are kept of it.
    pub(super) recorded: (usize, usize),
}

fn patience(rounds: usize, sample: u64, cap: u64) -> Patience {
    let [sample, cap] = [sample, cap].map(Duration::from_millis);
    Patience { rounds, sample, cap }
}

impl Plan {
    pub(super) fn new(arguments: &Arguments) -> Self {
        let (parts, scenes) = (arguments.only.clone(), arguments.scenes.clone());
        if arguments.quick {
            Self {
                parts,
                quick: true,
                scenes,
                patience: patience(3, 1, 30),
                sweep: patience(3, 1, 20),
                growth: patience(3, 1, 60),
                longest_chain: 200,
                most_rows: 10,
                halvings: 5,
                base: 4,
                differences: 8,
                environments: &[1, 64],
                recorded: (30, 5),
            }
        } else {
            Self {
                parts,
                quick: false,
                scenes,
                patience: patience(9, 10, 250),
                sweep: patience(7, 2, 150),
                growth: patience(5, 5, 1500),
                longest_chain: 10_000,
                most_rows: 99,
                halvings: 12,
                base: 10,
                differences: 60,
                environments: &[1, 64, 1024],
                recorded: (150, 40),
            }
        }
    }

    /// Whether a part was asked for.
    pub(super) fn has(&self, part: Part) -> bool {
        self.parts.is_empty() || self.parts.contains(&part)
    }
}

/// A pool of one thread, and one with a thread on each core.
pub(super) fn pools(cores: &[CoreId]) -> Result<Vec<ThreadPool>, ThreadPoolBuildError> {
    let cores = Arc::<[CoreId]>::from(cores);
    let pool = |threads: usize| {
        let cores = cores.clone();
        let bind = move |thread: usize| {
            if let Some(core) = cores.get(thread) {
                core_affinity::set_for_current(*core);
            }
        };
        ThreadPoolBuilder::new().num_threads(threads).start_handler(bind).build()
    };
    let mut sizes = vec![1, cores.len().max(1)];
    sizes.dedup();
    sizes.into_iter().map(pool).collect()
}

/// Tolerances at which solvers are compared; the last is the default.
const TOLERANCES: [f64; 4] = [1e-3, 1e-6, 1e-9, 1e-12];

/// The solvers of this build at several tolerances.
pub(super) fn candidates() -> Vec<Candidate> {
    let at = |tolerance: f64| {
        let solvers = solvers_at(tolerance).into_iter();
        solvers.map(move |solver| Candidate { name: solver.name(), tolerance, solver })
    };
    TOLERANCES.into_iter().flat_map(at).collect()
}
