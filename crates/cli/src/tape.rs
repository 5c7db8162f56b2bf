//! A motion that can be differentiated: with all of its records, or with few of them.

use tangency::diff::DiffError;
use tangency::lcp::LcpSolver;
use tangency::{
    Checkpoints, Gradient, GradientMode, Rollout, Scene, State, StateVector, StepError,
    checkpointed_gradient, checkpointed_rollout, gradient_adding, simulate,
};

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

    /// The gradient of a loss with these derivatives by the states.
    ///
    /// # Errors
    /// An adjoint that could not be taken.
    pub fn gradient(
        &mut self,
        scene: &Scene,
        solver: &dyn LcpSolver,
        mode: GradientMode,
        seeds: &[Option<StateVector>],
    ) -> Result<Gradient, DiffError> {
        let add = |k: usize, _: &State, bar: &mut StateVector| {
            seeds[k].iter().for_each(|seed| bar.add(seed));
        };
        match self {
            Self::Full(rollout) => {
                mode.prepare(rollout)?;
                gradient_adding(scene, rollout, add)
            }
            Self::Sparse(run, _) => checkpointed_gradient(scene, solver, run, mode, add),
        }
    }
}
