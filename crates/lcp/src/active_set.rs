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
//! therefore only Ŝ + ε I is factored (Ŝ: S scaled by 1/√Wᵢᵢ from both sides) and y is refined
//! against S itself, v along with it (proximal point; Rockafellar 1976). The refined y is the
//! starting value plus the smallest change: from zero, the impulses of least norm.
//!
//! The derivative of the solution solves with the same matrix and with its transpose.

#![expect(non_snake_case, reason = "matrices carry their names from the notes")]

use nalgebra::{DVector, Vector3};

use crate::band::{BandMatrix, Cholesky, Lu};
use crate::delassus::{Assembly, Scaling};
use crate::order;
use crate::saddle::Saddle;
use crate::{Law, Lcp, Metric, Mode};

/// ε: dependent rows stay solvable, independent ones converge in two or three sweeps. Impulses along
/// dependent directions carry a noise of 10⁻¹⁶/ε; larger values cost sweeps under mass ratios.
const PROXIMAL: f64 = 1e-9;
const MAX_SWEEPS: usize = 40;
/// A sweep that leaves more than this share of the defect is at rounding, or at a contradiction.
const STALLED: f64 = 0.8;
/// Above this defect the dense system is tried.
const STIFF: f64 = 1e-11;
const STIFF_SWEEPS: usize = 3;

/// The reduced system of one problem and one choice of modes, factored.
#[derive(Clone, Debug)]
pub struct ActiveSystem {
    rows: Vec<u32>,
    folds: Vec<Fold>,
    saturated: Vec<(u32, f64)>,
    scaling: Scaling,
    factor: Factor,
    rank_defect: u32,
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

#[derive(Clone, Debug)]
enum Factor {
    Symmetric(Cholesky),
    General(Lu),
}

/// Unknowns of a reduced system.
#[derive(Clone, Debug)]
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
        let mut rows = active_rows(problem, modes);
        let half_width = order::narrow(problem, &mut rows);
        let folds = folds(problem, modes, &rows);
        let saturated = saturated(problem, modes);
        let scaling = Scaling::new(metric, &rows);
        let factor = factor(problem, &rows, &folds, &scaling, half_width);
        let rank_defect = factor.small_pivots();
        Self { rows, folds, saturated, scaling, factor, rank_defect }
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

    /// How many active rows depend on the others; then single impulses are not unique.
    #[must_use]
    pub fn rank_defect(&self) -> u32 {
        self.rank_defect
    }

    /// Velocities and impulses that the modes imply. `start` (an impulse per row of the problem)
    /// chooses among the impulses where rows depend on each other: those nearest to it.
    #[must_use]
    pub fn solve(&self, problem: &Lcp, start: Option<&[f64]>) -> Reduced {
        let (momentum, rhs) = self.right_side(problem);
        let start = match start {
            Some(impulses) => self.rows.iter().map(|&row| impulses[row as usize]).collect(),
            None => vec![0.0; self.rows.len()],
        };
        self.refine(problem, Side::Forward, &momentum, &rhs, start)
    }

    /// As [`solve`](Self::solve) by a dense pseudo-inverse of the whole system, for nearly dependent
    /// rows that S cannot tell apart; `None` if the problem is too large for it.
    #[must_use]
    pub fn solve_stiff(&self, problem: &Lcp) -> Option<Reduced> {
        let (momentum, rhs) = self.right_side(problem);
        self.refine_stiff(problem, Side::Forward, &momentum, &rhs)
    }

    /// Solves M v − Cᵀ y = `momentum`, B v + c y = `rhs` (one entry per active row).
    #[must_use]
    pub fn solve_with(&self, problem: &Lcp, momentum: &[Vector3<f64>], rhs: &[f64]) -> Reduced {
        self.best(problem, Side::Forward, momentum, rhs)
    }

    /// Solves the transposed system, M v + Bᵀ y = `momentum`, −C v + c y = `rhs`.
    #[must_use]
    pub fn solve_transpose(
        &self,
        problem: &Lcp,
        momentum: &[Vector3<f64>],
        rhs: &[f64],
    ) -> Reduced {
        self.best(problem, Side::Transposed, momentum, rhs)
    }

