//! [`InteriorPoint`] and the order of its stages.

use tangency_lcp::{
    Guess, Lcp, LcpError, LcpSolution, LcpSolver, Polish, Scratch, Search, solve_linear,
};

use crate::stages::Stages;

/// Interior-point solver with active-set polish.
///
/// Stages, each tried only if the one before left a residual above `tolerance`: the guess through the
/// active-set loop; modes read at the free velocities; the interior point, boldly and then carefully,
/// with the rows eliminated and then on the rows' own matrix, polished whenever it shows new modes
/// that seem settled. Where the residual is then above `acceptance`, a test for contradicting rows,
/// and the last resorts: a walk along the active sets from projected Gauss–Seidel's iterate; Lemke's
/// method on the rows in play and on all, for problems of moderate size; the interior point with a
/// more patient polish; all modes of the few rows that are most in doubt. A solution is returned if
/// its natural residual is at most `acceptance`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InteriorPoint {
    /// Natural residual, free of units, at which the search stops. Default 1e-12.
    pub tolerance: f64,
    /// Greatest natural residual that is returned as a solution. Default 1e-10.
    pub acceptance: f64,
    /// Greatest number of interior-point iterations per run, bold or careful. Default 60.
    pub max_iterations: u32,
    /// Greatest number of mode corrections per attempt of the active-set loop. Default 8.
    pub max_flips: u32,
    /// Whether modes read at the free velocities are tried before the interior point, which they
    /// often make unnecessary. Default true.
    pub cold_modes: bool,
    /// Whether the last stages are preceded by a test for conflicting constraints, which costs two
    /// solves of an easier problem. Default true.
    pub tell_infeasible: bool,
}

impl Default for InteriorPoint {
    fn default() -> Self {
        Self {
            tolerance: 1e-12,
            acceptance: 1e-10,
            max_iterations: 60,
            max_flips: 8,
            cold_modes: true,
            tell_infeasible: true,
        }
    }
}

impl LcpSolver for InteriorPoint {
    fn name(&self) -> &'static str {
        "interior point"
    }

    fn solve(
        &self,
        problem: &Lcp,
        guess: Option<&Guess>,
        scratch: &mut Scratch,
    ) -> Result<LcpSolution, LcpError> {
        problem.validate()?;
        if problem.is_linear() {
            return solve_linear(problem);
        }
        let metric = scratch.metric(problem);
        let polish = Polish::new(problem, &metric, self.tolerance, self.max_flips);
        let search = Search::new(polish, self.acceptance, scratch);
        let found = Stages::new(*self, search).run(guess);
        scratch.give_metric(metric);
        found
    }
}
