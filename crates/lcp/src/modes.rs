//! Reading modes from impulses and remainders, in the mass-weighted units of [`Metric`].

use serde::{Deserialize, Serialize};

use crate::{Law, Lcp, LcpSolution, Metric, Mode};

/// Impulses and remainders per row from which modes are read.
#[derive(Clone, Copy)]
pub(crate) struct Reading<'a> {
    pub(crate) problem: &'a Lcp,
    pub(crate) metric: &'a Metric,
    pub(crate) impulses: &'a [f64],
    pub(crate) slacks: &'a [f64],
}

impl Reading<'_> {
    /// (ŷ, û) of a row.
    fn scaled(&self, row: usize) -> (f64, f64) {
        let Self { metric, impulses, slacks, .. } = self;
        (metric.impulse(row, impulses[row]), metric.remainder(row, slacks[row]))
    }

    /// The mode that the natural map's piece at (ŷ, û) has. Closed contacts with ŷ < `release` · s*
    /// are opened, open ones with û − ŷ < `touch` · s* closed.
    ///
    /// ```text
    ///  unilateral   active  if ŷ > û
    ///  bounded      upper   if ŷ − û > ĥ,   lower if ŷ − û < −ĥ,   else active
    /// ```
    pub(crate) fn modes(&self, release: f64, touch: f64) -> Vec<Mode> {
        let (release, touch) = (release * self.metric.scale, touch * self.metric.scale);
        let mut modes = Vec::with_capacity(self.problem.rows.len());
        for (i, row) in self.problem.rows.iter().enumerate() {
            let (y, u) = self.scaled(i);
            let mode = match row.law {
                Law::Equality => Mode::Active,
                Law::Unilateral if y > u - touch && y >= release => Mode::Active,
                Law::Unilateral => Mode::Open,
                Law::Friction { normal, .. } if modes[normal as usize] == Mode::Open => Mode::Open,
                Law::Bounded { .. } | Law::Friction { .. } => piece(y - u, self.bound_ahead(i)),
            };
            modes.push(mode);
        }
        modes
    }

    /// As [`modes`](Self::modes), but a row keeps its mode while it violates it by less than
    /// `slack` · s*.
    pub(crate) fn correct(&self, modes: &[Mode], slack: f64, next: &mut Vec<Mode>) {
        let slack = slack * self.metric.scale;
        for (i, row) in self.problem.rows.iter().enumerate() {
            let (y, u) = self.scaled(i);
            let mode = match (row.law, modes[i]) {
                (Law::Unilateral, Mode::Active) if y < -slack => Mode::Open,
                (Law::Unilateral, Mode::Open) if u >= -slack => Mode::Open,
                (Law::Equality | Law::Unilateral, _) => Mode::Active,
                (Law::Friction { normal, .. }, _) if next[normal as usize] == Mode::Open => {
                    Mode::Open
                }
                (_, mode) => self.corrected_bounded(i, mode, slack),
            };
            next.push(mode);
        }
    }

    fn corrected_bounded(&self, row: usize, mode: Mode, slack: f64) -> Mode {
        let (y, u) = self.scaled(row);
        let bound = self.bound_ahead(row);
        match mode {
            Mode::Active if y.abs() <= bound + slack => Mode::Active,
            Mode::Upper if u <= slack => Mode::Upper,
            Mode::Lower if u >= -slack => Mode::Lower,
            _ => piece(y - u, bound),
        }
    }

    /// ĥ as far as the normal row tells: for a contact that is about to close, the impulse that
    /// would close it alone.
    fn bound_ahead(&self, row: usize) -> f64 {
        match self.problem.rows[row].law {
            Law::Friction { normal, mu } => {
                let normal = normal as usize;
                let (y, u) = self.scaled(normal);
                let ahead = self.metric.true_impulse(normal, y.max(y - u).max(0.0));
                self.metric.impulse(row, mu * ahead)
            }
            law => self.metric.bound(law, row, self.impulses),
        }
    }

    /// How far the row is from the nearest switch of its mode, relative to s*.
    fn margin(&self, row: usize) -> f64 {
        let (y, u) = self.scaled(row);
        match self.problem.rows[row].law {
            Law::Equality => f64::INFINITY,
            Law::Unilateral => self.metric.relative((y - u).abs()),
            law @ (Law::Bounded { .. } | Law::Friction { .. }) => {
                let inside = self.metric.bound(law, row, self.impulses) - y.abs();
                self.metric.relative((u.abs() - inside).abs())
            }
        }
    }
}

pub(crate) fn piece(value: f64, bound: f64) -> Mode {
    if value > bound {
        Mode::Upper
    } else if value < -bound {
        Mode::Lower
    } else {
        Mode::Active
    }
}

/// What is undecided in a weakly active row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum WeakKind {
    /// A contact or limit that touches without impulse: open or closed.
    Touching,
    /// Friction at the edge of its cone without slip: sticking or sliding.
    Slipping,
    /// A motor at its greatest impulse without slip: holding or saturated.
    Saturating,
}

/// A row on the switch between two modes, where derivatives are one-sided.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WeakRow {
    /// Row index.
    pub row: u32,
    /// What is undecided.
    pub kind: WeakKind,
    /// Distance to the switch in mass-weighted units relative to s*.
    pub margin: f64,
}

impl Lcp {
    /// Distance of each row from the nearest switch of its mode, in mass-weighted units relative to
    /// s*; infinite for equalities and for friction of open contacts.
    #[must_use]
    pub fn margins(&self, solution: &LcpSolution) -> Vec<f64> {
        let metric = Metric::new(self);
        let (impulses, slacks) = (&solution.impulses[..], &solution.slacks[..]);
        let reading = Reading { problem: self, metric: &metric, impulses, slacks };
        let idle = |row: usize| match self.rows[row].law {
            Law::Friction { normal, .. } => solution.modes[normal as usize] == Mode::Open,
            _ => false,
        };
        let margin = |row| if idle(row) { f64::INFINITY } else { reading.margin(row) };
        (0..self.rows.len()).map(margin).collect()
    }

    /// Rows whose distance from the nearest switch is at most `margin`.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "row indices are u32")]
    pub fn weak_rows(&self, solution: &LcpSolution, margin: f64) -> Vec<WeakRow> {
        let weak = |(row, found): (usize, f64)| {
            let kind = match self.rows[row].law {
                Law::Equality => return None,
                Law::Unilateral => WeakKind::Touching,
                Law::Friction { .. } => WeakKind::Slipping,
                Law::Bounded { .. } => WeakKind::Saturating,
            };
            (found <= margin).then_some(WeakRow { row: row as u32, kind, margin: found })
        };
        self.margins(solution).into_iter().enumerate().filter_map(weak).collect()
    }
}