    /// Impulses of all rows of the problem from those of the active ones.
    #[must_use]
    pub fn spread(&self, problem: &Lcp, reduced: &[f64]) -> Vec<f64> {
        let mut impulses = vec![0.0; problem.rows.len()];
        for (&row, &y) in self.rows.iter().zip(reduced) {
            impulses[row as usize] = y;
        }
        for fold in &self.folds {
            impulses[fold.row as usize] = fold.coefficient * reduced[fold.column as usize];
        }
        for &(row, impulse) in &self.saturated {
            impulses[row as usize] = impulse;
        }
        impulses
    }

    /// p with the impulses of saturated motors, and b of the active rows.
    fn right_side(&self, problem: &Lcp) -> (Vec<Vector3<f64>>, Vec<f64>) {
        let mut momentum = problem.momentum.clone();
        for &(row, impulse) in &self.saturated {
            problem.rows[row as usize].add_transposed(impulse, &mut momentum);
        }
        let rhs = self.rows.iter().map(|&row| problem.rows[row as usize].rhs).collect();
        (momentum, rhs)
    }

    /// The refined solution, or that of the dense system where refinement does not converge.
    fn best(&self, problem: &Lcp, side: Side, momentum: &[Vector3<f64>], rhs: &[f64]) -> Reduced {
        let refined = self.refine(problem, side, momentum, rhs, vec![0.0; self.rows.len()]);
        if refined.defect <= STIFF {
            return refined;
        }
        match self.refine_stiff(problem, side, momentum, rhs) {
            Some(stiff) if stiff.defect < refined.defect => stiff,
            _ => refined,
        }
    }

    fn refine_stiff(
        &self,
        problem: &Lcp,
        side: Side,
        momentum: &[Vector3<f64>],
        rhs: &[f64],
    ) -> Option<Reduced> {
        let saddle = Saddle::new(problem, &self.rows, &self.folds, &self.scaling)?;
        let (bodies, slots, unit) = (problem.mass.len(), self.rows.len(), self.scaling.unit);
        let mut found = Reduced {
            velocities: vec![Vector3::zeros(); bodies],
            impulses: vec![0.0; slots],
            defect: f64::INFINITY,
        };
        let mut r = vec![0.0; slots];
        for _ in 0..STIFF_SWEEPS {
            let mut balance = momentum.to_vec();
            self.add_impulses(problem, side, &found.impulses, &mut balance);
            self.remainder(problem, side, &found.velocities, rhs, &found.impulses, &mut r);
            let mut right = DVector::zeros(3 * bodies + slots);
            for (body, mass) in problem.mass.iter().enumerate() {
                for k in 0..3 {
                    let defect = balance[body][k] - mass[k] * found.velocities[body][k];
                    right[3 * body + k] = defect / (unit * mass[k]).sqrt();
                }
            }
            right.rows_mut(3 * bodies, slots).copy_from_slice(&r);
            let step = match side {
                Side::Forward => saddle.solve(&right),
                Side::Transposed => saddle.solve_transpose(&right),
            };
            for (body, mass) in problem.mass.iter().enumerate() {
                for k in 0..3 {
                    let change = step[3 * body + k] * unit / (unit * mass[k]).sqrt();
                    found.velocities[body][k] += change;
                }
            }
            for slot in 0..slots {
                found.impulses[slot] += step[3 * bodies + slot] * self.scaling.to_impulse[slot];
            }
        }
        let defect = self.remainder(problem, side, &found.velocities, rhs, &found.impulses, &mut r);
        found.defect = relative(defect, self.scale(problem, momentum, rhs));
        Some(found)
    }

