//! What a run cost and how well it kept its constraints.

use std::time::Duration;

use tangency::{Scene, StepError, StepRecord};

use crate::Table;

/// Figures of merit, gathered step by step.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    /// Steps taken.
    pub steps: usize,
    /// Time spent in them.
    pub elapsed: Duration,
    /// Worst scaled residual.
    pub residual: f64,
    /// Deepest penetration, m.
    pub penetration: f64,
    /// Largest joint error, m or rad.
    pub joint_drift: f64,
    /// Steps in which every body moved in closed form.
    pub free_steps: usize,
    /// Steps whose islands all took one linear solve.
    pub linear_steps: usize,
    /// Steps with a complementarity problem.
    pub lcp_steps: usize,
    /// Steps whose positions were mended after the move.
    pub mended_steps: usize,
    /// Steps in which restitution or the correction of positions gave way.
    pub yielding_steps: usize,
    /// Solver iterations.
    pub iterations: usize,
    /// Matrix factorisations.
    pub factorisations: usize,
}

impl Summary {
    /// Adds a step and the time it took.
    ///
    /// # Errors
    /// A [`StepError`] where the geometry of the new state has no answer.
    pub fn add(
        &mut self,
        scene: &Scene,
        record: &StepRecord,
        elapsed: Duration,
    ) -> Result<(), StepError> {
        let counts = record.counts(scene);
        self.steps += 1;
        self.elapsed += elapsed;
        self.residual = self.residual.max(record.residual());
        self.penetration = self.penetration.max(scene.penetration(&record.after)?);
        self.joint_drift = self.joint_drift.max(scene.joint_drift(&record.after));
        *match (counts.linear_islands, counts.lcp_islands) {
            (0, 0) => &mut self.free_steps,
            (_, 0) => &mut self.linear_steps,
            _ => &mut self.lcp_steps,
        } += 1;
        self.mended_steps += usize::from(counts.displacements > 0);
        let yielding = counts.loose_islands + counts.plastic_islands + counts.soft_islands;
        self.yielding_steps += usize::from(yielding > 0);
        self.iterations += counts.iterations;
        self.factorisations += counts.factorisations;
        Ok(())
    }

    /// Steps per second of computing.
    #[must_use]
    pub fn steps_per_second(&self) -> f64 {
        self.steps as f64 / self.elapsed.as_secs_f64().max(1e-9)
    }

    /// The summary for people; `energy` is that of the first and the last state, J.
    #[must_use]
    pub fn table(&self, dt: f64, energy: [f64; 2]) -> Table {
        let speed = self.steps_per_second();
        let mut table = Table::default();
        table.row("simulated", format!("{:.6} s in {} steps", self.steps as f64 * dt, self.steps));
        table.row("speed", format!("{speed:.0} steps/s, {:.0} × real time", speed * dt));
        table.row("worst residual", format!("{:.1e}", self.residual));
        table.row("worst penetration", format!("{:.1e} m", self.penetration));
        table.row("worst joint drift", format!("{:.1e} m or rad", self.joint_drift));
        table.row(
            "energy",
            format!("{:.6} J at the start, {:.6} J at the end", energy[0], energy[1]),
        );
        table.row(
            "paths",
            format!(
                "{} free, {} linear, {} complementarity steps; {} mended",
                self.free_steps, self.linear_steps, self.lcp_steps, self.mended_steps
            ),
        );
        if self.yielding_steps > 0 {
            let steps = self.yielding_steps;
            table.row("gave way", format!("bounces or position errors in {steps} steps"));
        }
        table.row(
            "work",
            format!("{} iterations, {} factorisations", self.iterations, self.factorisations),
        );
        table
    }
}
