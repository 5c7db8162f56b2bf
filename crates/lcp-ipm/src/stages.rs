//! The stages of a solve, in their order.

use tangency_lcp::{BodySystem, BoxForm, Guess, LcpError, LcpSolution, Method, Polish, Search};

use crate::mehrotra::{BOLD, CAREFUL, Pace};
use crate::polishing::{Polishing, SPARING, THOROUGH};
use crate::solve::InteriorPoint;
use crate::system::RowSystem;

/// Residual that dependent rows may leave by rounding alone.
const CLOSE: f64 = 1e-11;
/// Rows that are many.
const MANY_ROWS: usize = 100;
/// Above this number of rows, their own matrix is not formed.
const MOST_ROWS: usize = 2000;

/// One solve.
pub(crate) struct Stages<'a> {
    pub(crate) settings: InteriorPoint,
    pub(crate) search: Search<'a>,
    pub(crate) polishing: Polishing,
}

impl<'a> Stages<'a> {
    pub(crate) fn new(settings: InteriorPoint, search: Search<'a>) -> Self {
        let many = search.polish.problem.rows.len() > MANY_ROWS;
        Self { settings, search, polishing: if many { SPARING } else { THOROUGH } }
    }
}

impl Stages<'_> {
    pub(crate) fn run(mut self, guess: Option<&Guess>) -> Result<LcpSolution, LcpError> {
        if guess.is_some_and(|guess| self.search.offer_guess(guess)) || self.cold() {
            return self.search.finish();
        }
        if self.by_bodies(BOLD) || self.is_close() || self.thorough() || self.search.is_accepted() {
            return self.search.finish();
        }
        let Polish { problem, metric, .. } = self.search.polish;
        let form = (problem.rows.len() <= MOST_ROWS).then(|| BoxForm::of_rows(problem, metric));
        let found = form.as_ref().is_some_and(|form| {
            self.by_rows(form, BOLD) || self.by_rows(form, CAREFUL) || self.search.is_accepted()
        });
        if found {
            return self.search.finish();
        }
        if let Some(residual) = self.conflict() {
            return Err(LcpError::Infeasible { residual });
        }
        let _ = self.last_resorts(form.as_ref());
        self.search.finish()
    }

    /// Whether the best candidate is acceptable and as close as rows allow that nearly depend on each
    /// other: they may contradict each other by so much.
    pub(crate) fn is_close(&self) -> bool {
        self.search.residual() <= self.settings.acceptance.min(CLOSE)
    }

    /// Modes at the free velocities, sticking and sliding.
    fn cold(&mut self) -> bool {
        if !self.settings.cold_modes {
            return false;
        }
        let usual = self.search.polish;
        self.search.polish.max_flips = self.polishing.cold_flips.min(usual.max_flips);
        let [sticking, sliding] = [false, true].map(|slide| usual.cold_modes(slide));
        let found = self.search.offer_modes(&sticking, None)
            || sticking != sliding && self.search.offer_modes(&sliding, None);
        self.search.polish = usual;
        found
    }

    /// What was done sparingly, again; and the careful interior point.
    fn thorough(&mut self) -> bool {
        let sparing = std::mem::replace(&mut self.polishing, THOROUGH) == SPARING;
        self.search.stats.method = Method::ActiveSet;
        sparing && self.cold() || self.by_bodies(CAREFUL)
    }

    /// The interior point with the rows eliminated.
    fn by_bodies(&mut self, pace: Pace) -> bool {
        self.search.stats.method = Method::InteriorPoint;
        let Polish { problem, metric, .. } = self.search.polish;
        let Some(mut system) = BodySystem::new(problem, metric, self.search.scratch) else {
            return false;
        };
        let found = self.interior(&mut system, pace);
        system.give(self.search.scratch);
        found
    }

    /// The interior point on the rows' own matrix.
    pub(crate) fn by_rows(&mut self, form: &BoxForm, pace: Pace) -> bool {
        self.interior(&mut RowSystem::new(form), pace)
    }
}