    /// ```text
    ///  r = rhs − B v − c y,   dy = (Ŝ + ε I)⁻¹ r,   y ← y + dy,   v ← v + M⁻¹ Cᵀ dy
    /// ```
    ///
    /// The velocities take the small changes and not the sum of large impulses: under mass ratios
    /// of 10⁸ they still satisfy the rows to rounding.
    fn refine(
        &self,
        problem: &Lcp,
        side: Side,
        momentum: &[Vector3<f64>],
        rhs: &[f64],
        mut y: Vec<f64>,
    ) -> Reduced {
        let scale = self.scale(problem, momentum, rhs);
        let mut change = momentum.to_vec();
        self.add_impulses(problem, side, &y, &mut change);
        let mut velocities = vec![Vector3::zeros(); momentum.len()];
        advance(problem, &mut change, &mut velocities);
        let (mut previous, mut defect) = (f64::INFINITY, 0.0);
        let mut r = vec![0.0; y.len()];
        for sweep in 0..MAX_SWEEPS {
            defect = self.remainder(problem, side, &velocities, rhs, &y, &mut r);
            if defect <= 2e-16 * scale || (sweep >= 2 && defect > STALLED * previous) {
                break;
            }
            previous = defect;
            self.factor.solve(side, &mut r);
            for ((r, y), to_impulse) in r.iter_mut().zip(&mut y).zip(&self.scaling.to_impulse) {
                *r *= to_impulse;
                *y += *r;
            }
            self.add_impulses(problem, side, &r, &mut change);
            advance(problem, &mut change, &mut velocities);
        }
        let defect = relative(defect, scale);
        Reduced { velocities, impulses: y, defect }
    }

    /// Largest entry of the right-hand side in mass-weighted units.
    fn scale(&self, problem: &Lcp, momentum: &[Vector3<f64>], rhs: &[f64]) -> f64 {
        let mut scale = 0.0_f64;
        for (p, m) in momentum.iter().zip(&problem.mass) {
            let along = |k: usize| p[k].abs() / (self.scaling.unit * m[k]).sqrt();
            scale = (0..3).fold(scale, |scale, k| scale.max(along(k)));
        }
        let rows =
            rhs.iter().zip(&self.scaling.of_remainder).map(|(b, inverse)| (b * inverse).abs());
        rows.fold(scale, f64::max)
    }

    /// Scaled remainder of the active rows' equations into `r`; returns the greatest.
    fn remainder(
        &self,
        problem: &Lcp,
        side: Side,
        velocities: &[Vector3<f64>],
        rhs: &[f64],
        y: &[f64],
        r: &mut [f64],
    ) -> f64 {
        for (slot, &index) in self.rows.iter().enumerate() {
            let row = &problem.rows[index as usize];
            let along = row.velocity(velocities);
            let compliant = row.compliance * y[slot];
            r[slot] = match side {
                Side::Forward => rhs[slot] - along - compliant,
                Side::Transposed => rhs[slot] + along - compliant,
            };
        }
        if side == Side::Transposed {
            for fold in &self.folds {
                let along = problem.rows[fold.row as usize].velocity(velocities);
                r[fold.column as usize] += fold.coefficient * along;
            }
        }
        let mut worst = 0.0_f64;
        for (r, inverse) in r.iter_mut().zip(&self.scaling.of_remainder) {
            *r *= inverse;
            worst = if r.is_finite() { worst.max(r.abs()) } else { f64::INFINITY };
        }
        worst
    }

