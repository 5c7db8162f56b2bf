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
mod rollouts;

use tangency::lcp::{Fallback, LcpError};
use tangency::{BACKENDS, LcpSolver};

use crate::engine::backends;

#[test]
fn every_feature_is_a_backend() {
    assert_eq!(backends().len(), BACKENDS.len());
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

    fn solve(
        &self,
        _: &tangency::lcp::Lcp,
        _: Option<&tangency::lcp::Guess>,
        _: &mut tangency::lcp::Scratch,
    ) -> Result<tangency::lcp::LcpSolution, LcpError> {
        Err(LcpError::NotConverged { iterations: 1, residual: 0.5 })
    }
}

#[test]
fn a_fallback_records_which_solver_answered() {
    let problem = tangency_bench::problems::stack(&mut tangency_bench::problems::Random(3), 1.0);
    for solver in backends() {
        let name = solver.name();
        let fallback = Fallback::new(vec![Box::new(Hopeless), solver]);
        let solution = fallback.solve(&problem, None, &mut Default::default()).expect("solved");
        assert_eq!(solution.stats.attempt, 1);
        assert_eq!(fallback.answered(&solution), Some(name));
    }
    let fallback = Fallback::new(vec![Box::new(Hopeless)]);
    let error = fallback.solve(&problem, None, &mut Default::default()).expect_err("hopeless");
    assert_eq!(error.residual(), Some(0.5));
}
