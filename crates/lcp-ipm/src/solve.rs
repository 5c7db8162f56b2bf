//! [`InteriorPoint`] and the order of its stages.

use tangency_lcp::{
    BodySystem, BoxForm, Guess, Lcp, LcpError, LcpSolution, LcpSolver, Method, Mode, Polish,
    Polished, Scratch, SolveStats, solve_linear,
};

use crate::mehrotra::{BOLD, CAREFUL, Loop, Pace};
use crate::system::{RowSystem, System};

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

/// How thoroughly modes are polished before the interior point has converged.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Polishing {
    /// Most mode corrections of the modes at the free velocities.
    cold_flips: u32,
    /// Natural residual, of unknowns of about one, below which all means are used.
    near_end: f64,
    /// Most mode corrections before that, of modes that seem settled.
    flips: u32,
}

/// Where an evaluation of modes costs no more than an iteration, or nothing else has worked.
const THOROUGH: Polishing = Polishing { cold_flips: u32::MAX, near_end: 1e-2, flips: 4 };
/// Where rows are many: a few of the modes are wrong until late, and a polish that goes astray costs
/// more than iterations.
const SPARING: Polishing = Polishing { cold_flips: 1, near_end: 1e-6, flips: 0 };
/// Rows that are many.
const MANY_ROWS: usize = 100;

/// Residual that dependent rows may leave by rounding alone.
const CLOSE: f64 = 1e-11;
/// Iterations after a candidate of such a residual.
const SPARE: u32 = 3;
/// Above this number of rows, their own matrix is not formed.
const MOST_ROWS: usize = 2000;

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
        let (answered, stats) = (Method::ActiveSet, SolveStats::default());
        let many = problem.rows.len() > MANY_ROWS;
        let polishing = if many { SPARING } else { THOROUGH };
        let search =
            Search { settings: *self, polish, scratch, best: None, answered, polishing, stats };
        let found = search.run(guess);
        scratch.give_metric(metric);
        found
    }
}

/// One solve: the stages share the best candidate and the count of the work.
pub(crate) struct Search<'a> {
    pub(crate) settings: InteriorPoint,
    pub(crate) polish: Polish<'a>,
    pub(crate) scratch: &'a mut Scratch,
    pub(crate) best: Option<Polished>,
    /// The method that found the best.
    answered: Method,
    polishing: Polishing,
    pub(crate) stats: SolveStats,
}

