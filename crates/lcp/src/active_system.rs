//! The equations that remain once every row's mode is known.
//!
//! ```text
//!  B = J of the active rows
//!  C = J of the active rows, with  ± μ J_t  of a sliding friction row added to its normal's row
//!
//!  M v − Cᵀ y = p + Jᵀ (impulses of saturated motors)
//!  B v + c y  = b
//!
//!  S = B M⁻¹ Cᵀ + diag(c)          S y = b − B M⁻¹ p
//! ```
//!
//! S is symmetric unless a contact slides. Dependent rows make it singular, though v stays unique;
//! therefore only Ŝ + ε I is factored (Ŝ: S scaled by 1/√Wᵢᵢ from both sides), by rows or by bodies,
//! whichever is cheaper, and y is refined against S itself, v along with it (proximal point;
//! Rockafellar 1976). The refined y is the starting value plus the smallest change: from zero, the
//! impulses of least norm.
//!
//! The derivative of the solution solves with the same matrix and with its transpose.

use nalgebra::Vector3;

use crate::block_factor::BlockFactor;
use crate::cholesky::Cholesky;
use crate::equations::{Equations, Side};
use crate::factor::Factor;
use crate::{Law, Lcp, Metric, Mode, Scratch, order, saddle};

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

/// The reduced system of one problem and one choice of modes, factored.
#[derive(Clone, Debug, Default)]
pub struct ActiveSystem {
    pub(crate) rows: Vec<u32>,
    pub(crate) folds: Vec<Fold>,
    saturated: Vec<(u32, f64)>,
    /// 1/√(μ Wᵢᵢ) per slot.
    pub(crate) inverse: Vec<f64>,
    /// μ.
    pub(crate) unit: f64,
    pub(crate) factor: Factor,
    rank_defect: u32,
}

/// Up to so many active rows a second attempt by rows is affordable.
const MOST_ROWS: usize = 400;

/// What is eliminated first.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Elimination {
    /// Bodies or rows, whichever costs less.
    Cheapest,
    /// Rows.
    Rows,
}

