//! Many steps in a row. The list of their records is the tape that reverse mode reads.

use serde::{Deserialize, Serialize};
use tangency_lcp::LcpSolver;

use crate::step::advance;
use crate::{Scene, State, StepError, StepRecord, StepScratch};

/// A run: the state it began in and what every step produced.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rollout {
    /// State before the first step.
    pub initial: State,
    /// One record per step.
    pub records: Vec<StepRecord>,
}

impl Rollout {
    /// State before step `k`; the state after the last step for `k` = number of steps.
    ///
    /// # Panics
    /// If `k` exceeds the number of steps.
    #[must_use]
    pub fn state(&self, k: usize) -> &State {
        if k == 0 { &self.initial } else { &self.records[k - 1].after }
    }

    /// All states, the initial one first: one more than there are steps.
    pub fn states(&self) -> impl Iterator<Item = &State> {
        std::iter::once(&self.initial).chain(self.records.iter().map(|r| &r.after))
    }

    /// The state at the end.
    #[must_use]
    pub fn last(&self) -> &State {
        self.state(self.records.len())
    }

    /// Adds a step; the run itself began after the step `before`, if there was one.
    pub(crate) fn advance(
        &mut self,
        scene: &Scene,
        solver: &dyn LcpSolver,
        before: Option<&StepRecord>,
        control: &[f64],
        scratch: &mut StepScratch,
    ) -> Result<(), StepError> {
        let before = self.records.last().or(before);
        let record = advance(scene, solver, self.last(), before, control, scratch)?;
        self.records.push(record);
        Ok(())
    }

    /// The worst residual of all steps.
    #[must_use]
    pub fn residual(&self) -> f64 {
        self.records.iter().map(StepRecord::residual).fold(0.0, f64::max)
    }
}

/// Runs `steps` steps from `initial`. `control(k, state)` gives step k's control array, one number
/// per channel of the scene.
///
/// # Errors
/// The first [`StepError`]; its message tells the time.
pub fn rollout(
    scene: &Scene,
    solver: &dyn LcpSolver,
    initial: State,
    steps: usize,
    control: impl FnMut(usize, &State) -> Vec<f64>,
) -> Result<Rollout, StepError> {
    rollout_in(scene, solver, initial, steps, control, &mut StepScratch::default())
}

/// [`rollout`] in memory that is used again: give an old run [back](StepScratch::recycle_run) and the
/// next one needs none of its own.
///
/// # Errors
/// As [`rollout`].
pub fn rollout_in(
    scene: &Scene,
    solver: &dyn LcpSolver,
    initial: State,
    steps: usize,
    mut control: impl FnMut(usize, &State) -> Vec<f64>,
    scratch: &mut StepScratch,
) -> Result<Rollout, StepError> {
    let mut run = Rollout { initial, records: Vec::new() };
    for k in 0..steps {
        let control = control(k, run.state(k));
        run.advance(scene, solver, None, &control, scratch)?;
    }
    Ok(run)
}

/// Runs a scene from its own initial state for `steps` steps with all controls zero.
///
/// # Errors
/// As [`rollout`].
pub fn simulate(scene: &Scene, solver: &dyn LcpSolver, steps: usize) -> Result<Rollout, StepError> {
    let zeros = vec![0.0; scene.controls().len()];
    rollout(scene, solver, scene.initial_state(), steps, |_, _| zeros.clone())
}
