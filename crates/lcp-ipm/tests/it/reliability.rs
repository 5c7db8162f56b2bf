//! How often the solver reaches the target on hard problems, and with how much work.
//!
//! `cargo test --release -p tangency-lcp-ipm -- --nocapture reliability` prints the table;
//! `TANGENCY_SEEDS=2000` makes it longer.

use std::io::Write;

use tangency_lcp::{LcpError, LcpSolver, Scratch};
use tangency_lcp_ipm::InteriorPoint;

use tangency_bench::problems::{CLASSES, Class, Random};

/// Problems of a class that may fail per hundred; piles and random graphs are the hard cases.
fn allowed(name: &str) -> u64 {
    u64::from(matches!(name, "graph" | "pile"))
}

#[derive(Default)]
struct Tally {
    solved: u64,
    worst: f64,
    iterations: Vec<u32>,
    factorisations: Vec<u32>,
    failures: Vec<String>,
}

impl Tally {
    fn of(class: Class, seeds: u64) -> Self {
        let mut tally = Self::default();
        for seed in 0..seeds {
            let problem = class(&mut Random(seed * 7919 + 1));
            let solved = InteriorPoint::default().solve(&problem, None, &mut Scratch::default());
            match solved {
                Ok(solution) => {
                    tally.solved += 1;
                    tally.worst = tally.worst.max(problem.residual(&solution).max());
                    tally.iterations.push(solution.stats.iterations);
                    tally.factorisations.push(solution.stats.factorisations);
                }
                Err(error) => {
                    // Every problem here allows rest, or parting: none is infeasible.
                    assert!(!matches!(error, LcpError::Infeasible { .. }), "seed {seed}: {error}");
                    tally.failures.push(format!("seed {seed}: {error}"));
                }
            }
        }
        tally.iterations.sort_unstable();
        tally.factorisations.sort_unstable();
        tally
    }
}

fn quantile(sorted: &[u32], percent: usize) -> u32 {
    sorted.get(sorted.len() * percent / 100).copied().unwrap_or(0)
}

fn seeds() -> u64 {
    std::env::var("TANGENCY_SEEDS").ok().and_then(|text| text.parse().ok()).unwrap_or(100)
}

#[test]
fn hard_problems() {
    let seeds = seeds();
    let mut out = std::io::stderr();
    for (name, class) in CLASSES {
        let tally = Tally::of(class, seeds);
        let (iterations, work) = (&tally.iterations, &tally.factorisations);
        writeln!(
            out,
            "{name:14} {}/{seeds}  worst {:.1e}  iterations {} {} {}  factorisations {} {} {}  {}",
            tally.solved,
            tally.worst,
            quantile(iterations, 50),
            quantile(iterations, 90),
            quantile(iterations, 99),
            quantile(work, 50),
            quantile(work, 90),
            quantile(work, 99),
            tally.failures.join("; "),
        )
        .expect("a line of the table");
        assert!(tally.worst <= 1e-10, "{name}: {:e}", tally.worst);
        assert!(
            100 * (seeds - tally.solved) <= allowed(name) * seeds,
            "{name}: {:?}",
            tally.failures
        );
    }
}
