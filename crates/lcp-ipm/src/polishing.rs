//! The interior point's loop, and when and how thoroughly what it shows is polished.

use tangency_lcp::{LcpSolution, Mode, Polish};

use crate::mehrotra::{Loop, Pace};
use crate::stages::Stages;
use crate::system::System;

/// How thoroughly modes are polished before the interior point has converged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Polishing {
    /// Most mode corrections of the modes at the free velocities.
    pub(crate) cold_flips: u32,
    /// Natural residual, of unknowns of about one, below which all means are used.
    near_end: f64,
    /// Most mode corrections before that, of modes that seem settled.
    flips: u32,
}

/// Where an evaluation of modes costs no more than an iteration, or nothing else has worked.
pub(crate) const THOROUGH: Polishing = Polishing { cold_flips: u32::MAX, near_end: 1e-3, flips: 4 };
/// Where rows are many: a few of the modes are wrong until late, and a polish that goes astray costs
/// more than iterations.
pub(crate) const SPARING: Polishing = Polishing { cold_flips: 1, near_end: 1e-6, flips: 1 };
/// Iterations after a candidate that dependent rows may let be no better.
const SPARE: u32 = 3;

impl Stages<'_> {
    /// Runs the loop until a candidate is good enough or nothing more can be had.
    pub(crate) fn interior<S: System>(&mut self, system: &mut S, pace: Pace) -> bool {
        let before = self.search.stats.iterations;
        let mut path = Loop::new(system, pace, self.search.scratch);
        let polishing = self.polishing;
        let (mut glanced, mut tried) = (self.search.scratch.modes.take(), None);
        let (mut found, mut spare) = (false, SPARE);
        while !found && spare > 0 && path.iterations < self.settings.max_iterations {
            let going = path.advance(self.search.scratch);
            self.search.stats.factorisations += 1;
            self.search.stats.iterations = before + path.iterations;
            found = if path.best < polishing.near_end || !going {
                let y = if going { path.y() } else { path.best_y() };
                self.polish_at(path.system, y, &mut tried)
            } else {
                path.settled && self.glance(&path, polishing.flips, &mut glanced)
            };
            if !going {
                break;
            }
            spare -= u32::from(self.is_close());
        }
        path.give(self.search.scratch);
        self.search.scratch.modes.give(glanced);
        found
    }

    /// A short polish of modes that the path shows early and did not show before.
    fn glance<S: System>(
        &mut self,
        path: &Loop<S>,
        max_flips: u32,
        glanced: &mut Vec<Mode>,
    ) -> bool {
        let (mut modes, mut impulses) =
            (self.search.scratch.modes.take(), self.search.scratch.floats.take());
        path.list_modes(&mut modes);
        let known = modes == *glanced;
        if !known {
            path.system.impulses(path.y(), &mut impulses);
        }
        let polish = Polish { max_flips, near_miss: 0.0, ..self.search.polish };
        let found = !known && {
            let candidate = polish.modes(&modes, Some(&impulses), self.search.scratch);
            self.search.offer(candidate)
        };
        self.search.scratch.floats.give(impulses);
        self.search.scratch.modes.give(std::mem::replace(glanced, modes));
        found
    }

    /// Polishes an iterate near the end if it shows modes that the last attempt did not.
    fn polish_at<S: System>(
        &mut self,
        system: &S,
        y: &[f64],
        tried: &mut Option<Vec<Mode>>,
    ) -> bool {
        let mut impulses = self.search.scratch.floats.take();
        system.impulses(y, &mut impulses);
        let velocities = self.search.polish.problem.velocities(&impulses);
        let approximate = LcpSolution { velocities, impulses, ..LcpSolution::default() };
        let modes = self.search.polish.read_modes(&approximate);
        let known = tried.as_ref() == Some(&modes);
        *tried = Some(modes);
        let polished = if known {
            None
        } else {
            self.search.polish.approximate(&approximate, self.search.scratch)
        };
        self.search.scratch.recycle(approximate);
        polished.is_some_and(|candidate| self.search.offer(candidate))
    }
}
