//! Solving a factored system: sweeps against the rows themselves, and the dense system where they stall.

use nalgebra::Vector3;

use crate::equations::{Equations, Side};
use crate::{ActiveSystem, Lcp, Scratch, saddle};

const MAX_SWEEPS: usize = 40;
/// A sweep that leaves more than this share of the defect is at rounding, or at a contradiction.
const STALLED: f64 = 0.8;
/// Defects, relative to the right-hand side, that are rounding.
const ROUNDING: f64 = 2e-16;
/// Sweeps converge linearly: what the next one would find below this, relative to the right-hand side,
/// is not looked at.
const SURE: f64 = 1e-18;
/// Above this defect the dense system is tried.
const STIFF: f64 = 1e-11;

/// Unknowns of a reduced system.
#[derive(Clone, Debug, Default)]
pub struct Reduced {
    /// v, or its adjoint, per body.
    pub velocities: Vec<Vector3<f64>>,
    /// y, or its adjoint, per active row in the order of [`ActiveSystem::rows`].
    pub impulses: Vec<f64>,
    /// What the equations of the active rows leave over, relative to the right-hand side; above
    /// rounding only if dependent rows contradict each other.
    pub defect: f64,
}

impl ActiveSystem {
    /// Velocities and impulses that the modes imply. `start` (an impulse per row of the problem)
    /// chooses among the impulses where rows depend on each other: those nearest to it.
    #[must_use]
    pub fn solve(&self, problem: &Lcp, start: Option<&[f64]>) -> Reduced {
        let (mut scratch, mut found) = (Scratch::default(), Reduced::default());
        self.gather(problem, &mut scratch.equations);
        self.solve_gathered(problem, start, &mut scratch, &mut found);
        found
    }

    /// The same for a system whose equations are in `scratch`.
    pub(crate) fn solve_gathered(
        &self,
        problem: &Lcp,
        start: Option<&[f64]>,
        scratch: &mut Scratch,
        found: &mut Reduced,
    ) {
        let mut momentum = scratch.vectors.take();
        momentum.extend_from_slice(&problem.momentum);
        for &(row, impulse) in &self.saturated {
            problem.rows[row as usize].add_transposed(impulse, &mut momentum);
        }
        let mut rhs = scratch.floats.take();
        rhs.extend(scratch.equations.rows.iter().map(|row| row.rhs));
        found.impulses.clear();
        match start {
            Some(impulses) => {
                let weigh =
                    |(row, inverse): (&u32, &f64)| impulses[*row as usize] / (self.unit * inverse);
                found.impulses.extend(self.rows.iter().zip(&self.inverse).map(weigh));
            }
            None => found.impulses.resize(self.rows.len(), 0.0),
        }
        self.refine(Side::Forward, &momentum, &rhs, SURE, scratch, found);
        scratch.vectors.give(momentum);
        scratch.floats.give(rhs);
    }

    /// As [`solve`](Self::solve) by a dense pseudo-inverse of the whole system, for nearly dependent
    /// rows that S cannot tell apart; `None` if the problem is too large for it.
    #[must_use]
    pub fn solve_stiff(&self, problem: &Lcp) -> Option<Reduced> {
        if !saddle::takes(problem.mass.len(), self.rows.len()) {
            return None;
        }
        let mut momentum = problem.momentum.clone();
        for &(row, impulse) in &self.saturated {
            problem.rows[row as usize].add_transposed(impulse, &mut momentum);
        }
        let mut equations = Equations::default();
        self.gather(problem, &mut equations);
        let rhs: Vec<f64> = equations.rows.iter().map(|row| row.rhs).collect();
        self.refine_stiff(&equations, Side::Forward, &momentum, &rhs)
    }

    /// Solves M v − Cᵀ y = `momentum`, B v + c y = `rhs` (one entry per active row).
    #[must_use]
    pub fn solve_with(&self, problem: &Lcp, momentum: &[Vector3<f64>], rhs: &[f64]) -> Reduced {
        let mut found = Reduced::default();
        self.best(problem, Side::Forward, momentum, rhs, &mut Scratch::default(), &mut found);
        found
    }

    /// Solves the transposed system, M v + Bᵀ y = `momentum`, −C v + c y = `rhs`.
    #[must_use]
    pub fn solve_transpose(
        &self,
        problem: &Lcp,
        momentum: &[Vector3<f64>],
        rhs: &[f64],
    ) -> Reduced {
        let mut found = Reduced::default();
        self.solve_transpose_into(problem, momentum, rhs, &mut Scratch::default(), &mut found);
        found
    }

