//! How many of a thousand hard one-step problems each backend solves.

use tangency::LcpSolver;
use tangency::lcp::{LcpError, Scratch};
use tangency_bench::problems::{CLASSES, Random};

/// Solved of 1000, to a residual of 1e-10. A failure claims no conflict: there is none.
fn solved(solver: &dyn LcpSolver) -> usize {
    let mut solved = 0;
    for (name, class) in CLASSES {
        for seed in 0..100 {
            let problem = class(&mut Random(seed * 7919 + 1));
            match solver.solve(&problem, None, &mut Scratch::default()) {
                Ok(solution) => {
                    let residual = problem.residual(&solution).max();
                    assert!(residual <= 1e-10, "{name} {seed}: {residual:e}");
                    solved += 1;
                }
                Err(LcpError::NotConverged { .. }) => {}
                Err(error) => panic!("{name} {seed}: {error}"),
            }
        }
    }
    solved
}

/// ≥ 99.5 % by the interior point, ≥ 97 % by Clarabel, each alone.
#[test]
fn of_a_thousand_problems() {
    for solver in crate::engine::backends() {
        let least = if solver.name() == "clarabel" { 970 } else { 995 };
        let solved = solved(&*solver);
        assert!(solved >= least, "{}: {solved} of 1000", solver.name());
    }
}

#[cfg(all(feature = "ipm", feature = "clarabel"))]
#[test]
fn one_after_the_other_they_solve_all() {
    assert_eq!(solved(&tangency::fallback()), 1000);
}
