//! [`InteriorPoint`] and the order of its stages.

use tangency_lcp::{
    BoxForm, Guess, Lcp, LcpError, LcpSolution, LcpSolver, Method, Metric, Mode, Polish, Polished,
    Scratch, SolveStats, solve_linear,
};
use tangency_lcp_lemke::candidates;

use crate::feasibility::conflict;
use crate::mehrotra::{BOLD, CAREFUL, Loop, Pace};

/// Interior-point solver with active-set polish.
///
/// Stages, each tried only if the one before left a residual above `tolerance`: the guess through
/// the active-set loop; modes read at the free velocities; the interior point, boldly and then
/// carefully, polished whenever it shows new modes; Lemke's method for problems of moderate size. A
/// solution is returned if its natural residual is at most `acceptance`.
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
    /// Whether a failure is followed by a test for conflicting constraints, which costs two more
    /// solves of an easier problem. Default true.
    pub tell_infeasible: bool,
}

impl Default for InteriorPoint {
    fn default() -> Self {
        let (tolerance, acceptance) = (1e-12, 1e-10);
        Self { tolerance, acceptance, max_iterations: 60, max_flips: 8, tell_infeasible: true }
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
        _scratch: &mut Scratch,
    ) -> Result<LcpSolution, LcpError> {
        problem.validate()?;
        if problem.is_linear() {
            return solve_linear(problem);
        }
        let metric = Metric::new(problem);
        let polish = Polish::new(problem, &metric, self.tolerance, self.max_flips);
        Search { settings: *self, polish, best: None, stats: SolveStats::default() }.run(guess)
    }
}

/// One solve: the stages share the best candidate and the count of the work.
struct Search<'a> {
    settings: InteriorPoint,
    polish: Polish<'a>,
    best: Option<Polished>,
    stats: SolveStats,
}

impl Search<'_> {
    fn run(mut self, guess: Option<&Guess>) -> Result<LcpSolution, LcpError> {
        self.stats.method = Method::ActiveSet;
        let reached = guess.is_some_and(|guess| self.warm(guess)) || self.cold() || self.enclosed();
        self.finish(reached)
    }

    /// Takes a candidate into account; true if it is good enough to stop.
    fn offer(&mut self, candidate: Polished) -> bool {
        self.stats.factorisations += candidate.solution.stats.factorisations;
        let reached = self.polish.reached(&candidate);
        if self.best.as_ref().is_none_or(|best| candidate.max() < best.max()) {
            self.best = Some(candidate);
        }
        reached
    }

    fn warm(&mut self, guess: &Guess) -> bool {
        let rows = self.polish.problem.rows.len();
        if guess.modes.len() != rows {
            return false;
        }
        let start = (guess.impulses.len() == rows
            && guess.impulses.iter().all(|impulse| impulse.is_finite()))
        .then_some(&guess.impulses[..]);
        let candidate = self.polish.modes(guess.modes.clone(), start);
        self.offer(candidate)
    }

    fn cold(&mut self) -> bool {
        let sticking = self.polish.cold_modes(false);
        let sliding = self.polish.cold_modes(true);
        let same = sticking == sliding;
        let candidate = self.polish.modes(sticking, None);
        if self.offer(candidate) {
            return true;
        }
        !same && {
            let candidate = self.polish.modes(sliding, None);
            self.offer(candidate)
        }
    }

    /// The stages that need the rows' matrix.
    fn enclosed(&mut self) -> bool {
        self.stats.method = Method::InteriorPoint;
        let form = BoxForm::of_rows(self.polish.problem, self.polish.metric);
        self.interior(&form, BOLD)
            || self.interior(&form, CAREFUL)
            || self.pivoting(&form)
            || self.interior(&form, CAREFUL)
    }

    fn pivoting(&mut self, form: &BoxForm) -> bool {
        self.stats.method = Method::Pivoting;
        self.polish.max_flips *= 5;
        self.polish.near_miss = 1.0;
        candidates(form).any(|(y, pivots)| {
            self.stats.factorisations += pivots;
            self.polish_at(form, &y, &mut None)
        })
    }

    fn interior(&mut self, form: &BoxForm, pace: Pace) -> bool {
        let before = self.stats.iterations;
        let mut path = Loop::new(form, pace);
        let mut tried: Option<Vec<Mode>> = None;
        while path.iterations < self.settings.max_iterations {
            let going = path.advance();
            self.stats.factorisations += 1;
            self.stats.iterations = before + path.iterations;
            let y = if going { path.y() } else { path.best_y() };
            if (path.best < 0.1 || !going) && self.polish_at(form, y, &mut tried) {
                return true;
            }
            if !going {
                break;
            }
        }
        false
    }

    /// Polishes the iterate if it shows modes that the last attempt did not.
    fn polish_at(&mut self, form: &BoxForm, y: &[f64], tried: &mut Option<Vec<Mode>>) -> bool {
        let impulses = form.impulses(y);
        let velocities = self.polish.problem.velocities(&impulses);
        let approximate = LcpSolution { velocities, impulses, ..LcpSolution::default() };
        let modes = self.polish.read_modes(&approximate);
        if tried.as_ref() == Some(&modes) {
            return false;
        }
        *tried = Some(modes);
        self.polish.approximate(&approximate).is_some_and(|candidate| self.offer(candidate))
    }

    fn finish(self, reached: bool) -> Result<LcpSolution, LcpError> {
        let iterations = self.stats.iterations;
        let Some(best) = self.best else {
            return Err(LcpError::NotConverged { iterations, residual: f64::INFINITY });
        };
        let residual = best.max();
        if reached || residual <= self.settings.acceptance {
            Ok(LcpSolution { stats: self.stats, ..best.solution })
        } else {
            let conflict = self
                .settings
                .tell_infeasible
                .then(|| conflict(self.polish.problem, &self.settings));
            match conflict.flatten() {
                Some(residual) => Err(LcpError::Infeasible { residual }),
                None => Err(LcpError::NotConverged { iterations, residual }),
            }
        }
    }
}
