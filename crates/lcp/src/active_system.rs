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

use crate::active_rows::{list_active, list_folds, list_saturated, place_folds};
use crate::block_factor::BlockFactor;
use crate::cholesky::Cholesky;
use crate::equations::Equations;
use crate::factor::Factor;
use crate::{Lcp, Metric, Mode, Scratch, order};

/// The reduced system of one problem and one choice of modes, factored.
#[derive(Clone, Debug, Default)]
pub struct ActiveSystem {
    pub(crate) rows: Vec<u32>,
    pub(crate) folds: Vec<Fold>,
    pub(crate) saturated: Vec<(u32, f64)>,
    /// 1/√(μ Wᵢᵢ) per slot.
    pub(crate) inverse: Vec<f64>,
    /// μ.
    pub(crate) unit: f64,
    pub(crate) factor: Factor,
    pub(crate) rank_defect: u32,
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

impl ActiveSystem {
    /// Assembles and factors. Friction of a normal row that is not active is open whatever its mode.
    #[must_use]
    pub fn new(problem: &Lcp, metric: &Metric, modes: &[Mode]) -> Self {
        let mut system = Self::default();
        system.renew(problem, metric, modes, &mut Scratch::default());
        system
    }

    /// Every row active, friction rows too, some of which are folded in part as well: the impulse of a
    /// folded row is its own and `coefficient` times that of row `column`.
    pub(crate) fn of_folded(
        problem: &Lcp,
        metric: &Metric,
        shares: &[Fold],
        scratch: &mut Scratch,
    ) -> Self {
        let rows = (0_u32..).take(problem.rows.len()).collect();
        let mut system = Self { rows, ..Self::default() };
        let list = |rows: &[u32], folds: &mut Vec<Fold>, scratch: &mut Scratch| {
            folds.clear();
            folds.extend_from_slice(shares);
            place_folds(problem, rows, folds, scratch);
        };
        system.factor_rows(Elimination::Cheapest, problem, metric, list, scratch);
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

    /// The same by the rows, with exchanges, if it was by bodies and the problem is not too large for that;
    /// whether that was so. Sliding friction can spoil an elimination by bodies.
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
        list_active(problem, modes, &mut self.rows);
        list_saturated(problem, modes, &mut self.saturated);
        let list = |rows: &[u32], folds: &mut Vec<Fold>, scratch: &mut Scratch| {
            list_folds(problem, modes, rows, folds, scratch);
        };
        self.factor_rows(elimination, problem, metric, list, scratch);
    }

    /// Factors for the rows that are listed; `list` lists the folds for rows in a given order.
    fn factor_rows(
        &mut self,
        elimination: Elimination,
        problem: &Lcp,
        metric: &Metric,
        list: impl Fn(&[u32], &mut Vec<Fold>, &mut Scratch),
        scratch: &mut Scratch,
    ) {
        self.unit = metric.unit();
        list(&self.rows, &mut self.folds, scratch);
        let mut equations = std::mem::take(&mut scratch.equations);
        let width = order::half_width(problem, &self.rows, &mut scratch.spans);
        let chosen = match elimination {
            Elimination::Cheapest => metric.pattern(self.rows.len(), width, self.folds.len()),
            Elimination::Rows => None,
        };
        // Rows as they come were found cheap.
        let cheap = self.folds.is_empty() && chosen.is_none() && metric.has_pattern();
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
            list(&self.rows, &mut self.folds, scratch);
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

    /// Leaves its equations in `equations`.
    pub(crate) fn gather(&self, problem: &Lcp, equations: &mut Equations) {
        equations.gather_again(problem, self);
        if matches!(self.factor, Factor::Bodies(_)) {
            equations.find_runs(problem, &self.rows);
        }
    }
}
