//! What is tried where neither an active set nor the interior point has led to a solution.

use tangency_lcp::{BoxForm, Law, LcpSolution, Method, Metric, Sweeps};
use tangency_lcp_lemke::candidates;

use crate::feasibility::conflict;
use crate::mehrotra::CAREFUL;
use crate::stages::Stages;

/// Contacts that part faster than this, relative to s*, are out of play.
const NEAR: f64 = 1e-2;
/// Sweeps after which rows count as in play or not.
const SWEEPS: usize = 200;

impl Stages<'_> {
    /// The violation of rows that contradict each other: then nothing else needs to be tried.
    pub(crate) fn conflict(&self) -> Option<f64> {
        self.settings
            .tell_infeasible
            .then(|| conflict(self.search.polish.problem, &self.settings))
            .flatten()
    }

    /// Ends with the first stage that leaves an acceptable residual.
    pub(crate) fn last_resorts(&mut self, form: Option<&BoxForm>) -> bool {
        let usual = self.search.polish;
        if self.search.walk() || self.search.is_accepted() {
            return true;
        }
        let found = form.is_some_and(|form| self.patient(form));
        self.search.polish = usual;
        found || self.enumerated()
    }

    /// Pivoting and the interior point by rows, with a more patient polish.
    fn patient(&mut self, form: &BoxForm) -> bool {
        self.search.polish.max_flips *= 5;
        self.search.polish.near_miss = 1.0;
        if self.pivoting(form) || self.search.is_accepted() {
            return true;
        }
        self.search.stats.method = Method::InteriorPoint;
        self.by_rows(form, CAREFUL) || self.search.is_accepted()
    }

    /// Lemke's method on the rows in play, then on all.
    fn pivoting(&mut self, form: &BoxForm) -> bool {
        self.search.stats.method = Method::Pivoting;
        let problem = self.search.polish.problem;
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
            self.search.stats.iterations += pivots;
            self.polish_impulses(whole(form.impulses(&y)))
        })
    }

    /// Rows that have an impulse after some sweeps, or might soon.
    fn in_play(&self) -> Vec<usize> {
        let (problem, metric) = (self.search.polish.problem, self.search.polish.metric);
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
        let velocities = self.search.polish.problem.velocities(&impulses);
        let approximate = LcpSolution { velocities, impulses, ..LcpSolution::default() };
        self.search.offer_approximate(&approximate)
    }

    /// Starts from all modes of the rows that the best candidate leaves in doubt.
    fn enumerated(&mut self) -> bool {
        self.search.stats.method = Method::Enumeration;
        let Some(best) = self.search.best.clone() else { return false };
        self.search
            .polish
            .problem
            .neighbours(&best.solution)
            .any(|modes| self.search.offer_modes(&modes, None))
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
