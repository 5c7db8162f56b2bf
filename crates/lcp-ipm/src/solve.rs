//! [`InteriorPoint`] and the order of its stages.

use tangency_lcp::{
    BoxForm, Guess, Lcp, LcpError, LcpSolution, LcpSolver, Method, Metric, Mode, Polish, Polished,
    Scratch, SolveStats, Sweeps, Walk, solve_linear,
};
use tangency_lcp_lemke::candidates;

use crate::feasibility::conflict;
use crate::mehrotra::{BOLD, CAREFUL, Loop, Pace};
use crate::neighbours::neighbours;

/// Interior-point solver with active-set polish.
///
/// Stages, each tried only if the one before left a residual above `tolerance` (above `acceptance` from
/// Lemke's method on): the guess through
/// the active-set loop; modes read at the free velocities; the interior point, boldly and then
/// carefully, polished whenever it shows new modes; a walk along the active sets that begins at
/// projected Gauss–Seidel's iterate; Lemke's method for problems of moderate size;
/// all modes of the few rows that are most in doubt. A solution is returned if its natural residual is at most `acceptance`.
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
    /// Whether the last stages are preceded by a test for conflicting constraints, which costs two
    /// solves of an easier problem. Default true.
    pub tell_infeasible: bool,
}

impl Default for InteriorPoint {
    fn default() -> Self {
        let (tolerance, acceptance) = (1e-12, 1e-10);
        Self { tolerance, acceptance, max_iterations: 60, max_flips: 8, tell_infeasible: true }
    }
}

/// After how many sweeps of projected Gauss–Seidel a walk begins.
const SWEEPS: [usize; 5] = [10, 30, 100, 300, 1000];
/// Greatest number of steps of a walk.
const MOST_STEPS: usize = 500;

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
        if guess.is_some_and(|guess| self.warm(guess)) || self.cold() {
            return self.finish();
        }
        let form = BoxForm::of_rows(self.polish.problem, self.polish.metric);
        self.stats.method = Method::InteriorPoint;
        if self.interior(&form, BOLD) || self.interior(&form, CAREFUL) || self.is_accepted() {
            return self.finish();
        }
        if let Some(residual) = self.conflict() {
            return Err(LcpError::Infeasible { residual });
        }
        let _ = self.walk()
            || self.pivoting(&form)
            || self.interior(&form, CAREFUL)
            || self.enumerated();
        self.finish()
    }

    fn is_accepted(&self) -> bool {
        self.best.as_ref().is_some_and(|best| best.max() <= self.settings.acceptance)
    }

    /// The violation of rows that contradict each other: then nothing else needs to be tried.
    fn conflict(&self) -> Option<f64> {
        self.settings
            .tell_infeasible
            .then(|| conflict(self.polish.problem, &self.settings))
            .flatten()
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

    /// Walks from where projected Gauss–Seidel is after more and more sweeps.
    fn walk(&mut self) -> bool {
        self.stats.method = Method::Walk;
        let mut sweeps = Sweeps::new(self.polish.problem);
        let mut done = 0;
        SWEEPS.into_iter().any(|count| {
            (done..count).for_each(|_| sweeps.sweep());
            done = count;
            let candidate = Walk::new(self.polish, &sweeps.approximate()).run(MOST_STEPS);
            candidate.is_some_and(|candidate| self.offer(candidate))
        })
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

    /// Starts from all modes of the rows that the best candidate leaves in doubt.
    fn enumerated(&mut self) -> bool {
        self.stats.method = Method::Enumeration;
        self.polish.near_miss = 1e-5;
        self.polish.max_flips = self.settings.max_flips;
        let Some(best) = self.best.clone() else { return false };
        neighbours(self.polish.problem, &best.solution).any(|modes| {
            let candidate = self.polish.modes(modes, None);
            self.offer(candidate)
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

    fn finish(self) -> Result<LcpSolution, LcpError> {
        let iterations = self.stats.iterations;
        let residual = self.best.as_ref().map_or(f64::INFINITY, Polished::max);
        match self.best {
            Some(best) if self.polish.reached(&best) || residual <= self.settings.acceptance => {
                Ok(LcpSolution { stats: self.stats, ..best.solution })
            }
            _ => Err(LcpError::NotConverged { iterations, residual }),
        }
    }
}
