//! From placed bodies to the ordered list of contacts, in one call.

use crate::{Collider, CollisionError, Contact, Detector, Pose, pose::Frame};

/// A collider and where it is.
#[derive(Clone, Copy, Debug)]
pub struct Placed<'a> {
    /// The shapes in the body's frame.
    pub collider: &'a Collider,
    /// Pose of the body's frame, (x, y, θ) in (m, m, rad).
    pub pose: Pose,
}

/// All contacts with gap ≤ `reach` (m) between bodies for which `collide(i, j)`, i < j, holds.
///
/// Body a of a contact has the lower index, and contacts are in the order of their identifiers.
/// Edges that face each other have two contacts as far as both ends are within reach, other pairs of
/// shapes one. Two half-planes have none, and so has a polygon that is flush (to a millionth of its
/// size) with another's edge but beyond the end of it: it slides over seams between plates.
///
/// `collide` is asked only about pairs whose boxes are within reach. Whoever asks again and again
/// keeps a [`Detector`] instead.
///
/// # Errors
///
/// [`CollisionError::PoseNotFinite`]; [`CollisionError::NotFinite`] when `reach` is not a number;
/// [`CollisionError::CoincidentPoints`] when the centres of two round features coincide.
pub fn contacts(
    bodies: &[Placed<'_>],
    reach: f64,
    collide: &dyn Fn(usize, usize) -> bool,
) -> Result<Vec<Contact>, CollisionError> {
    let colliders: Vec<Collider> = bodies.iter().map(|body| body.collider.clone()).collect();
    let frames: Vec<Frame> = bodies.iter().map(|body| Frame::new(&body.pose)).collect();
    let mut detector = Detector::default();
    detector.place(&colliders, &frames, &vec![false; bodies.len()])?;
    if reach.is_nan() {
        return Err(CollisionError::NotFinite { what: "reach", value: reach });
    }
    let (mut near, mut found) = (Vec::new(), Vec::new());
    detector.near(&vec![reach; bodies.len()], &mut near);
    for pair in near {
        if collide(pair.bodies[0] as usize, pair.bodies[1] as usize) {
            detector.between(pair.bodies, reach, &mut found)?;
        }
    }
    debug_assert!(found.is_sorted_by_key(|contact| contact.feature.id));
    Ok(found)
}
