//! A motion that can be differentiated: with all of its records, or with few of them.

use tangency::diff::{DiffError, checkpointed_gradient_with_impulses};
use tangency::lcp::LcpSolver;
use tangency::{
    Checkpoints, Gradient, GradientMode, Rollout, Scene, State, StateVector, StepError, StepRecord,
    StepScratch, checkpointed_rollout, gradient_with_impulses, simulate,
};

use crate::loss::Seeds;

/// A motion under controls that are zero.
pub enum Tape {
    /// All records.
    Full(Rollout),
    /// Few of them, and all states but the last one.
    Sparse(Checkpoints, Vec<State>),
}

impl Tape {
    /// All records of a motion.
    ///
    /// # Errors
    /// A step that failed.
    pub fn full(scene: &Scene, solver: &dyn LcpSolver, steps: usize) -> Result<Self, StepError> {
        simulate(scene, solver, steps).map(Self::Full)
    }

    /// Few records of a motion.
    ///
    /// # Errors
    /// A step that failed.
    pub fn sparse(scene: &Scene, solver: &dyn LcpSolver, steps: usize) -> Result<Self, StepError> {
        let mut states = Vec::with_capacity(steps);
        let control = |_, state: &State| {
            states.push(state.clone());
            vec![0.0; scene.controls().len()]
        };
        let run = checkpointed_rollout(scene, solver, scene.initial_state(), steps, control)?;
        Ok(Self::Sparse(run, states))
    }

    /// All states, the initial one first.
    #[must_use]
    pub fn states(&self) -> Vec<&State> {
        match self {
            Self::Full(rollout) => rollout.states().collect(),
            Self::Sparse(run, states) => states.iter().chain([run.last()]).collect(),
        }
    }

    /// The worst residual of all steps.
    #[must_use]
    pub fn residual(&self) -> f64 {
        match self {
            Self::Full(rollout) => rollout.residual(),
            Self::Sparse(run, _) => run.residual(),
        }
    }

    /// The record of the last step, if there are any.
    ///
    /// # Errors
    /// A step that failed when it was made again.
    pub fn last_record(
        &self,
        scene: &Scene,
        solver: &dyn LcpSolver,
    ) -> Result<Option<StepRecord>, StepError> {
        match self {
            Self::Full(rollout) => Ok(rollout.records.last().cloned()),
            Self::Sparse(run, _) => {
                let Some(segment) = run.segments().checked_sub(1) else { return Ok(None) };
                let mut tape = run.replay(scene, solver, segment, &mut StepScratch::default())?;
                Ok(tape.records.pop())
            }
        }
    }

    /// The gradient of a loss with these derivatives.
    ///
    /// # Errors
    /// An adjoint that could not be taken.
    pub fn gradient(
        &mut self,
        scene: &Scene,
        solver: &dyn LcpSolver,
        mode: GradientMode,
        seeds: &Seeds,
    ) -> Result<Gradient, DiffError> {
        let Seeds { states, impulses } = seeds;
        let last = |k: usize| k + 2 == states.len();
        let pushes = |k, _: &StepRecord| if last(k) { impulses.clone() } else { Vec::new() };
        let add = |k: usize, _: &State, bar: &mut StateVector| {
            states[k].iter().for_each(|seed| bar.add(seed));
        };
        match self {
            Self::Full(rollout) => {
                mode.prepare(rollout)?;
                gradient_with_impulses(scene, rollout, |k, _| states[k].clone(), pushes)
            }
            Self::Sparse(run, _) => {
                checkpointed_gradient_with_impulses(scene, solver, run, mode, add, pushes)
            }
        }
    }
}
