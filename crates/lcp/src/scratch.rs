//! Memory that survives between solves.

use std::sync::Arc;

use nalgebra::Vector3;

use crate::block::Block;
use crate::equations::Equations;
use crate::pattern::{Pattern, Patterns};
use crate::pool::{Pool, even_out};
use crate::{ActiveSystem, BoxLaw, Lcp, LcpSolution, Metric, Mode};

/// Buffers that survive between solves so that they need not be allocated again; their content
/// never changes a result.
#[derive(Debug, Default)]
pub struct Scratch {
    /// Numbers.
    pub floats: Pool<f64>,
    /// Four numbers per row.
    pub quads: Pool<[f64; 4]>,
    pub(crate) laws: Pool<BoxLaw>,
    pub(crate) vectors: Pool<Vector3<f64>>,
    pub(crate) indices: Pool<u32>,
    /// Modes.
    pub modes: Pool<Mode>,
    pub(crate) blocks: Pool<Block>,
    pub(crate) equations: Equations,
    pub(crate) spans: Vec<u32>,
    /// Two vectors per body.
    pub(crate) pairs: Vec<[Vector3<f64>; 2]>,
    /// Empty between polishes.
    pub(crate) seen: Vec<Vec<Mode>>,
    systems: Vec<Arc<ActiveSystem>>,
    metrics: Vec<Metric>,
    patterns: Patterns,
}

impl Scratch {
    /// Takes the memory of a solution that is needed no more.
    pub fn recycle(&mut self, solution: LcpSolution) {
        self.vectors.give(solution.velocities);
        self.floats.give(solution.impulses);
        self.floats.give(solution.slacks);
        self.modes.give(solution.modes);
        if let Some(system) = solution.system {
            self.give_system(system);
        }
    }

    /// Shares the memory of solutions evenly with another: that which only one of them got back.
    pub fn even_out(&mut self, other: &mut Self) {
        self.floats.even_out(&mut other.floats);
        self.quads.even_out(&mut other.quads);
        self.laws.even_out(&mut other.laws);
        self.vectors.even_out(&mut other.vectors);
        self.indices.even_out(&mut other.indices);
        self.modes.even_out(&mut other.modes);
        self.blocks.even_out(&mut other.blocks);
        even_out(&mut self.systems, &mut other.systems);
        even_out(&mut self.metrics, &mut other.metrics);
    }

    /// A copy of modes.
    pub(crate) fn copy_modes(&mut self, modes: &[Mode]) -> Vec<Mode> {
        let mut copy = self.modes.take();
        copy.extend_from_slice(modes);
        copy
    }

    /// Takes the memory of a solution's factored system; a derivative then factors it again.
    pub fn recycle_system(&mut self, solution: &mut LcpSolution) {
        if let Some(system) = solution.system.take() {
            self.give_system(system);
        }
    }

    /// An active system of whatever came before.
    pub(crate) fn system(&mut self) -> Arc<ActiveSystem> {
        self.systems.pop().unwrap_or_default()
    }

    /// Keeps an active system's memory if nobody else has it.
    pub(crate) fn give_system(&mut self, mut system: Arc<ActiveSystem>) {
        if Arc::get_mut(&mut system).is_some() {
            self.systems.push(system);
        }
    }

    /// The metric of a problem.
    pub fn metric(&mut self, problem: &Lcp) -> Metric {
        let mut metric = self.metrics.pop().unwrap_or_default();
        metric.renew(problem, &mut self.patterns);
        metric
    }

    /// Takes a metric's memory.
    pub fn give_metric(&mut self, metric: Metric) {
        self.metrics.push(metric);
    }

    /// In which order the bodies of a problem are eliminated.
    pub(crate) fn pattern(&mut self, problem: &Lcp) -> Arc<Pattern> {
        self.patterns.of(problem)
    }
}
