//! How often each backend solves hard one-step problems, with how much work and in what time.
//!
//! `cargo run --release -p tangency-bench --features tangency/clarabel,tangency/lemke --example
//! reliability -- 100` prints the table of `docs/solvers.md` for 100 problems per class.

#![expect(clippy::print_stdout, reason = "an example prints what it found")]

use std::time::Instant;

use tangency::{LcpSolver, all_solvers, fallback};
use tangency_bench::problems::{CLASSES, Class, Random};

fn main() {
    let seeds = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(100);
    println!("| class | backend | solved | iterations median | p90 | time median (µs) | p90 |");
    println!("|---|---|--:|--:|--:|--:|--:|");
    let mut list = all_solvers();
    list.push(Box::new(fallback()));
    let mut totals = vec![0; list.len()];
    for (name, class) in CLASSES {
        for (solver, total) in list.iter().zip(&mut totals) {
            *total += row(name, class, &**solver, seeds);
        }
    }
    for (solver, total) in list.iter().zip(totals) {
        println!("| all | {} | {total}/{} | | | | |", solver.name(), seeds * CLASSES.len() as u64);
    }
}

/// Prints one line of the table; the number solved.
fn row(name: &str, class: Class, solver: &dyn LcpSolver, seeds: u64) -> u64 {
    let (mut solved, mut iterations, mut times) = (0, Vec::new(), Vec::new());
    let mut failed = Vec::new();
    for seed in 0..seeds {
        let problem = class(&mut Random(seed * 7919 + 1));
        let start = Instant::now();
        let answer = solver.solve(&problem, None, &mut tangency::lcp::Scratch::default());
        times.push(start.elapsed().as_micros());
        match answer {
            Ok(answer) if problem.residual(&answer).max() <= 1e-10 => {
                solved += 1;
                iterations.push(u128::from(answer.stats.iterations));
            }
            _ => failed.push(seed),
        }
    }
    iterations.sort_unstable();
    times.sort_unstable();
    let at = |sorted: &[u128], percent: usize| sorted.get(sorted.len() * percent / 100).copied();
    let [median, p90] = [50, 90].map(|p| at(&iterations, p).unwrap_or(0));
    let [time, time90] = [50, 90].map(|p| at(&times, p).unwrap_or(0));
    let solver = solver.name();
    println!("| {name} | {solver} | {solved}/{seeds} | {median} | {p90} | {time} | {time90} |");
    if std::env::args().any(|text| text == "--failed") && !failed.is_empty() {
        println!("{name} {solver} failed: {failed:?}");
    }
    solved
}
