//! How a state moves with a joint: all bodies beyond it together.
//!
//! The free coordinate of the joint changes, all other joints and all rates stay. With c the anchor and
//! v_c the velocity of the bodies on the near side there, u the axis of a sliding joint, fixed in a:
//!
//! ```text
//!  hinge     dpᵢ = ⊥(pᵢ − c)   dθᵢ = 1      dvᵢ = ⊥(vᵢ − v_c)   dωᵢ = 0       by the angle
//!                                           dvᵢ = ⊥(pᵢ − c)     dωᵢ = 1       by its rate
//!  slide     dpᵢ = u           dθᵢ = 0      dvᵢ = ω_a ⊥u        dωᵢ = 0       by the offset
//!                                           dvᵢ = u             dωᵢ = 0       by its rate
//! ```
//!
//! If the far side holds the ground, it is the near side that moves, the other way round. If both sides do,
//! the joint is part of a loop, and what moves with it follows from the rows of all joints ([`loop_motion`]).

use nalgebra::{Vector2, Vector3};
use tangency_collision::pose::{Frame, perp};
use tangency_core::measure::Measure;
use tangency_core::{Joint, Scene, State};

use crate::loop_motion::loop_motion;
use crate::vector::StateVector;

/// The directions in which a state changes with a joint.
#[derive(Clone, Debug, PartialEq)]
pub struct JointMotion {
    /// With its free coordinate (an angle, rad, or an offset, m).
    pub coordinate: StateVector,
    /// With the rate of that, rad/s or m/s.
    pub rate: StateVector,
}

/// A joint with which nothing moves by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum JointMotionError {
    /// There is no such joint.
    #[error("the scene has no joint {joint}; it has {count}, counted from 0")]
    NoSuchJoint {
        /// The index.
        joint: usize,
        /// How many there are.
        count: usize,
    },
    /// The joint leaves nothing free.
    #[error("joint {joint} leaves neither an angle nor an offset free; take a hinge or a slide")]
    NothingFree {
        /// The joint.
        joint: usize,
    },
    /// Its bodies are part of a loop, which can move while the joint does not.
    #[error(
        "joint {joint} is part of a loop that has {ways} more ways to move, so that it does not tell how the \
         others move; give the positions of all bodies of the loop a direction"
    )]
    NotUnique {
        /// The joint.
        joint: usize,
        /// In how many independent ways.
        ways: usize,
    },
    /// Its bodies are part of a loop that does not let it move, or not from this state.
    #[error("joint {joint} is part of a loop that holds it; take a joint that can move")]
    Blocked {
        /// The joint.
        joint: usize,
    },
}

/// The directions in which a state changes with one of its scene's joints: all that lies beyond it moves, or,
/// if the joint is part of a loop with one way to move, the whole loop. Springs and soft joints connect nothing.
/// A loop's rates are taken to be those that its joints allow.
///
/// With a [`gradient`](crate::gradient()), `motion.coordinate.dot(&gradient.by.initial)` is the derivative
/// by the joint's initial angle; as `initial` of a [`RolloutVector`](crate::RolloutVector) it is a direction
/// for [`tangent`](crate::tangent()).
///
/// # Errors
/// [`JointMotionError`] where the joint does not move by itself.
///
/// # Panics
/// If the state belongs to another scene.
pub fn joint_motion(
    scene: &Scene,
    state: &State,
    joint: usize,
) -> Result<JointMotion, JointMotionError> {
    let count = scene.joints().len();
    let it = scene.joints().get(joint).ok_or(JointMotionError::NoSuchJoint { joint, count })?;
    let free = it.free.ok_or(JointMotionError::NothingFree { joint })?;
    let beyond = |side: usize| reach(scene, joint, side).map(|bodies| (side, bodies));
    let Some((side, bodies)) = beyond(1).or_else(|| beyond(0)) else {
        return loop_motion(scene, state, joint, free);
    };
    let sign = if side == 1 { 1.0 } else { -1.0 };
    let [a, _] = it.bodies.map(|body| body.map_or_else(Vector3::zeros, |body| state.v[body]));
    let mut coordinate = StateVector::like(state);
    let mut rate = StateVector::like(state);
    let axis = match free.measure {
        Measure::OnA { axis_local } => Some(frame_of(state, it.bodies[0]).direction(&axis_local)),
        Measure::World { axis } => Some(axis),
        Measure::Angle | Measure::Length => None,
    };
    let [center, carried] = near(scene, state, it, joint, 1 - side);
    for body in bodies {
        let (q, v) = (&state.q[body], &state.v[body]);
        let arm = perp(&(q.xy() - center));
        let hinge = || (with_turn(&arm, 1.0), with_turn(&perp(&(v.xy() - carried)), 0.0));
        let slide = |u: Vector2<f64>| (with_turn(&u, 0.0), with_turn(&(perp(&u) * a.z), 0.0));
        let (dq, dv) = axis.map_or_else(hinge, slide);
        (coordinate.q[body], coordinate.v[body], rate.v[body]) = (dq * sign, dv * sign, dq * sign);
    }
    Ok(JointMotion { coordinate, rate })
}

/// c and v_c: the anchor, and the velocity with which a side carries it.
fn near(scene: &Scene, state: &State, it: &Joint, joint: usize, side: usize) -> [Vector2<f64>; 2] {
    let center = scene.joint_anchors(joint, state)[side];
    let carried = it.bodies[side].map_or_else(Vector2::zeros, |body| {
        let (q, v) = (&state.q[body], &state.v[body]);
        v.xy() + perp(&(center - q.xy())) * v.z
    });
    [center, carried]
}

/// Whether a joint connects its bodies.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "filters take references")]
pub(crate) fn holds(it: &&Joint) -> bool {
    it.softness.is_none() && !it.held.is_empty()
}

/// The bodies that hang together on a side of a joint; `None` if they hold the ground or the other side.
fn reach(scene: &Scene, joint: usize, side: usize) -> Option<Vec<usize>> {
    let [first, other] = [side, 1 - side].map(|side| scene.joints()[joint].bodies[side]);
    let mut found = vec![first?];
    let mut next = 0;
    while next < found.len() {
        let body = found[next];
        next += 1;
        if !scene.is_dynamic(body) || Some(body) == other {
            return None;
        }
        let joints = scene.joints().iter().enumerate().filter(|(j, _)| *j != joint);
        for it in
            joints.map(|(_, it)| it).filter(holds).filter(|it| it.bodies.contains(&Some(body)))
        {
            for neighbour in it.bodies {
                let neighbour = neighbour?;
                if !found.contains(&neighbour) {
                    found.push(neighbour);
                }
            }
        }
    }
    Some(found)
}

fn frame_of(state: &State, body: Option<usize>) -> Frame {
    Frame::new(&body.map_or_else(Vector3::zeros, |body| state.q[body]))
}

fn with_turn(along: &Vector2<f64>, turn: f64) -> Vector3<f64> {
    Vector3::new(along.x, along.y, turn)
}
