//! From a guess of the modes to an exact solution: a short primal-dual active-set loop on
//! [`ActiveSystem`](crate::ActiveSystem).
//!
//! Every backend ends with it; it is the warm start; it leaves the factorisation that the
//! derivative needs. It claims nothing: a result carries the natural residual of what it found.

use crate::corrections::{Chain, keep_last_correction};
use crate::modes::Reading;
use crate::{Law, Lcp, LcpSolution, Metric, Mode, Polished, Scratch};

/// A row keeps its mode while it violates it by less than this, relative to s*.
const KEEP: f64 = 1e-13;
/// At the free velocities, contacts that part more slowly than this, relative to s*, count as closed.
const TOUCH: f64 = 1e-9;
/// Residuals up to this are likely to be due to nearly dependent rows.
const NEAR_MISS: f64 = 1e-5;
/// Doubtful contacts are tried released below these impulses, relative to s*.
const RELEASES: [f64; 3] = [0.0, 1e-7, 1e-4];

/// Settings and problem of a polish.
#[derive(Clone, Copy, Debug)]
pub struct Polish<'a> {
    /// The problem.
    pub problem: &'a Lcp,
    /// Its metric.
    pub metric: &'a Metric,
    /// Natural residual at which to stop.
    pub target: f64,
    /// Greatest number of corrections of the modes per attempt.
    pub max_flips: u32,
    /// Greatest natural residual at which the dense system is tried, which tells nearly dependent
    /// rows apart; [`Polish::new`] takes 1e-5.
    pub near_miss: f64,
}

impl<'a> Polish<'a> {
    /// A polish of `problem` that stops at `target`.
    #[must_use]
    pub fn new(problem: &'a Lcp, metric: &'a Metric, target: f64, max_flips: u32) -> Self {
        Self { problem, metric, target, max_flips, near_miss: NEAR_MISS }
    }
}

impl Polish<'_> {
    /// Whether the candidate's residual is at the target, or at rounding.
    #[must_use]
    pub fn reached(&self, candidate: &Polished) -> bool {
        let residual = candidate.max();
        residual <= self.target || residual <= candidate.rounding(self.metric)
    }

    /// Polishes an approximate solution, of which impulses and velocities are used. Modes are read
    /// with all closed contacts first, then with the doubtful ones released. Returns the best
    /// candidate found if it reaches the target or its residual is below that of the approximate
    /// solution.
    #[must_use]
    pub fn approximate(
        &self,
        approximate: &LcpSolution,
        scratch: &mut Scratch,
    ) -> Option<Polished> {
        let before = self.problem.residual_with(self.metric, approximate, scratch).max();
        let best = self.read(&approximate.impulses, &approximate.velocities, &RELEASES, scratch)?;
        (best.max() < before || self.reached(&best)).then_some(best)
    }

    /// The same without a comparison, for the release thresholds given.
    fn read(
        &self,
        impulses: &[f64],
        velocities: &[nalgebra::Vector3<f64>],
        releases: &[f64],
        scratch: &mut Scratch,
    ) -> Option<Polished> {
        let slacks = self.problem.remainders(velocities, impulses);
        let reading = self.reading(impulses, &slacks);
        let mut tried: Vec<Vec<Mode>> = Vec::new();
        let mut best: Option<Polished> = None;
        for &release in releases {
            let modes = reading.modes(release, 0.0);
            if tried.contains(&modes) {
                continue;
            }
            best = Some(self.modes(&modes, Some(impulses), scratch).better(best));
            tried.push(modes);
            if best.as_ref().is_some_and(|best| self.reached(best)) {
                break;
            }
        }
        best
    }

    /// Modes of an approximate solution, by its impulses and velocities.
    #[must_use]
    pub fn read_modes(&self, approximate: &LcpSolution) -> Vec<Mode> {
        let slacks = self.problem.remainders(&approximate.velocities, &approximate.impulses);
        self.reading(&approximate.impulses, &slacks).modes(0.0, 0.0)
    }

    /// Modes that a row alone would take at the free velocities. With `slide`, friction slides where
    /// a contact alone would; without, it sticks.
    #[must_use]
    pub fn cold_modes(&self, slide: bool) -> Vec<Mode> {
        let impulses = vec![0.0; self.problem.rows.len()];
        let slacks = self.problem.remainders(&self.problem.free_velocities(), &impulses);
        let mut modes = self.reading(&impulses, &slacks).modes(0.0, TOUCH);
        if !slide {
            for (mode, row) in modes.iter_mut().zip(&self.problem.rows) {
                if matches!(row.law, Law::Friction { .. }) && *mode != Mode::Open {
                    *mode = Mode::Active;
                }
            }
        }
        modes
    }

    /// Starts from modes: solves, corrects the violated ones together, and one at a time once the
    /// modes repeat; returns the best candidate. `start` is an impulse per row, near which those of
    /// dependent rows are sought if the smallest ones break a law.
    ///
    /// Block corrections can cycle even for P-matrices (Ben Gharbia & Gilbert 2012); single
    /// corrections of the last violated row cannot (Murty 1974).
    #[must_use]
    pub fn modes(&self, modes: &[Mode], start: Option<&[f64]>, scratch: &mut Scratch) -> Polished {
        let first = self.evaluate(modes, start, scratch);
        let found = if self.reached(&first) {
            first
        } else {
            let corrected = self.corrected(first, modes, start, scratch);
            self.stiff(corrected, scratch)
        };
        self.released(found, scratch)
    }

    /// The best candidate of a chain of corrections from `first`, which has these modes.
    fn corrected(
        &self,
        first: Polished,
        modes: &[Mode],
        start: Option<&[f64]>,
        scratch: &mut Scratch,
    ) -> Polished {
        let mut chain = Chain { best: first, last: None };
        let mut seen = std::mem::take(&mut scratch.seen);
        let mut modes = scratch.copy_modes(modes);
        let mut factorisations = chain.best.solution.stats.factorisations;
        let mut single = false;
        for _ in 0..self.max_flips {
            if self.reached(&chain.best) {
                break;
            }
            let mut next = scratch.modes.take();
            let solution = &chain.last().solution;
            let reading = self.reading(&solution.impulses, &solution.slacks);
            reading.correct(&modes, KEEP, &mut next);
            single |= seen.contains(&next);
            if single {
                keep_last_correction(&modes, &mut next);
            }
            let settled = next == modes;
            seen.push(std::mem::replace(&mut modes, next));
            if settled {
                break;
            }
            let candidate = self.evaluate(&modes, start, scratch);
            factorisations += candidate.solution.stats.factorisations;
            chain.add(candidate, scratch);
        }
        seen.push(modes);
        seen.drain(..).for_each(|modes| scratch.modes.give(modes));
        scratch.seen = seen;
        let mut best = chain.end(scratch);
        best.solution.stats.factorisations = factorisations;
        best
    }

    fn reading<'b>(&'b self, impulses: &'b [f64], slacks: &'b [f64]) -> Reading<'b> {
        Reading { problem: self.problem, metric: self.metric, impulses, slacks }
    }
}
