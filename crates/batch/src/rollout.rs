//! Rollouts side by side.

use rayon::prelude::*;
use tangency_core::{
    Checkpoints, Rollout, Scene, State, StepError, StepScratch, checkpointed_rollout_in, rollout_in,
};
use tangency_diff::GradientMode;

use crate::controls::Place;
use crate::outcomes::Outcomes;
use crate::workspace::{Workspace, task_length};
use crate::{Batch, BatchError, Controls, Failure};

impl Batch {
    /// One rollout per environment, from where it is; the environments stay there.
    ///
    /// Holds all tapes at once. Where something smaller is wanted of each, see
    /// [`map_rollouts`](Self::map_rollouts).
    ///
    /// # Errors
    /// [`BatchError::ControlSize`]. Failures of single environments are among the outcomes.
    pub fn rollout(
        &self,
        steps: usize,
        controls: Controls<'_>,
    ) -> Result<Outcomes<Rollout>, BatchError> {
        controls.check(self.len(), steps, self.channels)?;
        Ok(self.look_ahead(|environment, workspace| {
            self.roll(self.place(environment, steps), &controls, workspace)
        }))
    }

    /// What `map(environment, rollout)` makes of every environment's rollout from where it is; the
    /// environments stay there.
    ///
    /// Holds one tape per thread at a time, in memory that the batch keeps for its next work.
    ///
    /// # Errors
    /// As [`rollout`](Self::rollout).
    pub fn map_rollouts<T: Send>(
        &self,
        steps: usize,
        controls: Controls<'_>,
        map: impl Fn(usize, &Rollout) -> T + Sync,
    ) -> Result<Outcomes<T>, BatchError> {
        self.try_map_rollouts(steps, controls, |environment, run| Ok(map(environment, run)))
    }

    /// As [`map_rollouts`](Self::map_rollouts), with a `map` that may fail.
    pub(crate) fn try_map_rollouts<T: Send>(
        &self,
        steps: usize,
        controls: Controls<'_>,
        map: impl Fn(usize, &Rollout) -> Result<T, Failure> + Sync,
    ) -> Result<Outcomes<T>, BatchError> {
        controls.check(self.len(), steps, self.channels)?;
        Ok(self.look_ahead(|environment, workspace| {
            let run = self.roll(self.place(environment, steps), &controls, workspace)?;
            let made = map(environment, &run);
            workspace.scratch.recycle_run(run);
            made
        }))
    }

    /// `work(environment, workspace)` for all environments.
    pub(crate) fn look_ahead<T: Send>(
        &self,
        work: impl Fn(usize, &mut Workspace) -> Result<T, Failure> + Sync,
    ) -> Outcomes<T> {
        let results: Vec<Result<T, Failure>> = (0..self.len())
            .into_par_iter()
            .with_max_len(task_length(self.len()))
            .map_init(
                || self.workspaces.lend(),
                |workspace, environment| work(environment, workspace),
            )
            .collect();
        results.into_iter().collect()
    }

    fn place(&self, environment: usize, steps: usize) -> Place {
        Place { environment, step: 0, steps, channels: self.channels }
    }

    /// The rollout of one environment.
    fn roll(
        &self,
        place: Place,
        controls: &Controls<'_>,
        workspace: &mut Workspace,
    ) -> Result<Rollout, Failure> {
        let (environment, steps) = (place.environment, place.steps);
        let mut run =
            self.drive(place, controls, workspace, |scene, initial, control, scratch| {
                rollout_in(scene, &*self.solver, initial, steps, control, scratch)
            })?;
        if self.mode != GradientMode::Exact {
            let prepared = self.mode.prepare(&mut run);
            prepared.map_err(|source| Failure::Gradient { environment, source })?;
        }
        Ok(run)
    }

    /// The same with few of its records.
    pub(crate) fn roll_checkpointed(
        &self,
        environment: usize,
        steps: usize,
        controls: &Controls<'_>,
        workspace: &mut Workspace,
    ) -> Result<Checkpoints, Failure> {
        let place = self.place(environment, steps);
        self.drive(place, controls, workspace, |scene, initial, control, scratch| {
            checkpointed_rollout_in(scene, &*self.solver, initial, steps, control, scratch)
        })
    }

    /// What `run` makes of one environment's scene and state under its controls.
    fn drive<T>(
        &self,
        place: Place,
        controls: &Controls<'_>,
        workspace: &mut Workspace,
        run: impl FnOnce(&Scene, State, &mut Control<'_>, &mut StepScratch) -> Result<T, StepError>,
    ) -> Result<T, Failure> {
        let environment = place.environment;
        let Workspace { scratch, control: room } = workspace;
        let (scene, initial) = (self.scene(environment), self.state(environment).clone());
        let mut step = 0;
        let mut control = |k, state: &State| {
            step = k;
            controls.at(Place { step, ..place }, state, room).to_vec()
        };
        let made = run(scene, initial, &mut control, scratch);
        made.map_err(|source| Failure::Step { environment, step, source })
    }
}

/// The control of a step in a state.
type Control<'a> = dyn FnMut(usize, &State) -> Vec<f64> + 'a;
