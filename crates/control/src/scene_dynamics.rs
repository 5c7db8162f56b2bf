//! The dynamics of a scene: a step of its engine, and the Jacobian of that step.

use nalgebra::DVector;
use tangency_core::{Scene, State, StepError, StepRecord, StepScratch, next_step, step};
use tangency_diff::{Coordinates, DiffError, GradientMode, step_jacobian};
use tangency_lcp::LcpSolver;

use crate::{Dynamics, Linearisation};

/// A scene that is driven through its control channels.
///
/// x are poses and velocities of its dynamic bodies in the order of [`Coordinates`], 6 n numbers, joints
/// or not; u is one number per channel, held for a step. Steps have the bits of
/// [`rollout`](tangency_core::rollout).
pub struct SceneDynamics<'a> {
    scene: &'a Scene,
    solver: &'a dyn LcpSolver,
    coordinates: Coordinates,
    scratch: StepScratch,
    mode: GradientMode,
}

/// Why a scene could not be stepped, or the step not be differentiated.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneDynamicsError {
    /// The step.
    #[error(transparent)]
    Step(#[from] StepError),
    /// Its derivative.
    #[error(transparent)]
    Derivative(#[from] DiffError),
}

impl<'a> SceneDynamics<'a> {
    /// Of a scene, its steps solved by `solver`.
    #[must_use]
    pub fn new(scene: &'a Scene, solver: &'a dyn LcpSolver) -> Self {
        let (coordinates, scratch) = (Coordinates::of(scene), StepScratch::default());
        Self { scene, solver, coordinates, scratch, mode: GradientMode::Exact }
    }

    /// The same with derivatives of another mode; steps stay what they are.
    #[must_use]
    pub fn with_gradient_mode(self, mode: GradientMode) -> Self {
        Self { mode, ..self }
    }

    /// Where the numbers of x stand.
    #[must_use]
    pub fn order(&self) -> &Coordinates {
        &self.coordinates
    }
}

impl Dynamics for SceneDynamics<'_> {
    type State = State;
    type Step = StepRecord;
    type Error = SceneDynamicsError;

    fn states(&self) -> usize {
        self.coordinates.size()
    }

    fn controls(&self) -> usize {
        self.scene.controls().len()
    }

    fn coordinates(&self, state: &State) -> DVector<f64> {
        self.coordinates.of_state(state)
    }

    fn step(
        &mut self,
        state: &State,
        before: Option<&StepRecord>,
        control: &[f64],
    ) -> Result<StepRecord, SceneDynamicsError> {
        let (scene, solver, scratch) = (self.scene, self.solver, &mut self.scratch);
        Ok(match before {
            Some(before) => next_step(scene, solver, before, control, scratch)?,
            None => step(scene, solver, state, control, scratch)?,
        })
    }

    fn after<'a>(&self, step: &'a StepRecord) -> &'a State {
        &step.after
    }

    fn linearise(
        &self,
        state: &State,
        step: &StepRecord,
    ) -> Result<Linearisation, SceneDynamicsError> {
        let by = if self.mode == GradientMode::Exact {
            step_jacobian(self.scene, state, step, &[])?
        } else {
            let mut step = step.clone();
            self.mode.prepare_step(&mut step)?;
            step_jacobian(self.scene, state, &step, &[])?
        };
        Ok(Linearisation { state: by.state, control: by.control })
    }
}
