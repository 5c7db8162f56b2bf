//! From a guess of the modes to an exact solution: a short primal-dual active-set loop on
//! [`ActiveSystem`].
//!
//! Every backend ends with it; it is the warm start; it leaves the factorisation that the
//! derivative needs. It claims nothing: a result carries the natural residual of what it found.

use std::sync::Arc;

use crate::modes::Reading;
use crate::{
    ActiveSystem, Law, Lcp, LcpSolution, Metric, Mode, Reduced, Residual, Scratch, SolveStats,
};

/// A row keeps its mode while it violates it by less than this, relative to s*.
const KEEP: f64 = 1e-13;
/// Impulses below this, relative to s*, count as none when a weakly active row is released.
const WEAK: f64 = 1e-10;
/// At the free velocities, contacts that part more slowly than this, relative to s*, count as closed.
const TOUCH: f64 = 1e-9;
/// Residuals up to this are likely to be due to nearly dependent rows.
const NEAR_MISS: f64 = 1e-5;
/// No rounding excuses a residual above this.
const MOST_ROUNDING: f64 = 1e-11;
/// Equations that leave more than this contradict each other, or were not solved well.
const DOUBTFUL: f64 = 1e-9;
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

/// What a polish found.
#[derive(Clone, Debug)]
pub struct Polished {
    /// The candidate, with its modes and factored system.
    pub solution: LcpSolution,
    /// Its natural residual.
    pub residual: Residual,
}

impl Polished {
    /// The residual's greatest part.
    #[must_use]
    pub fn max(&self) -> f64 {
        self.residual.max()
    }

    /// Rounding of impulses ŷ relative to s*: no double-precision candidate has a smaller residual. Along
    /// rows that depend on each other it is larger, the more the more of them share a load.
    #[must_use]
    pub fn rounding(&self, metric: &Metric) -> f64 {
        let depends = |system: &Arc<ActiveSystem>| system.rank_defect() > 0;
        let dependent = self.solution.system.as_ref().is_some_and(depends);
        let digits = if dependent { 256.0 } else { 4.0 };
        let impulses = self.solution.impulses.iter().enumerate();
        let scaled = impulses.map(|(row, impulse)| metric.impulse(row, impulse.abs()));
        metric.relative(digits * f64::EPSILON * scaled.fold(0.0, f64::max)).min(MOST_ROUNDING)
    }

    fn better(self, other: Option<Self>) -> Self {
        match other {
            Some(other) if other.max() <= self.max() => other,
            _ => self,
        }
    }
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
        candidate.max() <= self.target.max(candidate.rounding(self.metric))
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

    /// The candidate that the modes imply.
    fn evaluate(&self, modes: &[Mode], start: Option<&[f64]>, scratch: &mut Scratch) -> Polished {
        let mut system = scratch.system();
        if let Some(system) = Arc::get_mut(&mut system) {
            system.renew(self.problem, self.metric, modes, scratch);
        }
        let (mut least, defect) = self.candidate(&system, modes, None, scratch);
        let again = defect > DOUBTFUL && {
            least.solution.system = None;
            let system = Arc::get_mut(&mut system).expect("nobody else has it");
            system.renew_by_rows(self.problem, self.metric, modes, scratch)
        };
        if again {
            scratch.recycle(least.solution);
            least = self.candidate(&system, modes, None, scratch).0;
        } else {
            least.solution.system = Some(Arc::clone(&system));
        }
        match start {
            Some(start) if system.rank_defect() > 0 && !self.reached(&least) => {
                let near = self.candidate(&system, modes, Some(start), scratch).0;
                let (kept, dropped) =
                    if least.max() <= near.max() { (least, near) } else { (near, least) };
                scratch.recycle(dropped.solution);
                kept
            }
            _ => least,
        }
    }

    /// A candidate, and the defect of its equations.
    fn candidate(
        &self,
        system: &Arc<ActiveSystem>,
        modes: &[Mode],
        start: Option<&[f64]>,
        scratch: &mut Scratch,
    ) -> (Polished, f64) {
        let (velocities, impulses) = (scratch.vectors.take(), scratch.floats.take());
        let mut reduced = Reduced { velocities, impulses, defect: 0.0 };
        system.solve_gathered(self.problem, start, scratch, &mut reduced);
        let defect = reduced.defect;
        (self.assemble(system, modes, reduced, scratch), defect)
    }

    /// Second attempt at a near miss: nearly dependent rows.
    fn stiff(&self, found: Polished, scratch: &mut Scratch) -> Polished {
        if self.reached(&found) || found.max() > self.near_miss {
            return found;
        }
        let stiff = found.solution.system.as_ref().and_then(|system| {
            let reduced = system.solve_stiff(self.problem)?;
            Some(self.assemble(system, &found.solution.modes, reduced, scratch))
        });
        match stiff {
            Some(mut stiff) if stiff.max() < found.max() => {
                stiff.solution.stats.factorisations += found.solution.stats.factorisations;
                stiff
            }
            _ => found,
        }
    }

