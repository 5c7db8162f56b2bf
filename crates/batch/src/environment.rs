//! One environment: a scene, and the state that it has come to.

use std::sync::Arc;

use tangency_core::{Scene, State, StepError, StepRecord, StepScratch, next_step, step};
use tangency_lcp::LcpSolver;

/// A run that keeps its last step, in memory that it borrows step by step.
pub(crate) struct Environment {
    pub(crate) scene: Arc<Scene>,
    /// The state that it was put into.
    start: State,
    last: Option<StepRecord>,
}

impl Environment {
    pub(crate) fn new(scene: Arc<Scene>) -> Self {
        let start = scene.initial_state();
        Self { scene, start, last: None }
    }

    pub(crate) fn put(&mut self, state: State) {
        self.start = state;
        self.last = None;
    }

    pub(crate) fn state(&self) -> &State {
        self.last.as_ref().map_or(&self.start, |record| &record.after)
    }

    pub(crate) fn record(&self) -> Option<&StepRecord> {
        self.last.as_ref()
    }

    /// One step, warm from the one before; after an error the environment is where it was.
    pub(crate) fn step(
        &mut self,
        solver: &dyn LcpSolver,
        control: &[f64],
        scratch: &mut StepScratch,
    ) -> Result<(), StepError> {
        let mut record = match &self.last {
            Some(before) => next_step(&self.scene, solver, before, control, scratch)?,
            None => step(&self.scene, solver, &self.start, control, scratch)?,
        };
        scratch.recycle_systems(&mut record);
        if let Some(before) = self.last.replace(record) {
            scratch.recycle(before);
        }
        Ok(())
    }
}