/// A sliding friction row: its impulse is `coefficient` times that of slot `column`.
#[derive(Clone, Copy, Debug)]
pub struct Fold {
    /// Row of the friction.
    pub row: u32,
    /// Position of its normal row among [`ActiveSystem::rows`].
    pub column: u32,
    /// +μ for [`Mode::Upper`], −μ for [`Mode::Lower`].
    pub coefficient: f64,
}

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
    /// Assembles and factors. Friction of a normal row that is not active is open whatever its mode.
    #[must_use]
    pub fn new(problem: &Lcp, metric: &Metric, modes: &[Mode]) -> Self {
        let mut system = Self::default();
        system.renew(problem, metric, modes, &mut Scratch::default());
        system
    }

    /// All rows in this order; nothing is factored.
    pub(crate) fn of_all(rows: Vec<u32>, metric: &Metric) -> Self {
        Self { rows, unit: metric.unit(), ..Self::default() }
    }

    /// Becomes the system of equalities only, which are factored already.
    pub(crate) fn become_factored(
        &mut self,
        metric: &Metric,
        cholesky: Cholesky,
        scratch: &mut Scratch,
    ) {
        std::mem::replace(&mut self.factor, Factor::Symmetric(cholesky)).give(scratch);
        let rows = &metric.equations.rows;
        self.unit = metric.unit();
        self.rank_defect = 0;
        self.folds.clear();
        self.saturated.clear();
        self.rows.clear();
        self.rows.extend((0_u32..).take(rows.len()));
        self.inverse.clear();
        self.inverse.extend(rows.iter().map(|row| row.inverse));
    }

    /// Becomes the system of other modes, or of another problem, in the same memory. The equations
    /// stay in `scratch`.
    pub(crate) fn renew(
        &mut self,
        problem: &Lcp,
        metric: &Metric,
        modes: &[Mode],
        scratch: &mut Scratch,
    ) {
        self.renew_by(Elimination::Cheapest, problem, metric, modes, scratch);
    }

    /// The same by the rows, with exchanges, where sliding friction may have spoilt an elimination by
    /// bodies and the problem is not too large for it; whether that was so.
    pub(crate) fn renew_by_rows(
        &mut self,
        problem: &Lcp,
        metric: &Metric,
        modes: &[Mode],
        scratch: &mut Scratch,
    ) -> bool {
        let by_bodies = matches!(self.factor, Factor::Bodies(_)) && !self.folds.is_empty();
        if by_bodies && self.rows.len() <= MOST_ROWS {
            self.renew_by(Elimination::Rows, problem, metric, modes, scratch);
            return true;
        }
        false
    }

    fn renew_by(
        &mut self,
        elimination: Elimination,
        problem: &Lcp,
        metric: &Metric,
        modes: &[Mode],
        scratch: &mut Scratch,
    ) {
        std::mem::take(&mut self.factor).give(scratch);
        self.unit = metric.unit();
        list_active(problem, modes, &mut self.rows);
        list_saturated(problem, modes, &mut self.saturated);
        list_folds(problem, modes, &self.rows, &mut self.folds, scratch);
        let mut equations = std::mem::take(&mut scratch.equations);
        let width = order::half_width(problem, &self.rows, &mut scratch.spans);
        let chosen = match elimination {
            Elimination::Cheapest => metric.pattern(self.rows.len(), width, !self.folds.is_empty()),
            Elimination::Rows => None,
        };
        // Rows as they come were found cheap.
        let cheap =
            elimination == Elimination::Cheapest && chosen.is_none() && metric.has_pattern();
        self.factor = match chosen {
            Some(pattern) => {
                equations.gather(problem, metric, self);
                equations.find_runs(problem, &self.rows);
                BlockFactor::new(pattern, &equations, scratch).map_or(Factor::None, Factor::Bodies)
            }
            None => Factor::None,
        };
        if matches!(self.factor, Factor::None) {
            let width =
                if cheap { width } else { order::narrow(problem, &mut self.rows, width, scratch) };
            list_folds(problem, modes, &self.rows, &mut self.folds, scratch);
            equations.gather(problem, metric, self);
            self.factor = if self.rows.len() == problem.rows.len() && problem.is_linear() {
                Factor::of_equalities(&equations, width, scratch)
            } else {
                Factor::of_rows(&equations, width, scratch)
            };
        }
        self.inverse.clear();
        self.inverse.extend(equations.rows.iter().map(|row| row.inverse));
        self.rank_defect = self.factor.rank_defect(self.rows.len());
        scratch.equations = equations;
    }

    /// The active rows, in the order of elimination.
    #[must_use]
    pub fn rows(&self) -> &[u32] {
        &self.rows
    }

    /// The sliding friction rows.
    #[must_use]
    pub fn folds(&self) -> &[Fold] {
        &self.folds
    }

    /// Saturated motors: row and impulse ±max, N·s or N·m·s.
    #[must_use]
    pub fn saturated(&self) -> &[(u32, f64)] {
        &self.saturated
    }

    /// Whether every row is far from depending on the others, so that softer rows would change little;
    /// known of systems that are eliminated by rows and do not slide.
    #[must_use]
    pub fn is_regular(&self) -> bool {
        const FAR: f64 = 1e-3;
        matches!(&self.factor, Factor::Symmetric(cholesky) if cholesky.count_below(FAR) == 0)
    }

    /// How many active rows depend on the others; then single impulses are not unique.
    #[must_use]
    pub fn rank_defect(&self) -> u32 {
        self.rank_defect
    }

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

    /// Impulses of all rows of the problem from those of the active ones.
    #[must_use]
    pub fn spread(&self, problem: &Lcp, reduced: &[f64]) -> Vec<f64> {
        let mut impulses = Vec::new();
        self.spread_into(problem, reduced, &mut impulses);
        impulses
    }

    pub(crate) fn spread_into(&self, problem: &Lcp, reduced: &[f64], impulses: &mut Vec<f64>) {
        impulses.clear();
        impulses.resize(problem.rows.len(), 0.0);
        for (&row, y) in self.rows.iter().zip(reduced) {
            impulses[row as usize] = *y;
        }
        for fold in &self.folds {
            impulses[fold.row as usize] = fold.coefficient * reduced[fold.column as usize];
        }
        for &(row, impulse) in &self.saturated {
            impulses[row as usize] = impulse;
        }
    }

    fn gather(&self, problem: &Lcp, equations: &mut Equations) {
        equations.gather_again(problem, self);
        if matches!(self.factor, Factor::Bodies(_)) {
            equations.find_runs(problem, &self.rows);
        }
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
        for (z, p) in z.iter_mut().zip(momentum) {
            *z = p / self.unit;
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

#[expect(clippy::cast_possible_truncation, reason = "row indices are u32")]
fn list_active(problem: &Lcp, modes: &[Mode], rows: &mut Vec<u32>) {
    let active = |&row: &usize| match problem.rows[row].law {
        Law::Equality => true,
        Law::Unilateral | Law::Bounded { .. } => modes[row] == Mode::Active,
        Law::Friction { normal, .. } => {
            modes[row] == Mode::Active && modes[normal as usize] == Mode::Active
        }
    };
    rows.clear();
    rows.extend((0..problem.rows.len()).filter(active).map(|row| row as u32));
}

/// ±1 for a row on a bound.
fn direction(mode: Mode) -> Option<f64> {
    match mode {
        Mode::Upper => Some(1.0),
        Mode::Lower => Some(-1.0),
        Mode::Active | Mode::Open => None,
    }
}

#[expect(clippy::cast_possible_truncation, reason = "row indices are u32")]
fn list_folds(
    problem: &Lcp,
    modes: &[Mode],
    rows: &[u32],
    folds: &mut Vec<Fold>,
    scratch: &mut Scratch,
) {
    folds.clear();
    for (row, mode) in modes.iter().enumerate() {
        let Law::Friction { normal, mu } = problem.rows[row].law else { continue };
        let Some(sign) = direction(*mode) else { continue };
        if modes[normal as usize] == Mode::Active {
            folds.push(Fold { row: row as u32, column: normal, coefficient: sign * mu });
        }
    }
    if folds.is_empty() {
        return;
    }
    let mut slots = scratch.indices.filled(problem.rows.len(), u32::MAX);
    for (slot, &row) in rows.iter().enumerate() {
        slots[row as usize] = slot as u32;
    }
    for fold in folds {
        fold.column = slots[fold.column as usize];
    }
    scratch.indices.give(slots);
}

#[expect(clippy::cast_possible_truncation, reason = "row indices are u32")]
fn list_saturated(problem: &Lcp, modes: &[Mode], saturated: &mut Vec<(u32, f64)>) {
    saturated.clear();
    saturated.extend(modes.iter().enumerate().filter_map(
        |(row, mode)| match problem.rows[row].law {
            Law::Bounded { max } => direction(*mode).map(|sign| (row as u32, sign * max)),
            _ => None,
        },
    ));
}

/// A defect relative to the right-hand side; 0 where both are too small for normal numbers, as
/// what a sticking contact lets through is after some twenty steps.
pub(crate) fn relative(defect: f64, scale: f64) -> f64 {
    if defect < f64::MIN_POSITIVE { 0.0 } else { defect / scale }
}
