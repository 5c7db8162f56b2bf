//! Derivatives of whole rollouts: the tape read backwards, or directions carried along it.

use tangency_core::{Rollout, Scene, State};

use crate::error::DiffError;
use crate::report::GradientReport;
use crate::reverse::Reverse;
use crate::sizes;
use crate::step::step_jvp;
use crate::vector::{Bars, Direction, RolloutVector, StateVector};

/// The gradient of a loss over a rollout, and what was not smooth about it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gradient {
    /// By initial state, controls and the scene's numbers.
    pub by: RolloutVector,
    /// Steps at which the derivative is one-sided or impulses are not unique.
    pub report: GradientReport,
}

const SEED: &str = "the seed of a state";

/// Reverse mode over a rollout. `seed(k, state)` gives ∂L/∂(state k), k = 0 for the initial one;
/// `None` where the loss does not see that state.
///
/// The cost does not depend on the number of parameters.
///
/// # Errors
/// [`DiffError`] with the step at which the adjoint could not be taken, or where the rollout or a
/// seed does not fit the scene or is not finite.
pub fn gradient(
    scene: &Scene,
    rollout: &Rollout,
    mut seed: impl FnMut(usize, &State) -> Option<StateVector>,
) -> Result<Gradient, DiffError> {
    sweep(scene, rollout, |k, state, bar| {
        let Some(more) = seed(k, state) else { return Ok(()) };
        sizes::state_vector(SEED, scene, &more)?;
        bar.add(&more);
        Ok(())
    })
}

/// As [`gradient`], for a loss that is asked for more often than memory should be: `add_seed(k,
/// state, bar)` adds ∂L/∂(state k) to `bar`, which already holds what comes through later states.
///
/// # Errors
/// As [`gradient`].
pub fn gradient_adding(
    scene: &Scene,
    rollout: &Rollout,
    mut add_seed: impl FnMut(usize, &State, &mut StateVector),
) -> Result<Gradient, DiffError> {
    sweep(scene, rollout, |k, state, bar| {
        add_seed(k, state, bar);
        sizes::state_vector(SEED, scene, bar)
    })
}

/// The tape read backwards; `add_seed` adds to the gradient by a state, or refuses.
fn sweep(
    scene: &Scene,
    rollout: &Rollout,
    mut add_seed: impl FnMut(usize, &State, &mut StateVector) -> Result<(), DiffError>,
) -> Result<Gradient, DiffError> {
    sizes::rollout(scene, rollout)?;
    let steps = rollout.records.len();
    let mut by = RolloutVector::zeros(scene, steps);
    let (mut report, mut reverse) = (GradientReport::default(), Reverse::default());
    add_seed(steps, rollout.last(), &mut by.initial)?;
    for k in (0..steps).rev() {
        let (before, record) = (rollout.state(k), &rollout.records[k]);
        report.begin(k);
        let RolloutVector { initial: state, controls, scene: numbers } = &mut by;
        let mut bars = Bars { state, control: &mut controls[k], scene: numbers };
        reverse.step(scene, before, record, &mut bars, &mut report).map_err(|e| e.at(k))?;
        add_seed(k, before, &mut by.initial)?;
    }
    sizes::scene_vector("the gradient by the scene", scene, &by.scene)?;
    report.end();
    Ok(Gradient { by, report })
}

/// Forward mode over a rollout: the change of every state (k = 0 … steps) along one direction.
///
/// # Errors
/// As [`gradient`].
pub fn tangent(
    scene: &Scene,
    rollout: &Rollout,
    along: &RolloutVector,
) -> Result<Vec<StateVector>, DiffError> {
    sizes::rollout(scene, rollout)?;
    sizes::steps(along, rollout.records.len())?;
    let mut changes = vec![along.initial.clone()];
    for (k, record) in rollout.records.iter().enumerate() {
        let (state, control) = (&changes[k], along.controls[k].as_slice());
        let direction = Direction { state, control, scene: &along.scene };
        let next =
            step_jvp(scene, rollout.state(k), record, &direction).map_err(|source| source.at(k))?;
        changes.push(next);
    }
    Ok(changes)
}
