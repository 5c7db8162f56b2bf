//! Reverse mode over runs of which few records are kept: the segments between them are run again, the
//! last one first, and each is read backwards as soon as it is there.
//!
//! A run continues from its records to the last bit, and the adjoint goes through the same steps in the
//! same order: the gradient is, to the last bit, that of the full tape.

use tangency_core::{Checkpoints, Rollout, Scene, State, StepRecord, StepScratch};
use tangency_lcp::LcpSolver;

use crate::error::DiffError;
use crate::impulse::RowImpulse;
use crate::mode::GradientMode;
use crate::rollout::{Gradient, Sweep};
use crate::seeds::{Adding, Seeds, WithImpulses};
use crate::sizes;
use crate::vector::StateVector;

/// [`gradient_adding`](crate::gradient_adding) of a run that was made by
/// [`checkpointed_rollout`](tangency_core::checkpointed_rollout), to the last bit, in memory that grows with
/// the root of the number of steps and for the price of one more run.
///
/// `add_seed(k, state, bar)` adds ∂L/∂(state k) to `bar`, the last state (k = number of steps) first. Each
/// segment is prepared for `mode` when it is there.
///
/// # Errors
/// As [`gradient`](crate::gradient()), and [`DiffError::Replay`] or [`DiffError::OtherRun`] where scene or
/// solver are not those of the run.
pub fn checkpointed_gradient(
    scene: &Scene,
    solver: &dyn LcpSolver,
    run: &Checkpoints,
    mode: GradientMode,
    add_seed: impl FnMut(usize, &State, &mut StateVector),
) -> Result<Gradient, DiffError> {
    of_checkpoints(scene, solver, run, mode, &mut Adding(add_seed))
}

/// As [`checkpointed_gradient`], for a loss that sees impulses, too: as
/// [`gradient_with_impulses`](crate::gradient_with_impulses).
///
/// # Errors
/// As [`checkpointed_gradient`] and [`gradient_with_impulses`](crate::gradient_with_impulses).
pub fn checkpointed_gradient_with_impulses(
    scene: &Scene,
    solver: &dyn LcpSolver,
    run: &Checkpoints,
    mode: GradientMode,
    add_seed: impl FnMut(usize, &State, &mut StateVector),
    impulse_seed: impl FnMut(usize, &StepRecord) -> Vec<RowImpulse>,
) -> Result<Gradient, DiffError> {
    of_checkpoints(scene, solver, run, mode, &mut WithImpulses(Adding(add_seed), impulse_seed))
}

fn of_checkpoints(
    scene: &Scene,
    solver: &dyn LcpSolver,
    run: &Checkpoints,
    mode: GradientMode,
    seeds: &mut dyn Seeds,
) -> Result<Gradient, DiffError> {
    let mut scratch = StepScratch::default();
    sizes::state("a state of the rollout", scene, run.last())?;
    let mut sweep = Sweep::new(scene, run.steps());
    sweep.begin(run.last(), seeds)?;
    for segment in (0..run.segments()).rev() {
        let first = run.first_step(segment);
        let mut tape = replay(scene, solver, run, segment, &mut scratch)?;
        for (k, record) in (first..).zip(&mut tape.records) {
            mode.prepare_step(record).map_err(|source| source.at(k))?;
        }
        sweep.segment(&tape, first, seeds)?;
        scratch.recycle_run(tape);
    }
    sweep.end()
}

/// Runs a segment again, and refuses one that does not end where it did.
fn replay(
    scene: &Scene,
    solver: &dyn LcpSolver,
    run: &Checkpoints,
    segment: usize,
    scratch: &mut StepScratch,
) -> Result<Rollout, DiffError> {
    let tape = run.replay(scene, solver, segment, scratch)?;
    if tape.last() == run.end(segment) {
        return Ok(tape);
    }
    let first = run.first_step(segment);
    Err(DiffError::OtherRun { first, last: first + tape.records.len() - 1 })
}
