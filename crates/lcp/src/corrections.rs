//! Corrections of modes, one after another.

use crate::{Mode, Polished, Scratch};

/// Candidates one after another: the best and, if it is another, the last.
pub(crate) struct Chain {
    pub(crate) best: Polished,
    pub(crate) last: Option<Polished>,
}

impl Chain {
    pub(crate) fn last(&self) -> &Polished {
        self.last.as_ref().unwrap_or(&self.best)
    }

    pub(crate) fn add(&mut self, candidate: Polished, scratch: &mut Scratch) {
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

    pub(crate) fn end(self, scratch: &mut Scratch) -> Polished {
        if let Some(last) = self.last {
            scratch.recycle(last.solution);
        }
        self.best
    }
}

/// Leaves only the last difference between `modes` and `next`.
pub(crate) fn keep_last_correction(modes: &[Mode], next: &mut [Mode]) {
    if let Some(row) = (0..modes.len()).rev().find(|&row| modes[row] != next[row]) {
        next[..row].copy_from_slice(&modes[..row]);
    }
}
