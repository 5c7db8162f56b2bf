//! Stepping without a tape.

use tangency_lcp::LcpSolver;

use crate::step::advance;
use crate::{Scene, State, StepError, StepRecord, StepScratch};

/// A run that keeps its last step only: memory stays flat, and after a few steps nothing is allocated.
pub struct Simulator<'a> {
    scene: &'a Scene,
    solver: &'a dyn LcpSolver,
    initial: State,
    last: Option<StepRecord>,
    scratch: StepScratch,
}

impl<'a> Simulator<'a> {
    /// A run from the scene's own initial state.
    #[must_use]
    pub fn new(scene: &'a Scene, solver: &'a dyn LcpSolver) -> Self {
        Self::starting(scene, solver, scene.initial_state())
    }

    /// A run from a state.
    #[must_use]
    pub fn starting(scene: &'a Scene, solver: &'a dyn LcpSolver, initial: State) -> Self {
        Self { scene, solver, initial, last: None, scratch: StepScratch::default() }
    }

    /// The state that the run has come to.
    #[must_use]
    pub fn state(&self) -> &State {
        self.last.as_ref().map_or(&self.initial, |record| &record.after)
    }

    /// The last step.
    #[must_use]
    pub fn record(&self) -> Option<&StepRecord> {
        self.last.as_ref()
    }

    /// One step under `control`, one number per channel.
    ///
    /// # Errors
    /// As [`next_step`](crate::next_step); the run stays where it was.
    pub fn step(&mut self, control: &[f64]) -> Result<&StepRecord, StepError> {
        let scratch = &mut self.scratch;
        let before = self.last.as_ref();
        let state = before.map_or(&self.initial, |before| &before.after);
        let record = advance(self.scene, self.solver, state, before, control, scratch)?;
        if let Some(before) = self.last.take() {
            self.scratch.recycle(before);
        }
        Ok(self.last.insert(record))
    }
}
