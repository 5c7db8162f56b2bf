//! Vectors that a derivative is asked for must fit the scene and be finite; so must what it gives.

use nalgebra::Vector3;
use tangency_core::{Rollout, Scene, State, StepRecord};

use crate::error::DiffError;
use crate::vector::{BodyVector, Direction, JointVector, RolloutVector, SceneVector, StateVector};

/// Refuses a list of another length than `expected`.
pub(crate) fn length(what: &'static str, expected: usize, found: usize) -> Result<(), DiffError> {
    if expected == found { Ok(()) } else { Err(DiffError::Size { what, expected, found }) }
}

/// Refuses a state vector that is not one of the scene's.
pub(crate) fn state_vector(
    what: &'static str,
    scene: &Scene,
    vector: &StateVector,
) -> Result<(), DiffError> {
    let bodies = scene.bodies().len();
    length(what, bodies, vector.q.len())?;
    length(what, bodies, vector.v.len())?;
    finite(what, state_is_finite(vector))
}

/// Refuses a state of another scene.
pub(crate) fn state(what: &'static str, scene: &Scene, state: &State) -> Result<(), DiffError> {
    length(what, scene.bodies().len(), state.q.len())?;
    length(what, scene.bodies().len(), state.v.len())
}

/// Refuses a rollout of another scene.
pub(crate) fn rollout(scene: &Scene, rollout: &Rollout) -> Result<(), DiffError> {
    rollout.states().try_for_each(|it| state("a state of the rollout", scene, it))?;
    let channels = scene.controls().len();
    let controls = rollout.records.iter().map(|record| &record.control);
    controls.into_iter().try_for_each(|u| length("a control of the rollout", channels, u.len()))
}

/// Refuses a step of another scene.
pub(crate) fn step(scene: &Scene, before: &State, record: &StepRecord) -> Result<(), DiffError> {
    [before, &record.after]
        .into_iter()
        .try_for_each(|it| state("a state of the step", scene, it))?;
    length("the control of the step", scene.controls().len(), record.control.len())
}

/// Refuses an index that is not below `count`.
pub(crate) fn index(what: &'static str, count: usize, found: usize) -> Result<(), DiffError> {
    if found < count { Ok(()) } else { Err(DiffError::Index { what, count, found }) }
}

/// Refuses a direction that does not fit a scene.
pub(crate) fn direction(scene: &Scene, along: &Direction<'_>) -> Result<(), DiffError> {
    state_vector("the direction of the state", scene, along.state)?;
    length("the direction of the control", scene.controls().len(), along.control.len())?;
    finite("the direction of the control", along.control.iter().all(|u| u.is_finite()))?;
    scene_vector("the direction of the scene", scene, along.scene)
}

/// Refuses the direction of a rollout that has another number of steps.
pub(crate) fn steps(along: &RolloutVector, steps: usize) -> Result<(), DiffError> {
    length("the direction of the controls", steps, along.controls.len())
}

/// Refuses the gradient by a scene, or its direction, where it does not fit or is not finite.
pub(crate) fn scene_vector(
    what: &'static str,
    scene: &Scene,
    vector: &SceneVector,
) -> Result<(), DiffError> {
    length(what, scene.bodies().len(), vector.bodies.len())?;
    length(what, scene.joints().len(), vector.joints.len())?;
    length(what, scene.forces().len(), vector.forces.len())?;
    for (body, collider) in vector.bodies.iter().zip(scene.colliders()) {
        length(what, collider.shapes().len(), body.radii.len())?;
        length(what, collider.shapes().len(), body.turns.len())?;
        length(what, collider.vertex_count(), body.vertices.len())?;
    }
    finite(what, scene_is_finite(vector))
}

/// Refuses what is not finite.
pub(crate) fn finite(what: &'static str, good: bool) -> Result<(), DiffError> {
    if good { Ok(()) } else { Err(DiffError::NotFinite { what }) }
}

fn state_is_finite(vector: &StateVector) -> bool {
    vector.time.is_finite() && all_finite(&vector.q) && all_finite(&vector.v)
}

fn scene_is_finite(vector: &SceneVector) -> bool {
    let SceneVector { gravity, dt, bodies, joints, forces } = vector;
    let own = [gravity.x, gravity.y, *dt].iter().all(|x| x.is_finite());
    own && bodies.iter().all(body_is_finite)
        && joints.iter().all(joint_is_finite)
        && all_finite(forces)
}

fn body_is_finite(vector: &BodyVector) -> bool {
    let BodyVector { mass, friction, restitution, radii, vertices, turns } = vector;
    let numbers = mass.iter().chain([friction, restitution]).chain(radii).chain(turns);
    numbers.into_iter().chain(vertices.iter().flatten()).all(|x| x.is_finite())
}

fn joint_is_finite(vector: &JointVector) -> bool {
    let JointVector { anchors: [a, b], length, motor_speed, motor_max, .. } = vector;
    let JointVector { stiffness, damping, lower, upper, .. } = vector;
    let numbers = [length, motor_speed, motor_max, stiffness, damping, lower, upper];
    a.iter().chain(b).chain(numbers).all(|x| x.is_finite())
}

fn all_finite(list: &[Vector3<f64>]) -> bool {
    list.iter().flatten().all(|x| x.is_finite())
}
