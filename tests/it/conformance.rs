//! Backends give the same answers: velocities, residuals and derivatives.
//!
//! The problems are the recorded steps of every scene and validation case, random ones of the hard
//! classes, and other people's. Where Coulomb's law has several solutions both are accepted if both
//! are exact; [`compare`] says what that means.

mod collection;
mod compare;
mod cones;
mod random;
mod recorded;
mod reliability;
mod rollouts;

use tangency::lcp::{Fallback, Guess, Lcp, LcpError, LcpSolution, Scratch};
use tangency::{BACKENDS, LcpSolver};

use crate::engine::backends;

#[test]
fn every_feature_is_a_backend() {
    assert!(!backends().is_empty());
    assert_eq!(tangency::all_solvers().len(), BACKENDS.len());
    assert_eq!(tangency::raw_solvers().len(), BACKENDS.len());
    for name in BACKENDS {
        assert!(tangency::backend(name).is_some(), "{name}");
    }
    assert!(tangency::backend("no such backend").is_none());
}

/// A solver that always fails.
struct Hopeless;

impl LcpSolver for Hopeless {
    fn name(&self) -> &'static str {
        "hopeless"
    }

    fn solve(&self, _: &Lcp, _: Option<&Guess>, _: &mut Scratch) -> Result<LcpSolution, LcpError> {
        Err(LcpError::NotConverged { iterations: 1, residual: 0.5 })
    }
}

#[test]
fn a_fallback_records_which_solver_answered() {
    let problem = tangency_bench::problems::stack(&mut tangency_bench::problems::Random(3), 1.0);
    for solver in tangency::all_solvers() {
        let name = solver.name();
        let fallback = Fallback::new(vec![Box::new(Hopeless), solver]);
        let solution = fallback.solve(&problem, None, &mut Scratch::default()).expect("solved");
        assert_eq!(solution.stats.attempt, 1);
        assert_eq!(fallback.answered(&solution), Some(name));
    }
    let fallback = Fallback::new(vec![Box::new(Hopeless)]);
    let error = fallback.solve(&problem, None, &mut Scratch::default()).expect_err("hopeless");
    assert_eq!(error.residual(), Some(0.5));
}
