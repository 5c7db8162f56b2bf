//! From placed bodies to the ordered list of contacts.

use crate::{
    Collider, CollisionError, Contact, ContactFeature, ContactId, Feature, Part, Pose, broad_phase,
    outline::Outline,
    pose::Frame,
    select::{self, Pair, Seams},
    world::World,
};

/// A normal whose squared length is further from one is noise.
const UNIT: f64 = 1e-9;

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
/// `collide` is asked only about pairs whose boxes are within reach.
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
    bodies.iter().enumerate().try_for_each(|(i, body)| finite_pose(i, &body.pose))?;
    if reach.is_nan() {
        return Err(CollisionError::NotFinite { what: "reach", value: reach });
    }
    let world = World::new(bodies);
    let mut found = Vec::new();
    for (i, j) in broad_phase::pairs(&world.bounds(), reach) {
        if collide(i, j) {
            between(bodies, &world, [i, j], reach, &mut found)?;
        }
    }
    debug_assert!(found.is_sorted_by_key(|contact| contact.feature.id));
    Ok(found)
}

/// Appends the contacts of one pair of bodies, in the order of their identifiers.
fn between(
    bodies: &[Placed<'_>],
    world: &World,
    [i, j]: [usize; 2],
    reach: f64,
    found: &mut Vec<Contact>,
) -> Result<(), CollisionError> {
    let colliders = [bodies[i].collider, bodies[j].collider];
    let indices = [body_number(i), body_number(j)];
    for (k, view_a) in (0..).zip(world.views(i)) {
        for (l, view_b) in (0..).zip(world.views(j)) {
            if !view_a.bounds.near(&view_b.bounds, reach) {
                continue;
            }
            for parts in select::select(&view_a, &view_b, reach, Seams::Skip).iter() {
                let id = ContactId { bodies: indices, shapes: [k, l], parts };
                let contact = contact(colliders, [world.frame(i), world.frame(j)], id)?;
                if contact.gap <= reach {
                    found.push(contact);
                }
            }
        }
    }
    Ok(())
}

/// The named contact, evaluated where the bodies are.
pub(crate) fn contact(
    [a, b]: [&Collider; 2],
    [frame_a, frame_b]: [&Frame; 2],
    id: ContactId,
) -> Result<Contact, CollisionError> {
    let core_a = &a.outlines()[usize::from(id.shapes[0])];
    let core_b = &b.outlines()[usize::from(id.shapes[1])];
    let feature = geometry(core_a, core_b, id.parts);
    let radii = [core_a.radius, core_b.radius];
    let contact = ContactFeature { id, feature, radii }.evaluate_in(frame_a, frame_b);
    if !(contact.gap.is_finite() && contact.point.iter().all(|x| x.is_finite())) {
        let bodies = id.bodies;
        let coincide = contact.gap.abs() < f64::INFINITY;
        return Err(if coincide {
            CollisionError::CoincidentPoints { bodies }
        } else {
            CollisionError::TooFar { bodies }
        });
    }
    // Of points that nearly coincide the squares underflow.
    if (contact.normal.norm_squared() - 1.0).abs() > UNIT {
        return Err(CollisionError::CoincidentPoints { bodies: id.bodies });
    }
    Ok(contact)
}

fn geometry(a: &Outline, b: &Outline, parts: Pair) -> Feature {
    let vertex = |core: &Outline, k: u16| core.vertices[usize::from(k)];
    let line = |core: &Outline, k: u16| (vertex(core, k), core.normals[usize::from(k)]);
    match parts {
        [Part::Vertex(v), Part::Vertex(w)] => Feature::Points { a: vertex(a, v), b: vertex(b, w) },
        [Part::Edge(e), Part::Vertex(w)] => {
            let (point, normal) = line(a, e);
            Feature::LineA { point, normal, b: vertex(b, w) }
        }
        [Part::Vertex(v), Part::Edge(e)] => {
            let (point, normal) = line(b, e);
            Feature::LineB { a: vertex(a, v), point, normal }
        }
        [Part::Edge(_), Part::Edge(_)] => unreachable!("selection pairs an edge with a vertex"),
    }
}

/// Refuses a pose with an infinite or undefined component.
pub(crate) fn finite_pose(body: usize, pose: &Pose) -> Result<(), CollisionError> {
    if pose.iter().all(|c| c.is_finite()) {
        return Ok(());
    }
    let [x, y, angle] = (*pose).into();
    Err(CollisionError::PoseNotFinite { body: body_number(body), x, y, angle })
}

fn body_number(index: usize) -> u32 {
    u32::try_from(index).expect("bodies are numbered with 32 bits")
}
