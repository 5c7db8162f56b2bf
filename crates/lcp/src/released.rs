//! Which of two modes a weakly active row gets.

use crate::{Law, LcpSolution, Mode, Polish, Polished, Scratch};

/// Impulses below this, relative to s*, count as none.
const WEAK: f64 = 1e-10;

impl Polish<'_> {
    /// Prefers the released mode of weakly active rows: contacts without impulse are open, friction
    /// and motors on their bound slide. Kept only if it solves the problem as well.
    pub(crate) fn released(&self, found: Polished, scratch: &mut Scratch) -> Polished {
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
}
