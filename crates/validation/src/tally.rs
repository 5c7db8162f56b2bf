//! What the steps of many runs took.

use std::collections::BTreeMap;

use tangency_core::{IslandRecord, Path, StepRecord};
use tangency_lcp::Method;

/// Steps, problems by the method that solved them, and the worst residual.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    /// Steps taken.
    pub steps: usize,
    /// Steps refused.
    pub refused: usize,
    /// Problems solved, by method; several in a step of several islands or with mended positions.
    pub problems: BTreeMap<Method, usize>,
    /// The worst residual of all problems.
    pub residual: f64,
    /// Factorisations.
    pub factorisations: usize,
}

impl Tally {
    /// Takes a step into account.
    pub fn add_step(&mut self, record: &StepRecord) {
        self.steps += 1;
        let post = record.post.iter().flat_map(|post| &post.islands);
        for island in record.islands.iter().chain(post) {
            *self.problems.entry(method(island)).or_default() += 1;
            self.residual = self.residual.max(island.residual);
            self.factorisations += island.solution.stats.factorisations as usize;
        }
    }

    /// Takes another tally into account.
    pub fn add(&mut self, other: &Self) {
        self.steps += other.steps;
        self.refused += other.refused;
        self.factorisations += other.factorisations;
        self.residual = self.residual.max(other.residual);
        for (method, count) in &other.problems {
            *self.problems.entry(*method).or_default() += count;
        }
    }

    /// A method in words.
    #[must_use]
    pub fn name(method: Method) -> &'static str {
        match method {
            Method::Linear => "one linear solve",
            Method::ActiveSet => "modes at the free velocities",
            Method::InteriorPoint => "interior point",
            Method::Walk => "walks along active sets",
            Method::Pivoting => "pivoting",
            Method::Warm => "modes of the step before",
            Method::Enumeration => "modes in doubt, one after another",
        }
    }

    /// Problems that only a last resort solved.
    #[must_use]
    pub fn last_resorts(&self) -> usize {
        let last = [Method::Walk, Method::Pivoting, Method::Enumeration];
        last.iter().filter_map(|method| self.problems.get(method)).sum()
    }
}

fn method(island: &IslandRecord) -> Method {
    match island.path {
        Path::Linear => Method::Linear,
        Path::Complementarity => island.solution.stats.method,
    }
}
