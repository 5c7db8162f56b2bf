//! Which contacts and limits are in reach of a step.

use nalgebra::Vector3;
use tangency_collision::{Contact, Placed, contacts};

use crate::compile::LEAST;
use crate::scene::Scene;
use crate::{ContactModel, State, StepError};

/// How far anything can move towards anything else within one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Reach {
    /// m.
    pub(crate) linear: f64,
    /// rad.
    pub(crate) angular: f64,
}

/// Bounds by the fastest body: a collision may pass its speed on to any other.
pub(crate) fn reach(scene: &Scene, v: &[Vector3<f64>], momentum: &[Vector3<f64>]) -> Reach {
    let (mut linear, mut angular) = (0.0_f64, 0.0_f64);
    for (i, body) in scene.bodies.iter().enumerate() {
        let free = if scene.is_dynamic(i) { momentum[i].component_div(&body.mass) } else { v[i] };
        let radius = Some(scene.colliders[i].radius()).filter(|r| r.is_finite()).unwrap_or(0.0);
        let speed = v[i].xy().norm().max(free.xy().norm());
        let rate = v[i].z.abs().max(free.z.abs());
        let dynamic = scene.is_dynamic(i);
        let gyration = if dynamic { (body.mass.z / body.mass.x).sqrt() } else { scene.size(i) };
        linear = linear.max(speed + rate * radius);
        angular = angular.max(rate + speed / gyration);
    }
    Reach { linear: 2.0 * scene.dt * linear, angular: 2.0 * scene.dt * angular }
}

/// Contacts that the step must know of, in the order of their ids.
///
/// # Errors
/// [`StepError::Collision`] or [`StepError::CoincidentAnchors`] where geometry has no answer
/// (coincident centres, a distance of zero).
pub(crate) fn detect(
    scene: &Scene,
    state: &State,
    reach: Reach,
) -> Result<Vec<Contact>, StepError> {
    check_lengths(scene, state)?;
    let reach = match scene.def.contact_model {
        ContactModel::Gap => reach.linear,
        ContactModel::Velocity { contact_distance } => contact_distance,
    };
    contacts_within(scene, state, reach)
}

/// Refuses distances of zero, which have no direction.
fn check_lengths(scene: &Scene, state: &State) -> Result<(), StepError> {
    let distance = |index: usize| {
        let [a, b] = scene.joint_anchors(index, state);
        (b - a).norm()
    };
    let collapsed = |index: &usize| scene.joints[*index].holds_length() && distance(*index) < LEAST;
    let Some(index) = (0..scene.joints.len()).find(collapsed) else { return Ok(()) };
    let (time, joint) = (state.time, scene.joints[index].name.clone());
    Err(StepError::CoincidentAnchors { time, joint })
}

/// Contacts with a gap of at most `reach`.
///
/// # Errors
/// As [`detect`].
pub(crate) fn contacts_within(
    scene: &Scene,
    state: &State,
    reach: f64,
) -> Result<Vec<Contact>, StepError> {
    let placed: Vec<Placed<'_>> = (scene.colliders.iter().zip(&state.q))
        .map(|(collider, pose)| Placed { collider, pose: *pose })
        .collect();
    contacts(&placed, reach, &|a, b| scene.collides(a, b))
        .map_err(|source| StepError::Collision { time: state.time, source })
}