impl Search<'_> {
    fn run(mut self, guess: Option<&Guess>) -> Result<LcpSolution, LcpError> {
        self.stats.method = Method::ActiveSet;
        if guess.is_some_and(|guess| self.warm(guess)) || self.settings.cold_modes && self.cold() {
            return self.finish();
        }
        if self.by_bodies(BOLD) || self.is_close() || self.thorough() || self.is_accepted() {
            return self.finish();
        }
        let Polish { problem, metric, .. } = self.polish;
        let form = (problem.rows.len() <= MOST_ROWS).then(|| BoxForm::of_rows(problem, metric));
        let found = form.as_ref().is_some_and(|form| {
            self.by_rows(form, BOLD) || self.by_rows(form, CAREFUL) || self.is_accepted()
        });
        if found {
            return self.finish();
        }
        if let Some(residual) = self.conflict() {
            return Err(LcpError::Infeasible { residual });
        }
        let _ = self.last_resorts(form.as_ref());
        self.finish()
    }

    /// Whether the best candidate is acceptable and as close as rows allow that nearly depend on each
    /// other: they may contradict each other by so much.
    fn is_close(&self) -> bool {
        let most = self.settings.acceptance.min(CLOSE);
        self.best.as_ref().is_some_and(|best| best.max() <= most)
    }

    pub(crate) fn is_accepted(&self) -> bool {
        self.best.as_ref().is_some_and(|best| best.max() <= self.settings.acceptance)
    }

    /// Takes a candidate into account; true if it is good enough to stop.
    pub(crate) fn offer(&mut self, candidate: Polished) -> bool {
        self.stats.factorisations += candidate.solution.stats.factorisations;
        let reached = self.polish.reached(&candidate);
        let better = self.best.as_ref().is_none_or(|best| candidate.max() < best.max());
        let dropped = if better {
            self.answered = self.stats.method;
            self.best.replace(candidate)
        } else {
            Some(candidate)
        };
        if let Some(dropped) = dropped {
            self.scratch.recycle(dropped.solution);
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
        let candidate = self.polish.modes(&guess.modes, start, self.scratch);
        self.offer(candidate)
    }

    fn cold(&mut self) -> bool {
        let sticking = self.polish.cold_modes(false);
        let sliding = self.polish.cold_modes(true);
        let same = sticking == sliding;
        let flips = self.polishing.cold_flips.min(self.polish.max_flips);
        let polish = Polish { max_flips: flips, ..self.polish };
        let candidate = polish.modes(&sticking, None, self.scratch);
        if self.offer(candidate) {
            return true;
        }
        !same && {
            let candidate = polish.modes(&sliding, None, self.scratch);
            self.offer(candidate)
        }
    }

    /// What was done sparingly, again; and the careful interior point.
    fn thorough(&mut self) -> bool {
        let sparing = std::mem::replace(&mut self.polishing, THOROUGH) == SPARING;
        self.stats.method = Method::ActiveSet;
        sparing && self.settings.cold_modes && self.cold() || self.by_bodies(CAREFUL)
    }

    /// The interior point with the rows eliminated.
    fn by_bodies(&mut self, pace: Pace) -> bool {
        self.stats.method = Method::InteriorPoint;
        let Polish { problem, metric, .. } = self.polish;
        let Some(mut system) = BodySystem::new(problem, metric, self.scratch) else { return false };
        let found = self.interior(&mut system, pace);
        system.give(self.scratch);
        found
    }

    /// The interior point on the rows' own matrix.
    pub(crate) fn by_rows(&mut self, form: &BoxForm, pace: Pace) -> bool {
        self.interior(&mut RowSystem::new(form), pace)
    }

    fn interior<S: System>(&mut self, system: &mut S, pace: Pace) -> bool {
        let before = self.stats.iterations;
        let mut path = Loop::new(system, pace, self.scratch);
        let polishing = self.polishing;
        let (mut glanced, mut tried) = (self.scratch.modes.take(), None);
        let (mut found, mut spare) = (false, SPARE);
        while !found && spare > 0 && path.iterations < self.settings.max_iterations {
            let going = path.advance(self.scratch);
            self.stats.factorisations += 1;
            self.stats.iterations = before + path.iterations;
            found = if path.best < polishing.near_end || !going {
                let y = if going { path.y() } else { path.best_y() };
                self.polish_at(path.system, y, &mut tried)
            } else {
                path.settled && self.glance(&path, polishing.flips, &mut glanced)
            };
            if !going {
                break;
            }
            spare -= u32::from(self.is_close());
        }
        path.give(self.scratch);
        self.scratch.modes.give(glanced);
        found
    }

    /// A short polish of modes that the path shows early and did not show before.
    fn glance<S: System>(
        &mut self,
        path: &Loop<S>,
        max_flips: u32,
        glanced: &mut Vec<Mode>,
    ) -> bool {
        let (mut modes, mut impulses) = (self.scratch.modes.take(), self.scratch.floats.take());
        path.list_modes(&mut modes);
        let known = modes == *glanced;
        if !known {
            path.system.impulses(path.y(), &mut impulses);
        }
        let polish = Polish { max_flips, near_miss: 0.0, ..self.polish };
        let found = !known && {
            let candidate = polish.modes(&modes, Some(&impulses), self.scratch);
            self.offer(candidate)
        };
        self.scratch.floats.give(impulses);
        self.scratch.modes.give(std::mem::replace(glanced, modes));
        found
    }

    /// Polishes an iterate near the end if it shows modes that the last attempt did not.
    fn polish_at<S: System>(
        &mut self,
        system: &S,
        y: &[f64],
        tried: &mut Option<Vec<Mode>>,
    ) -> bool {
        let mut impulses = self.scratch.floats.take();
        system.impulses(y, &mut impulses);
        let velocities = self.polish.problem.velocities(&impulses);
        let approximate = LcpSolution { velocities, impulses, ..LcpSolution::default() };
        let modes = self.polish.read_modes(&approximate);
        let known = tried.as_ref() == Some(&modes);
        *tried = Some(modes);
        let polished =
            if known { None } else { self.polish.approximate(&approximate, self.scratch) };
        self.scratch.recycle(approximate);
        polished.is_some_and(|candidate| self.offer(candidate))
    }

    fn finish(self) -> Result<LcpSolution, LcpError> {
        let iterations = self.stats.iterations;
        let residual = self.best.as_ref().map_or(f64::INFINITY, Polished::max);
        match self.best {
            Some(best) if self.polish.reached(&best) || residual <= self.settings.acceptance => {
                let stats = SolveStats { method: self.answered, ..self.stats };
                Ok(LcpSolution { stats, ..best.solution })
            }
            _ => Err(LcpError::NotConverged { iterations, residual }),
        }
    }
}
