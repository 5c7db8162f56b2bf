//! Derivatives of runs along directions that move several numbers of a scene at once.

use tangency::diff::{Gradient, RolloutVector, StateVector, gradient, tangent};
use tangency::{Param, Rollout, Scene, State};

/// A direction: numbers of the scene and the rates at which they change.
pub(crate) type Direction<'a> = &'a [(Param, f64)];

/// The gradient of a linear function of the last state, given by its coefficients.
#[track_caller]
pub(crate) fn last_gradient(scene: &Scene, rollout: &Rollout, seed: &StateVector) -> Gradient {
    let last = rollout.records.len();
    let at_end = |k: usize, _: &State| (k == last).then(|| seed.clone());
    gradient(scene, rollout, at_end).unwrap_or_else(|error| panic!("{}: {error}", scene.def().name))
}

/// The coefficients that pick one number of the last state.
pub(crate) fn pick(scene: &Scene, write: impl FnOnce(&mut StateVector)) -> StateVector {
    let mut seed = StateVector::zeros(scene.bodies().len());
    write(&mut seed);
    seed
}

/// The derivative along a direction. Forward and reverse mode both take it; they must agree.
#[track_caller]
pub(crate) fn slope(
    scene: &Scene,
    rollout: &Rollout,
    seed: &StateVector,
    direction: Direction<'_>,
) -> f64 {
    let by = last_gradient(scene, rollout, seed).by;
    let terms = direction.iter().map(|(param, rate)| rate * by.by(scene, *param));
    let (reverse, size) = terms.fold((0.0, 0.0), |(sum, size), t| (sum + t, size + t.abs()));

    let mut along = RolloutVector::zeros(scene, rollout.records.len());
    for (param, rate) in direction {
        along.add(scene, *param, *rate);
    }
    let changes = tangent(scene, rollout, &along).expect("forward mode");
    let forward = changes.last().expect("the initial change").dot(seed);
    let scale = size.max(forward.abs()).max(1.0);
    assert!(
        (forward - reverse).abs() <= 1e-10 * scale,
        "{}: forward {forward}, reverse {reverse}",
        scene.def().name
    );
    reverse
}
