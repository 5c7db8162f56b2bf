//! Derivatives of whole rollouts: the tape read backwards, or directions carried along it.

use tangency_core::{Rollout, Scene, State, StepRecord};

use crate::error::DiffError;
use crate::growth::Growth;
use crate::impulse::RowImpulse;
use crate::report::GradientReport;
use crate::reverse::Reverse;
use crate::seeds::{Adding, Giving, Seeds, WithImpulses};
use crate::sizes;
use crate::step::step_jvp_with_impulses;
use crate::vector::{Bars, Direction, RolloutVector, StateVector};

/// The gradient of a loss over a rollout, and what was not smooth about it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gradient {
    /// By initial state, controls and the scene's numbers.
    pub by: RolloutVector,
    /// Steps at which the derivative is one-sided or impulses are not unique, and how it grew.
    pub report: GradientReport,
}

/// Reverse mode over a rollout. `seed(k, state)` gives ∂L/∂(state k), k = 0 for the initial one;
/// `None` where the loss does not see that state.
///
/// The cost does not depend on the number of parameters. A run too long for its records to be kept has
/// [`checkpointed_gradient`](crate::checkpointed_gradient).
///
/// # Errors
/// [`DiffError`] with the step at which the adjoint could not be taken, or where the rollout or a
/// seed does not fit the scene or is not finite.
pub fn gradient(
    scene: &Scene,
    rollout: &Rollout,
    seed: impl FnMut(usize, &State) -> Option<StateVector>,
) -> Result<Gradient, DiffError> {
    of_tape(scene, rollout, &mut Giving(seed))
}

/// As [`gradient`], for a loss that is asked for more often than memory should be: `add_seed(k,
/// state, bar)` adds ∂L/∂(state k) to `bar`, which already holds what comes through later states.
///
/// # Errors
/// As [`gradient`].
pub fn gradient_adding(
    scene: &Scene,
    rollout: &Rollout,
    add_seed: impl FnMut(usize, &State, &mut StateVector),
) -> Result<Gradient, DiffError> {
    of_tape(scene, rollout, &mut Adding(add_seed))
}

/// As [`gradient`], for a loss that sees impulses, too: `impulse_seed(k, record)` gives ∂L/∂λ of the
/// rows of step k that it depends on, k = 0 for the first step.
///
/// Where rows depend on each other, single impulses are not unique: the engine reports the least ones,
/// in the norm Σ Wᵣᵣ λᵣ², and the derivative is that of the least change. What the rows determine (the
/// sum of the impulses of two hinges in one place, say) is exact; steps at which the loss sees more than
/// that are in [`GradientReport::undetermined_impulses`].
///
/// # Errors
/// As [`gradient`], and [`DiffError::NoSuchRow`] where the step has no such row.
pub fn gradient_with_impulses(
    scene: &Scene,
    rollout: &Rollout,
    seed: impl FnMut(usize, &State) -> Option<StateVector>,
    impulse_seed: impl FnMut(usize, &StepRecord) -> Vec<RowImpulse>,
) -> Result<Gradient, DiffError> {
    of_tape(scene, rollout, &mut WithImpulses(Giving(seed), impulse_seed))
}

fn of_tape(scene: &Scene, rollout: &Rollout, seeds: &mut dyn Seeds) -> Result<Gradient, DiffError> {
    sizes::rollout(scene, rollout)?;
    let mut sweep = Sweep::new(scene, rollout.records.len());
    sweep.begin(rollout.last(), seeds)?;
    sweep.segment(rollout, 0, seeds)?;
    sweep.end()
}

/// A tape that is read backwards, in one piece or in several.
pub(crate) struct Sweep<'a> {
    scene: &'a Scene,
    by: RolloutVector,
    report: GradientReport,
    reverse: Reverse,
    growth: Growth,
}

impl<'a> Sweep<'a> {
    /// Of a run of so many steps.
    pub(crate) fn new(scene: &'a Scene, steps: usize) -> Self {
        let (by, growth) = (RolloutVector::zeros(scene, steps), Growth::new(scene, steps));
        Self { scene, by, report: GradientReport::default(), reverse: Reverse::default(), growth }
    }

    /// Takes the seed of the last state.
    pub(crate) fn begin(&mut self, last: &State, seeds: &mut dyn Seeds) -> Result<(), DiffError> {
        self.seed(self.by.controls.len(), last, seeds, false)
    }

    /// Reads steps backwards, of which the first one is step `first` of the run.
    pub(crate) fn segment(
        &mut self,
        run: &Rollout,
        first: usize,
        seeds: &mut dyn Seeds,
    ) -> Result<(), DiffError> {
        for (local, record) in run.records.iter().enumerate().rev() {
            let (k, before) = (first + local, run.state(local));
            self.report.begin(k);
            self.reverse.impulses.take(record, seeds.impulses(k, record))?;
            let RolloutVector { initial: state, controls, scene: numbers } = &mut self.by;
            let mut bars = Bars { state, control: &mut controls[k], scene: numbers };
            let reverse = &mut self.reverse;
            let by_impulses = reverse.impulses.any();
            reverse
                .step(self.scene, before, record, &mut bars, &mut self.report)
                .map_err(|e| e.at(k))?;
            self.seed(k, before, seeds, by_impulses)?;
        }
        Ok(())
    }

    /// The gradient.
    pub(crate) fn end(mut self) -> Result<Gradient, DiffError> {
        sizes::scene_vector("the gradient by the scene", self.scene, &self.by.scene)?;
        self.report.end();
        Ok(Gradient { by: self.by, report: self.report })
    }

    fn seed(
        &mut self,
        k: usize,
        state: &State,
        seeds: &mut dyn Seeds,
        by_impulses: bool,
    ) -> Result<(), DiffError> {
        let bar = &mut self.by.initial;
        self.growth.hold(bar);
        seeds.add(self.scene, k, state, bar)?;
        self.report.add_growth(self.growth.measure(self.scene, bar, by_impulses));
        Ok(())
    }
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
    tangent_with_impulses(scene, rollout, along).map(|(states, _)| states)
}

/// As [`tangent`], with the changes of the impulses of every step, row by row; those of
/// [`gradient_with_impulses`] where rows depend on each other.
///
/// # Errors
/// As [`gradient`].
pub fn tangent_with_impulses(
    scene: &Scene,
    rollout: &Rollout,
    along: &RolloutVector,
) -> Result<(Vec<StateVector>, Vec<Vec<RowImpulse>>), DiffError> {
    sizes::rollout(scene, rollout)?;
    sizes::steps(along, rollout.records.len())?;
    let mut changes = vec![along.initial.clone()];
    let mut impulses = Vec::new();
    for (k, record) in rollout.records.iter().enumerate() {
        let (state, control) = (&changes[k], along.controls[k].as_slice());
        let direction = Direction { state, control, scene: &along.scene };
        let (next, pushed) = step_jvp_with_impulses(scene, rollout.state(k), record, &direction)
            .map_err(|source| source.at(k))?;
        changes.push(next);
        impulses.push(pushed);
    }
    Ok((changes, impulses))
}
