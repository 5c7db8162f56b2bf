//! Long runs in little memory: a record is kept every so many steps, and what lies between is run again
//! when it is needed.
//!
//! ```text
//!  T steps, one record kept every s = ⌈√T⌉:      ⌈T/s⌉ − 1 records kept, and s while a segment is read
//! ```
//!
//! A run continues from its records to the last bit, so that what is run again is what was run.

use tangency_lcp::LcpSolver;

use crate::step::advance;
use crate::{Rollout, Scene, State, StepError, StepRecord, StepScratch};

/// A run of which few records are kept. See [`checkpointed_rollout`].
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoints {
    initial: State,
    last: State,
    controls: Vec<Vec<f64>>,
    /// Steps of a segment; the last one may have fewer.
    length: usize,
    /// The last record of every segment but the last one.
    records: Vec<StepRecord>,
    residual: f64,
}

/// As [`rollout`](crate::rollout), in memory that grows with the root of the number of steps (besides
/// the controls): [`Checkpoints::replay`] gives the records back, a segment at a time.
///
/// States are seen by `control` as they come, and not kept.
///
/// # Errors
/// As [`rollout`](crate::rollout).
pub fn checkpointed_rollout(
    scene: &Scene,
    solver: &dyn LcpSolver,
    initial: State,
    steps: usize,
    control: impl FnMut(usize, &State) -> Vec<f64>,
) -> Result<Checkpoints, StepError> {
    let mut scratch = StepScratch::default();
    checkpointed_rollout_in(scene, solver, initial, steps, control, &mut scratch)
}

/// [`checkpointed_rollout`] in memory that is used again.
///
/// # Errors
/// As [`rollout`](crate::rollout).
pub fn checkpointed_rollout_in(
    scene: &Scene,
    solver: &dyn LcpSolver,
    initial: State,
    steps: usize,
    mut control: impl FnMut(usize, &State) -> Vec<f64>,
    scratch: &mut StepScratch,
) -> Result<Checkpoints, StepError> {
    let mut run = Checkpoints::empty(initial, steps);
    let mut before: Option<StepRecord> = None;
    for k in 0..steps {
        let last = before.as_ref().or(run.records.last());
        let state = last.map_or(&run.initial, |record| &record.after);
        let u = control(k, state);
        let record = advance(scene, solver, state, last, &u, scratch)?;
        run.controls.push(u);
        run.residual = run.residual.max(record.residual());
        if let Some(before) = before.take() {
            scratch.recycle(before);
        }
        if (k + 1).is_multiple_of(run.length) && k + 1 < steps {
            run.keep(record, scratch);
        } else {
            before = Some(record);
        }
    }
    if let Some(before) = before {
        run.last.clone_from(&before.after);
        scratch.recycle(before);
    }
    Ok(run)
}

impl Checkpoints {
    fn empty(initial: State, steps: usize) -> Self {
        let (length, last) = (segment_length(steps), initial.clone());
        let (controls, records) = (Vec::with_capacity(steps), Vec::new());
        Self { initial, last, controls, length, records, residual: 0.0 }
    }

    /// Keeps a record, without what can be factored again.
    fn keep(&mut self, mut record: StepRecord, scratch: &mut StepScratch) {
        scratch.recycle_systems(&mut record);
        self.records.push(record);
    }

    /// Number of steps.
    #[must_use]
    pub fn steps(&self) -> usize {
        self.controls.len()
    }

    /// State before the first step.
    #[must_use]
    pub fn initial(&self) -> &State {
        &self.initial
    }

    /// The state at the end.
    #[must_use]
    pub fn last(&self) -> &State {
        &self.last
    }

    /// The control of a step, one number per channel.
    ///
    /// # Panics
    /// If there is no such step.
    #[must_use]
    pub fn control(&self, step: usize) -> &[f64] {
        &self.controls[step]
    }

    /// The worst residual of all steps.
    #[must_use]
    pub fn residual(&self) -> f64 {
        self.residual
    }

    /// Number of segments.
    #[must_use]
    pub fn segments(&self) -> usize {
        self.steps().div_ceil(self.length)
    }

    /// The first step of a segment.
    #[must_use]
    pub fn first_step(&self, segment: usize) -> usize {
        segment * self.length
    }

    /// The state that a segment ends in.
    ///
    /// # Panics
    /// If there is no such segment.
    #[must_use]
    pub fn end(&self, segment: usize) -> &State {
        assert!(segment < self.segments(), "segment {segment} of {}", self.segments());
        self.records.get(segment).map_or(&self.last, |record| &record.after)
    }

    /// How many records are held at once while segments are read: those kept and those of a segment,
    /// about 2 √T.
    #[must_use]
    pub fn most_records(&self) -> usize {
        self.records.len() + self.length.min(self.steps())
    }

    /// Runs a segment again: its steps with their records, to the last bit those of the run if scene
    /// and solver are the same.
    ///
    /// # Errors
    /// As [`rollout`](crate::rollout); none where the run had none.
    ///
    /// # Panics
    /// If there is no such segment.
    pub fn replay(
        &self,
        scene: &Scene,
        solver: &dyn LcpSolver,
        segment: usize,
        scratch: &mut StepScratch,
    ) -> Result<Rollout, StepError> {
        assert!(segment < self.segments(), "segment {segment} of {}", self.segments());
        let before = segment.checked_sub(1).map(|before| &self.records[before]);
        let initial = before.map_or(&self.initial, |record| &record.after).clone();
        let mut run = Rollout { initial, records: Vec::new() };
        for control in self.controls.iter().skip(self.first_step(segment)).take(self.length) {
            run.advance(scene, solver, before, control, scratch)?;
        }
        Ok(run)
    }
}

/// ⌈√T⌉, at least 1.
fn segment_length(steps: usize) -> usize {
    let root = steps.isqrt();
    (root + usize::from(root * root < steps)).max(1)
}
