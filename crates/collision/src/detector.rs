//! Contact queries over bodies that move little from one to the next.

use nalgebra::Vector2;

use crate::{
    Collider, CollisionError, Contact, ContactFeature, ContactId, Feature, Near, Part,
    broad_phase::BroadPhase,
    pose::Frame,
    select::{self, Pair, Seams},
    world::{View, World},
};

/// A normal whose squared length is further from one is noise.
const UNIT: f64 = 1e-9;

/// Placed bodies, and the memory of the queries about them.
///
/// What did not move since the last placement is not placed again, and nothing is allocated once
/// everything has been seen. Answers depend on the last placement only.
#[derive(Debug, Default)]
pub struct Detector {
    world: World,
    broad_phase: BroadPhase,
    fixed: Vec<bool>,
}

impl Detector {
    /// Places bodies: their colliders, frames, and which are fixed, in equal numbers. Fixed bodies do
    /// not touch each other.
    ///
    /// # Errors
    ///
    /// [`CollisionError::PoseNotFinite`]; the last placement then stays.
    pub fn place(
        &mut self,
        colliders: &[Collider],
        frames: &[Frame],
        fixed: &[bool],
    ) -> Result<(), CollisionError> {
        frames.iter().enumerate().try_for_each(|(i, frame)| finite_pose(i, frame))?;
        self.world.place(colliders, frames);
        let same = self.fixed == fixed;
        if !same {
            self.fixed.clear();
            self.fixed.extend_from_slice(fixed);
        }
        self.broad_phase.update(&self.world, fixed, same);
        Ok(())
    }

    /// Replaces `pairs` by those pairs of bodies whose boxes are no further apart than the greater of
    /// the two bodies' reaches (m, one per body), in ascending order.
    pub fn near(&mut self, reach: &[f64], pairs: &mut Vec<Near>) {
        self.broad_phase.pairs(&self.world, &self.fixed, reach, pairs);
    }

    /// Appends the contacts of two bodies, a < b, with gap ≤ `reach` (m), in the order of their
    /// identifiers.
    ///
    /// # Errors
    ///
    /// [`CollisionError::CoincidentPoints`] when the centres of two round features coincide;
    /// [`CollisionError::TooFar`].
    pub fn between(
        &self,
        [a, b]: [u32; 2],
        reach: f64,
        found: &mut Vec<Contact>,
    ) -> Result<(), CollisionError> {
        for (k, view_a) in (0..).zip(self.world.views(a as usize)) {
            for (l, view_b) in (0..).zip(self.world.views(b as usize)) {
                if !view_a.piece.bounds.near(&view_b.piece.bounds, reach) {
                    continue;
                }
                for parts in select::select(&view_a, &view_b, reach, Seams::Skip).iter() {
                    let id = ContactId { bodies: [a, b], shapes: [k, l], parts };
                    let contact = contact(&self.world, [&view_a, &view_b], id)?;
                    if contact.gap <= reach {
                        found.push(contact);
                    }
                }
            }
        }
        Ok(())
    }
}

/// The named contact of two placed outlines.
#[inline]
pub(crate) fn contact(
    world: &World,
    views: [&View<'_>; 2],
    id: ContactId,
) -> Result<Contact, CollisionError> {
    let (feature, [x_a, x_b, line]) = geometry(world, views, id.parts);
    let radii = views.map(|view| view.piece.radius);
    let contact = ContactFeature { id, feature, radii }.placed(x_a, x_b, line);
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

/// The features, and in the world the points of a and b and the line's normal.
#[inline]
fn geometry(world: &World, [a, b]: [&View<'_>; 2], parts: Pair) -> (Feature, [Vector2<f64>; 3]) {
    let (local, local_normal) = (World::local_vertex, World::local_normal);
    let vertex = |view: &View<'_>, k: u16| view.vertices[usize::from(k)];
    let normal = |view: &View<'_>, k: u16| view.normals[usize::from(k)];
    match parts {
        [Part::Vertex(v), Part::Vertex(w)] => (
            Feature::Points { a: local(world, a, v), b: local(world, b, w) },
            [vertex(a, v), vertex(b, w), Vector2::zeros()],
        ),
        [Part::Edge(e), Part::Vertex(w)] => (
            Feature::LineA {
                point: local(world, a, e),
                normal: local_normal(world, a, e),
                b: local(world, b, w),
            },
            [vertex(a, e), vertex(b, w), normal(a, e)],
        ),
        [Part::Vertex(v), Part::Edge(e)] => (
            Feature::LineB {
                a: local(world, a, v),
                point: local(world, b, e),
                normal: local_normal(world, b, e),
            },
            [vertex(a, v), vertex(b, e), normal(b, e)],
        ),
        [Part::Edge(_), Part::Edge(_)] => unreachable!("selection pairs an edge with a vertex"),
    }
}

/// Refuses a pose with an infinite or undefined component.
pub(crate) fn finite_pose(body: usize, frame: &Frame) -> Result<(), CollisionError> {
    let [x, y, angle] = (*frame.pose()).into();
    // All three at once, since nearly all poses are finite.
    if x.is_finite() & y.is_finite() & angle.is_finite() {
        return Ok(());
    }
    let body = u32::try_from(body).expect("bodies are numbered with 32 bits");
    Err(CollisionError::PoseNotFinite { body, x, y, angle })
}