    fn assemble(
        &self,
        system: &Arc<ActiveSystem>,
        modes: &[Mode],
        reduced: Reduced,
        scratch: &mut Scratch,
    ) -> Polished {
        let problem = self.problem;
        let mut impulses = scratch.floats.take();
        system.spread_into(problem, &reduced.impulses, &mut impulses);
        scratch.floats.give(reduced.impulses);
        self.lift(&mut impulses);
        let (mut slacks, mut own_modes) = (scratch.floats.take(), scratch.modes.take());
        let residual =
            problem.assess(self.metric, &reduced.velocities, &impulses, &mut slacks, scratch);
        list_effective(problem, modes, &mut own_modes);
        let solution = LcpSolution {
            velocities: reduced.velocities,
            impulses,
            slacks,
            modes: own_modes,
            stats: SolveStats { factorisations: 1, ..SolveStats::default() },
            system: Some(Arc::clone(system)),
        };
        Polished { solution, residual }
    }

    /// Unilateral impulses that are negative by rounding only become zero.
    fn lift(&self, impulses: &mut [f64]) {
        for (row, impulse) in impulses.iter_mut().enumerate() {
            let rounding = self.metric.true_impulse(row, KEEP * self.metric.scale);
            if *impulse < 0.0
                && *impulse >= -rounding
                && self.problem.rows[row].law == Law::Unilateral
            {
                *impulse = 0.0;
            }
        }
    }

    /// Prefers the released mode of weakly active rows: contacts without impulse are open, friction
    /// and motors on their bound slide. Kept only if it solves the problem as well.
    fn released(&self, found: Polished, scratch: &mut Scratch) -> Polished {
        if !self.reached(&found) {
            return found;
        }
        let mut modes = scratch.modes.take();
        if !self.list_released(&found.solution, &mut modes) {
            scratch.modes.give(modes);
            return found;
        }
        let mut released = self.evaluate(&modes, Some(&found.solution.impulses), scratch);
        scratch.modes.give(modes);
        released.solution.stats.factorisations += found.solution.stats.factorisations;
        let (kept, dropped) =
            if self.reached(&released) { (released, found) } else { (found, released) };
        scratch.recycle(dropped.solution);
        kept
    }

    /// The released modes; whether they are others.
    fn list_released(&self, solution: &LcpSolution, modes: &mut Vec<Mode>) -> bool {
        modes.extend_from_slice(&solution.modes);
        let mut changes = false;
        for (i, row) in self.problem.rows.iter().enumerate() {
            if modes[i] != Mode::Active || row.law == Law::Equality {
                continue;
            }
            let y = self.metric.impulse(i, solution.impulses[i]);
            let bound = self.metric.bound(row.law, i, &solution.impulses);
            modes[i] = match row.law {
                Law::Unilateral if y <= WEAK * self.metric.scale => Mode::Open,
                Law::Friction { normal, .. } if modes[normal as usize] == Mode::Open => Mode::Open,
                Law::Bounded { .. } | Law::Friction { .. }
                    if y.abs() >= bound - WEAK * self.metric.scale =>
                {
                    if y > 0.0 {
                        Mode::Upper
                    } else {
                        Mode::Lower
                    }
                }
                _ => Mode::Active,
            };
            changes |= modes[i] != Mode::Active;
        }
        changes
    }

    fn reading<'b>(&'b self, impulses: &'b [f64], slacks: &'b [f64]) -> Reading<'b> {
        Reading { problem: self.problem, metric: self.metric, impulses, slacks }
    }
}

/// Candidates one after another: the best and, if it is another, the last.
struct Chain {
    best: Polished,
    last: Option<Polished>,
}

impl Chain {
    fn last(&self) -> &Polished {
        self.last.as_ref().unwrap_or(&self.best)
    }

    fn add(&mut self, candidate: Polished, scratch: &mut Scratch) {
        let dropped = if candidate.max() < self.best.max() {
            let before = std::mem::replace(&mut self.best, candidate);
            scratch.recycle(before.solution);
            self.last.take()
        } else {
            self.last.replace(candidate)
        };
        if let Some(dropped) = dropped {
            scratch.recycle(dropped.solution);
        }
    }

    fn end(self, scratch: &mut Scratch) -> Polished {
        if let Some(last) = self.last {
            scratch.recycle(last.solution);
        }
        self.best
    }
}

/// Leaves only the last difference between `modes` and `next`.
fn keep_last_correction(modes: &[Mode], next: &mut [Mode]) {
    if let Some(row) = (0..modes.len()).rev().find(|&row| modes[row] != next[row]) {
        next[..row].copy_from_slice(&modes[..row]);
    }
}

/// The modes that the reduced system really has: equalities active, friction of open contacts open.
fn list_effective(problem: &Lcp, modes: &[Mode], effective: &mut Vec<Mode>) {
    let mode = |(row, &mode): (&crate::Row, &Mode)| match row.law {
        Law::Equality => Mode::Active,
        Law::Unilateral => {
            if mode == Mode::Active {
                mode
            } else {
                Mode::Open
            }
        }
        Law::Bounded { .. } => mode,
        Law::Friction { normal, .. } => {
            if modes[normal as usize] == Mode::Active && mode != Mode::Open {
                mode
            } else {
                Mode::Open
            }
        }
    };
    effective.extend(problem.rows.iter().zip(modes).map(mode));
}
