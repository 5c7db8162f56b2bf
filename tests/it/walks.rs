//! Projected Gauss–Seidel and walks along active sets, on the hard problems of all classes.

use tangency::lcp::{Law, Lcp, LcpSolution, Metric, Polish, Scratch, Sweeps, Walk};
use tangency_bench::problems::{CLASSES, Random};

const SEEDS: u64 = 12;

/// Whether impulses are within their laws, up to rounding.
fn is_admissible(problem: &Lcp, impulses: &[f64]) -> bool {
    let within = |(row, law): (usize, Law)| {
        let y = impulses[row];
        match law {
            Law::Equality => true,
            Law::Unilateral => y >= 0.0,
            Law::Bounded { max } => y.abs() <= max * (1.0 + 1e-12),
            Law::Friction { normal, mu } => {
                let bound = mu * impulses[normal as usize];
                y.abs() <= bound + 1e-12 * (bound + impulses[normal as usize])
            }
        }
    };
    problem.rows.iter().map(|row| row.law).enumerate().all(within)
}

fn problems() -> impl Iterator<Item = Lcp> {
    let seeds = (0..SEEDS).flat_map(|seed| CLASSES.iter().map(move |(_, class)| (seed, class)));
    seeds.map(|(seed, class)| class(&mut Random(seed))).filter(|problem| !problem.is_linear())
}

fn swept(problem: &Lcp, sweeps: usize) -> LcpSolution {
    let mut iterate = Sweeps::new(problem);
    (0..sweeps).for_each(|_| iterate.sweep());
    iterate.approximate()
}

#[test]
fn sweeps_stay_within_the_laws_and_approach_a_solution() {
    let (mut nearer, mut count) = (0, 0);
    for problem in problems() {
        let (few, many) = (swept(&problem, 2), swept(&problem, 200));
        assert!(is_admissible(&problem, &few.impulses) && is_admissible(&problem, &many.impulses));
        let residual = |iterate: &LcpSolution| problem.residual(iterate).max();
        nearer += u32::from(residual(&many) <= residual(&few));
        count += 1;
    }
    assert!(nearer * 10 >= count * 9, "only {nearer} of {count} came nearer");
}

/// What a walk ends with is judged by the residual; impulses never leave their laws on the way.
#[test]
fn walks_end_in_solutions() {
    let (mut solved, mut count) = (0, 0);
    for problem in problems() {
        let metric = Metric::new(&problem);
        let polish = Polish::new(&problem, &metric, 1e-12, 8);
        let mut walk = Walk::new(polish, &swept(&problem, 100));
        let found = walk.run(300, &mut Scratch::default());
        assert!(is_admissible(&problem, walk.impulses()), "the walk left the laws");
        solved += u32::from(found.is_some_and(|found| found.max() <= 1e-10));
        count += 1;
    }
    assert!(solved * 10 >= count * 8, "only {solved} of {count} were solved");
}