    /// Adds Cᵀ y, or −Bᵀ y in the transposed system.
    fn add_impulses(&self, problem: &Lcp, side: Side, y: &[f64], momentum: &mut [Vector3<f64>]) {
        let sign = if side == Side::Forward { 1.0 } else { -1.0 };
        for (&row, y) in self.rows.iter().zip(y) {
            problem.rows[row as usize].add_transposed(sign * y, momentum);
        }
        if side == Side::Forward {
            for fold in &self.folds {
                let impulse = fold.coefficient * y[fold.column as usize];
                problem.rows[fold.row as usize].add_transposed(impulse, momentum);
            }
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Forward,
    Transposed,
}

impl Factor {
    fn solve(&self, side: Side, x: &mut [f64]) {
        match (self, side) {
            (Self::Symmetric(cholesky), _) => cholesky.solve(x),
            (Self::General(lu), Side::Forward) => lu.solve(x),
            (Self::General(lu), Side::Transposed) => lu.solve_transpose(x),
        }
    }

    #[expect(clippy::cast_possible_truncation, reason = "row counts are u32")]
    fn small_pivots(&self) -> u32 {
        let small = |pivot: &f64| pivot.abs() < 16.0 * PROXIMAL;
        match self {
            Self::Symmetric(cholesky) => cholesky.pivots().filter(small).count() as u32,
            Self::General(lu) => lu.pivots().filter(small).count() as u32,
        }
    }
}

/// v ← v + M⁻¹ change; change ← 0.
fn advance(problem: &Lcp, change: &mut [Vector3<f64>], velocities: &mut [Vector3<f64>]) {
    for ((change, v), mass) in change.iter_mut().zip(velocities).zip(&problem.mass) {
        *v += change.component_div(mass);
        *change = Vector3::zeros();
    }
}

#[expect(clippy::cast_possible_truncation, reason = "row indices are u32")]
fn active_rows(problem: &Lcp, modes: &[Mode]) -> Vec<u32> {
    let active = |&row: &usize| match problem.rows[row].law {
        Law::Equality => true,
        Law::Unilateral | Law::Bounded { .. } => modes[row] == Mode::Active,
        Law::Friction { normal, .. } => {
            modes[row] == Mode::Active && modes[normal as usize] == Mode::Active
        }
    };
    (0..problem.rows.len()).filter(active).map(|row| row as u32).collect()
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
fn folds(problem: &Lcp, modes: &[Mode], rows: &[u32]) -> Vec<Fold> {
    let mut slots = Vec::new();
    let mut folds = Vec::new();
    for (row, mode) in modes.iter().enumerate() {
        let Law::Friction { normal, mu } = problem.rows[row].law else { continue };
        let Some(sign) = direction(*mode) else { continue };
        if modes[normal as usize] != Mode::Active {
            continue;
        }
        if slots.is_empty() {
            slots = slots_of(problem, rows);
        }
        let column = slots[normal as usize];
        folds.push(Fold { row: row as u32, column, coefficient: sign * mu });
    }
    folds
}

#[expect(clippy::cast_possible_truncation, reason = "row indices are u32")]
fn slots_of(problem: &Lcp, rows: &[u32]) -> Vec<u32> {
    let mut slots = vec![u32::MAX; problem.rows.len()];
    for (slot, &row) in rows.iter().enumerate() {
        slots[row as usize] = slot as u32;
    }
    slots
}

#[expect(clippy::cast_possible_truncation, reason = "row indices are u32")]
fn saturated(problem: &Lcp, modes: &[Mode]) -> Vec<(u32, f64)> {
    let saturated = |(row, mode): (usize, &Mode)| match problem.rows[row].law {
        Law::Bounded { max } => direction(*mode).map(|sign| (row as u32, sign * max)),
        _ => None,
    };
    modes.iter().enumerate().filter_map(saturated).collect()
}

/// Ŝ + ε I, factored.
fn factor(
    problem: &Lcp,
    rows: &[u32],
    folds: &[Fold],
    scaling: &Scaling,
    half_width: usize,
) -> Factor {
    let symmetric = folds.is_empty();
    let mut S = if symmetric {
        BandMatrix::zeros_lower(rows.len(), half_width)
    } else {
        BandMatrix::zeros(rows.len(), folded_width(problem, rows, folds, half_width))
    };
    let assembly = Assembly::new(problem, rows, scaling, symmetric);
    assembly.add_rows(&mut S);
    for fold in folds {
        assembly.add_column(&mut S, fold.row, fold.column as usize, fold.coefficient);
    }
    for slot in 0..rows.len() {
        S.add(slot, slot, PROXIMAL);
    }
    if symmetric {
        Factor::Symmetric(Cholesky::new(S, 0.25 * PROXIMAL))
    } else {
        Factor::General(Lu::new(S, 1e-3 * PROXIMAL))
    }
}

/// Half-width when folded rows may act on other bodies than their normal rows.
fn folded_width(problem: &Lcp, rows: &[u32], folds: &[Fold], half_width: usize) -> usize {
    let foreign = |fold: &Fold| {
        let normal = &problem.rows[rows[fold.column as usize] as usize];
        let known = |body| normal.blocks().any(|(other, _)| other == body);
        problem.rows[fold.row as usize].blocks().any(|(body, _)| !known(body))
    };
    if folds.iter().any(foreign) { rows.len() } else { half_width }
}

/// A defect relative to the right-hand side; 0 where both are too small for normal numbers, as
/// what a sticking contact lets through is after some twenty steps.
fn relative(defect: f64, scale: f64) -> f64 {
    if defect < f64::MIN_POSITIVE { 0.0 } else { defect / scale }
}
