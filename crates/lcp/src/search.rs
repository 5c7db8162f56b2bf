//! What the stages of one solve share: the best candidate so far, and the count of the work.

use crate::{
    Guess, LcpError, LcpSolution, Method, Mode, Polish, Polished, Scratch, SolveStats, walks,
};

/// One solve, whatever its stages are: each offers candidates, the best of which is the answer.
#[derive(Debug)]
pub struct Search<'a> {
    /// Problem and settings of the polish.
    pub polish: Polish<'a>,
    /// Greatest natural residual, free of units, of a solution.
    pub acceptance: f64,
    /// Memory.
    pub scratch: &'a mut Scratch,
    /// Work so far; its method is that of the stage that runs.
    pub stats: SolveStats,
    /// The candidate of least residual.
    pub best: Option<Polished>,
    /// The stage that found it.
    answered: Method,
}

impl<'a> Search<'a> {
    /// Before the first stage, the active-set loop.
    #[must_use]
    pub fn new(polish: Polish<'a>, acceptance: f64, scratch: &'a mut Scratch) -> Self {
        let answered = Method::ActiveSet;
        let stats = SolveStats { method: answered, ..SolveStats::default() };
        Self { polish, acceptance, scratch, stats, best: None, answered }
    }
}

impl Search<'_> {
    /// Least natural residual so far; infinite if there is no candidate.
    #[must_use]
    pub fn residual(&self) -> f64 {
        self.best.as_ref().map_or(f64::INFINITY, Polished::max)
    }

    /// Whether the best candidate is a solution, if not as good a one as was asked for.
    #[must_use]
    pub fn is_accepted(&self) -> bool {
        self.residual() <= self.acceptance
    }

    /// Takes a candidate into account; true if it is good enough to stop.
    pub fn offer(&mut self, candidate: Polished) -> bool {
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

    /// Offers what [`Polish::modes`] makes of modes.
    pub fn offer_modes(&mut self, modes: &[Mode], start: Option<&[f64]>) -> bool {
        let candidate = self.polish.modes(modes, start, self.scratch);
        self.offer(candidate)
    }

    /// Offers what [`Polish::approximate`] makes of an approximate solution.
    pub fn offer_approximate(&mut self, approximate: &LcpSolution) -> bool {
        let candidate = self.polish.approximate(approximate, self.scratch);
        candidate.is_some_and(|candidate| self.offer(candidate))
    }

    /// Offers a guess, if it is one of this problem.
    pub fn offer_guess(&mut self, guess: &Guess) -> bool {
        let rows = self.polish.problem.rows.len();
        let usable = guess.impulses.len() == rows && guess.impulses.iter().all(|y| y.is_finite());
        let start = usable.then_some(&guess.impulses[..]);
        guess.modes.len() == rows && self.offer_modes(&guess.modes, start)
    }

    /// Offers what walks along active sets end in.
    pub fn walk(&mut self) -> bool {
        self.stats.method = Method::Walk;
        let mut scratch = std::mem::take(self.scratch);
        let found = walks(self.polish, &mut scratch).any(|(candidate, factorisations)| {
            self.stats.factorisations += factorisations;
            candidate.is_some_and(|candidate| self.offer(candidate))
        });
        *self.scratch = scratch;
        found
    }

    /// The best candidate, with the stage that found it and all work.
    ///
    /// # Errors
    /// [`LcpError::NotConverged`] if none is a solution.
    pub fn finish(self) -> Result<LcpSolution, LcpError> {
        let (iterations, residual) = (self.stats.iterations, self.residual());
        let accepted = residual <= self.acceptance;
        match self.best {
            Some(best) if accepted || self.polish.reached(&best) => {
                let stats = SolveStats { method: self.answered, ..self.stats };
                Ok(LcpSolution { stats, ..best.solution })
            }
            _ => Err(LcpError::NotConverged { iterations, residual }),
        }
    }
}
