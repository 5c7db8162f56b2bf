//! [`Lemke`].

use tangency_lcp::{
    BoxForm, Guess, Lcp, LcpError, LcpSolution, LcpSolver, Method, Polish, Polished, RawLcp,
    RawPolish, RawSolution, RawSolver, Scratch, SolveStats, solve_linear,
};

use crate::candidates;

/// Lemke's method with eight covering vectors in turn (three where there are more than 400 pairs), each
/// answer polished.
///
/// Takes problems of at most 1200 complementary pairs (one per contact, limit or joint stop, two per
/// friction row or motor); larger ones are not tried. Work is bounded: 8 n + 200 pivots per
/// covering vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lemke {
    /// Natural residual, free of units, at which the search stops. Default 1e-12.
    pub tolerance: f64,
    /// Greatest natural residual that is returned as a solution. Default 1e-10.
    pub acceptance: f64,
    /// Greatest number of mode corrections per polish. Default 40.
    pub max_flips: u32,
}

impl Default for Lemke {
    fn default() -> Self {
        Self { tolerance: 1e-12, acceptance: 1e-10, max_flips: 40 }
    }
}

impl LcpSolver for Lemke {
    fn name(&self) -> &'static str {
        "lemke"
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
        let stats = SolveStats { method: Method::ActiveSet, ..SolveStats::default() };
        let mut search = Search { polish, scratch, best: None, stats };
        let _ = guess.is_some_and(|guess| search.warm(guess)) || search.pivoting();
        let found = search.finish(self.acceptance);
        scratch.give_metric(metric);
        found
    }
}

impl RawSolver for Lemke {
    fn name(&self) -> &'static str {
        "lemke"
    }

    fn solve_raw(&self, problem: &RawLcp) -> Result<RawSolution, LcpError> {
        problem.validate()?;
        if problem.q.is_empty() {
            return Ok(RawSolution::empty());
        }
        let form = problem.box_form();
        let mut polish = RawPolish::new(problem, &form, self.tolerance, self.max_flips);
        let mut pivots = 0;
        let _ = candidates(&form).any(|(y, count)| {
            pivots += count;
            polish.offer(&y)
        });
        polish.finish(pivots, pivots)
    }
}

/// One solve.
struct Search<'a> {
    polish: Polish<'a>,
    scratch: &'a mut Scratch,
    best: Option<Polished>,
    stats: SolveStats,
}

impl Search<'_> {
    fn warm(&mut self, guess: &Guess) -> bool {
        guess.modes.len() == self.polish.problem.rows.len() && {
            let candidate = self.polish.modes(&guess.modes, None, self.scratch);
            self.offer(candidate)
        }
    }

    fn pivoting(&mut self) -> bool {
        self.stats.method = Method::Pivoting;
        let problem = self.polish.problem;
        let form = BoxForm::of_rows(problem, self.polish.metric);
        candidates(&form).any(|(y, pivots)| {
            self.stats.iterations += pivots;
            let impulses = form.impulses(&y);
            let velocities = problem.velocities(&impulses);
            let approximate = LcpSolution { velocities, impulses, ..LcpSolution::default() };
            let candidate = self.polish.approximate(&approximate, self.scratch);
            candidate.is_some_and(|candidate| self.offer(candidate))
        })
    }

    fn offer(&mut self, candidate: Polished) -> bool {
        self.stats.factorisations += candidate.solution.stats.factorisations;
        let reached = self.polish.reached(&candidate);
        if self.best.as_ref().is_none_or(|best| candidate.max() < best.max()) {
            self.best = Some(candidate);
        }
        reached
    }

    fn finish(self, acceptance: f64) -> Result<LcpSolution, LcpError> {
        let iterations = self.stats.iterations;
        let residual = self.best.as_ref().map_or(f64::INFINITY, Polished::max);
        match self.best {
            Some(best) if residual <= acceptance => {
                Ok(LcpSolution { stats: self.stats, ..best.solution })
            }
            _ => Err(LcpError::NotConverged { iterations, residual }),
        }
    }
}