    /// The same with memory that is used again.
    pub fn solve_transpose_into(
        &self,
        problem: &Lcp,
        momentum: &[Vector3<f64>],
        rhs: &[f64],
        scratch: &mut Scratch,
        found: &mut Reduced,
    ) {
        self.best(problem, Side::Transposed, momentum, rhs, scratch, found);
    }

    /// The refined solution, or that of the dense system where refinement does not converge.
    fn best(
        &self,
        problem: &Lcp,
        side: Side,
        momentum: &[Vector3<f64>],
        rhs: &[f64],
        scratch: &mut Scratch,
        found: &mut Reduced,
    ) {
        self.gather(problem, &mut scratch.equations);
        let mut weighted = scratch.floats.take();
        weighted.extend(rhs.iter().zip(&self.inverse).map(|(b, inverse)| b * inverse));
        found.impulses.clear();
        found.impulses.resize(self.rows.len(), 0.0);
        // Derivatives along dependent rows are worth every sweep.
        let sure = if self.rank_defect == 0 { SURE } else { 0.0 };
        self.refine(side, momentum, &weighted, sure, scratch, found);
        if found.defect > STIFF || found.defect.is_nan() {
            let stiff = self.refine_stiff(&scratch.equations, side, momentum, &weighted);
            if let Some(stiff) = stiff.filter(|stiff| stiff.defect < found.defect) {
                *found = stiff;
            }
        }
        scratch.floats.give(weighted);
    }

    fn refine_stiff(
        &self,
        equations: &Equations,
        side: Side,
        momentum: &[Vector3<f64>],
        rhs: &[f64],
    ) -> Option<Reduced> {
        let momentum: Vec<_> = momentum.iter().map(|p| p / self.unit).collect();
        let mut found = saddle::solve(equations, side, &momentum, rhs)?;
        self.unweigh(&mut found.impulses);
        Some(found)
    }

    /// Sweeps from the impulses ŷ that are in `found`; leaves true impulses. A defect that the next sweep
    /// would bring below `sure` is not looked at.
    fn refine(
        &self,
        side: Side,
        momentum: &[Vector3<f64>],
        rhs: &[f64],
        sure: f64,
        scratch: &mut Scratch,
        found: &mut Reduced,
    ) {
        let equations = std::mem::take(&mut scratch.equations);
        let (bodies, slots) = (momentum.len(), self.rows.len());
        let (y, v) = (&mut found.impulses, &mut found.velocities);
        let mut z = scratch.vectors.filled(bodies + 1, Vector3::zeros());
        let per_unit = self.unit.recip();
        for (z, p) in z.iter_mut().zip(momentum) {
            *z = p * per_unit;
        }
        let scale = equations.scale(&z, rhs);
        v.clear();
        v.resize(bodies + 1, Vector3::zeros());
        if y.iter().any(|y| *y != 0.0) {
            equations.add_impulses(side, y, &mut z);
        }
        equations.advance(&mut z, v);
        let mut r = scratch.floats.filled(slots, 0.0);
        let (mut previous, mut defect) = (f64::INFINITY, 0.0);
        for sweep in 0..MAX_SWEEPS {
            defect = equations.remainder(side, rhs, v, y, &mut r);
            if defect <= ROUNDING * scale || (sweep >= 2 && defect > STALLED * previous) {
                break;
            }
            self.factor.solve(side, &equations, &mut r, scratch);
            y.iter_mut().zip(&r).for_each(|(y, dy)| *y += dy);
            equations.add_impulses(side, &r, &mut z);
            equations.advance(&mut z, v);
            let ahead = defect * (defect / previous);
            if sweep > 0 && ahead <= sure * scale {
                defect = ahead;
                break;
            }
            previous = defect;
        }
        v.truncate(bodies);
        found.defect = relative(defect, scale);
        self.unweigh(&mut found.impulses);
        scratch.floats.give(r);
        scratch.vectors.give(z);
        scratch.equations = equations;
    }

    /// Impulses from ŷ.
    fn unweigh(&self, y: &mut [f64]) {
        for (y, inverse) in y.iter_mut().zip(&self.inverse) {
            *y *= self.unit * inverse;
        }
    }
}

/// A defect relative to the right-hand side; 0 where both are too small for normal numbers, as
/// what a sticking contact lets through is after some twenty steps.
pub(crate) fn relative(defect: f64, scale: f64) -> f64 {
    if defect < f64::MIN_POSITIVE { 0.0 } else { defect / scale }
}
