//! Environments moved side by side.

use rayon::prelude::*;

use crate::controls::Place;
use crate::environment::Environment;
use crate::workspace::{Workspace, task_length};
use crate::{Batch, BatchError, Controls, Failure};

impl Batch {
    /// One step of every environment; `controls` is environments × channels, row-major.
    ///
    /// # Errors
    /// [`BatchError::ControlSize`], and nothing has moved; [`BatchError::Failed`] with those
    /// environments that could not step and are where they were, while all others have stepped.
    pub fn step(&mut self, controls: &[f64]) -> Result<(), BatchError> {
        self.advance(1, Controls::Held(controls))
    }

    /// So many steps of every environment. Costs less than as many calls of [`step`](Self::step):
    /// every environment takes all its steps while it is in the cache.
    ///
    /// # Errors
    /// As [`step`](Self::step); an environment that fails stays before the step that it failed at.
    pub fn advance(&mut self, steps: usize, controls: Controls<'_>) -> Result<(), BatchError> {
        let (of, channels) = (self.len(), self.channels);
        controls.check(of, steps, channels)?;
        let (solver, workspaces) = (&*self.solver, &self.workspaces);
        let failures: Vec<Failure> = self
            .environments
            .par_iter_mut()
            .enumerate()
            .with_max_len(task_length(of))
            .map_init(
                || workspaces.lend(),
                |workspace, (environment, it)| {
                    let place = Place { environment, step: 0, steps, channels };
                    run(it, solver, &controls, place, workspace).err()
                },
            )
            .flatten_iter()
            .collect();
        if failures.is_empty() { Ok(()) } else { Err(BatchError::Failed { of, failures }) }
    }
}

/// All steps of one environment, or those before the one that fails.
fn run(
    it: &mut Environment,
    solver: &dyn tangency_lcp::LcpSolver,
    controls: &Controls<'_>,
    place: Place,
    workspace: &mut Workspace,
) -> Result<(), Failure> {
    let Workspace { scratch, control: room } = workspace;
    let environment = place.environment;
    for step in 0..place.steps {
        let control = controls.at(Place { step, ..place }, it.state(), room);
        let stepped = it.step(solver, control, scratch);
        stepped.map_err(|source| Failure::Step { environment, step, source })?;
    }
    Ok(())
}
