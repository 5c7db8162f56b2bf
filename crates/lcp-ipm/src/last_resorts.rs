//! What is tried where neither an active set nor the interior point has led to a solution.

use tangency_lcp::{BoxForm, Law, LcpSolution, Method, Metric, Sweeps, walks};
use tangency_lcp_lemke::candidates;

use crate::feasibility::conflict;
use crate::mehrotra::CAREFUL;
use crate::solve::Search;

/// Contacts that part faster than this, relative to s*, are out of play.
const NEAR: f64 = 1e-2;
/// Sweeps after which rows count as in play or not.
const SWEEPS: usize = 200;

impl Search<'_> {
    /// The violation of rows that contradict each other: then nothing else needs to be tried.
    pub(crate) fn conflict(&self) -> Option<f64> {
        self.settings
            .tell_infeasible
            .then(|| conflict(self.polish.problem, &self.settings))
            .flatten()
    }

    /// Ends with the first stage that leaves an acceptable residual.
    pub(crate) fn last_resorts(&mut self, form: Option<&BoxForm>) -> bool {
        let usual = self.polish;
        if self.walk() || self.is_accepted() {
            return true;
        }
        let found = form.is_some_and(|form| self.patient(form));
        self.polish = usual;
        found || self.enumerated()
    }

    /// Pivoting and the interior point by rows, with a more patient polish.
    fn patient(&mut self, form: &BoxForm) -> bool {
        self.polish.max_flips *= 5;
        self.polish.near_miss = 1.0;
        if self.pivoting(form) || self.is_accepted() {
            return true;
        }
        self.stats.method = Method::InteriorPoint;
        self.by_rows(form, CAREFUL) || self.is_accepted()
    }

    fn walk(&mut self) -> bool {
        self.stats.method = Method::Walk;
        let mut scratch = std::mem::take(self.scratch);
        let found = walks(self.polish, &mut scratch).any(|(candidate, factorisations)| {
            self.stats.factorisations += factorisations;
            candidate.is_some_and(|candidate| self.offer(candidate))
        });
        *self.scratch = scratch;
        found
    }

    /// Lemke's method on the rows in play, then on all.
    fn pivoting(&mut self, form: &BoxForm) -> bool {
        self.stats.method = Method::Pivoting;
        let problem = self.polish.problem;
        let kept = self.in_play();
        let part = problem.select(&kept);
        let fewer = kept.len() < problem.rows.len() && {
            let form = BoxForm::of_rows(&part, &Metric::new(&part));
            self.pivot(&form, |impulses| spread(problem.rows.len(), &kept, impulses))
        };
        fewer || self.pivot(form, |impulses| impulses)
    }

    fn pivot(&mut self, form: &BoxForm, whole: impl Fn(Vec<f64>) -> Vec<f64>) -> bool {
        candidates(form).any(|(y, pivots)| {
            self.stats.iterations += pivots;
            self.polish_impulses(whole(form.impulses(&y)))
        })
    }

    /// Rows that have an impulse after some sweeps, or might soon.
    fn in_play(&self) -> Vec<usize> {
        let (problem, metric) = (self.polish.problem, self.polish.metric);
        let mut sweeps = Sweeps::new(problem);
        (0..SWEEPS).for_each(|_| sweeps.sweep());
        let near = sweeps.approximate();
        let slacks = problem.remainders(&near.velocities, &near.impulses);
        let touches = |row: usize| {
            near.impulses[row] > 0.0 || metric.remainder(row, slacks[row]) < NEAR * metric.scale
        };
        let plays = |row: &usize| match problem.rows[*row].law {
            Law::Unilateral => touches(*row),
            Law::Friction { normal, .. } => touches(normal as usize),
            Law::Equality | Law::Bounded { .. } => true,
        };
        (0..problem.rows.len()).filter(plays).collect()
    }

    fn polish_impulses(&mut self, impulses: Vec<f64>) -> bool {
        let velocities = self.polish.problem.velocities(&impulses);
        let approximate = LcpSolution { velocities, impulses, ..LcpSolution::default() };
        self.polish
            .approximate(&approximate, self.scratch)
            .is_some_and(|candidate| self.offer(candidate))
    }

    /// Starts from all modes of the rows that the best candidate leaves in doubt.
    fn enumerated(&mut self) -> bool {
        self.stats.method = Method::Enumeration;
        let Some(best) = self.best.clone() else { return false };
        self.polish.problem.neighbours(&best.solution).any(|modes| {
            let candidate = self.polish.modes(&modes, None, self.scratch);
            self.offer(candidate)
        })
    }
}

/// Impulses of all rows from those of some.
fn spread(rows: usize, kept: &[usize], impulses: Vec<f64>) -> Vec<f64> {
    let mut all = vec![0.0; rows];
    for (row, impulse) in kept.iter().zip(impulses) {
        all[*row] = impulse;
    }
    all
}
