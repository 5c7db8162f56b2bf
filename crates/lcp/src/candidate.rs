//! From modes to a candidate: one linear system, its solution, and the residual of that.

use std::sync::Arc;

use crate::{
    ActiveSystem, Law, Lcp, LcpSolution, Metric, Mode, Polish, Reduced, Residual, Scratch,
    SolveStats,
};

/// Unilateral impulses that are negative by less than this, relative to s*, are zero.
const ROUNDED: f64 = 1e-13;
/// No rounding excuses a residual above this.
const MOST_ROUNDING: f64 = 1e-11;
/// Equations that leave more than this contradict each other, or were not solved well.
const DOUBTFUL: f64 = 1e-9;

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

    pub(crate) fn better(self, other: Option<Self>) -> Self {
        match other {
            Some(other) if other.max() <= self.max() => other,
            _ => self,
        }
    }
}

impl Polish<'_> {
    /// The candidate that the modes imply.
    pub(crate) fn evaluate(
        &self,
        modes: &[Mode],
        start: Option<&[f64]>,
        scratch: &mut Scratch,
    ) -> Polished {
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
    pub(crate) fn stiff(&self, found: Polished, scratch: &mut Scratch) -> Polished {
        if self.reached(&found) || found.max() > self.near_miss {
            return found;
        }
        match self.solved_stiff(&found, scratch) {
            Some(mut stiff) if stiff.max() < found.max() => {
                stiff.solution.stats.factorisations += found.solution.stats.factorisations;
                stiff
            }
            _ => found,
        }
    }

    /// The same modes by the dense system.
    pub(crate) fn solved_stiff(&self, found: &Polished, scratch: &mut Scratch) -> Option<Polished> {
        let system = found.solution.system.as_ref()?;
        let reduced = system.solve_stiff(self.problem)?;
        Some(self.assemble(system, &found.solution.modes, reduced, scratch))
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
            central: None,
        };
        Polished { solution, residual }
    }

    /// Unilateral impulses that are negative by rounding only become zero.
    fn lift(&self, impulses: &mut [f64]) {
        for (row, impulse) in impulses.iter_mut().enumerate() {
            let rounding = || self.metric.true_impulse(row, ROUNDED * self.metric.scale);
            if *impulse < 0.0
                && self.problem.rows[row].law == Law::Unilateral
                && *impulse >= -rounding()
            {
                *impulse = 0.0;
            }
        }
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
