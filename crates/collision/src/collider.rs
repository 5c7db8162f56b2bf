//! All shapes of one body, ready for contact queries.

use std::sync::Arc;

use nalgebra::Vector2;

use crate::{Shape, ShapeError, outline::Outline};

/// The shapes of one body in the body's frame, whose origin is where the body's pose says.
///
/// Copies share what was prepared.
#[derive(Clone, Debug)]
pub struct Collider {
    shapes: Arc<[Shape]>,
    outlines: Arc<[Outline]>,
    /// How many vertices the shapes before each have, and all together.
    firsts: Arc<[usize]>,
    radius: f64,
}

impl Collider {
    /// Checks and prepares the shapes; contact identifiers number them in this order. Without shapes
    /// a body touches nothing.
    ///
    /// # Errors
    ///
    /// The first [`ShapeError`] among the shapes.
    pub fn new(shapes: &[Shape]) -> Result<Self, ShapeError> {
        let count = shapes.len();
        if count > usize::from(u16::MAX) {
            return Err(ShapeError::TooMany { field: "shapes", count });
        }
        shapes.iter().try_for_each(Shape::validate)?;
        let outlines: Arc<[Outline]> = shapes.iter().map(Outline::new).collect();
        let radius = outlines.iter().map(|o| o.core_reach() + o.radius).fold(0.0, f64::max);
        let mut firsts = vec![0];
        for outline in outlines.iter() {
            firsts.push(firsts[firsts.len() - 1] + outline.vertices.len());
        }
        Ok(Self { shapes: shapes.into(), outlines, firsts: firsts.into(), radius })
    }

    /// How many vertices all shapes have together; half-planes have one, a point of their line.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.firsts[self.shapes.len()]
    }

    /// The place of a shape's first vertex among those of all shapes.
    ///
    /// # Panics
    /// If there is no such shape.
    #[must_use]
    pub fn first_vertex(&self, shape: usize) -> usize {
        self.firsts[shape]
    }

    /// The two vertices that edge `edge` of a shape leads from and to, by their places among those of all
    /// shapes, and the vector between them, m; `None` of a half-plane, whose edge has no ends.
    ///
    /// # Panics
    /// If there is no such shape.
    #[must_use]
    pub fn edge(&self, shape: usize, edge: usize) -> Option<([usize; 2], Vector2<f64>)> {
        let (outline, first) = (&self.outlines[shape], self.firsts[shape]);
        let count = outline.vertices.len();
        let next = (edge + 1) % count;
        let along = outline.vertices[next] - outline.vertices[edge];
        (!outline.unbounded).then_some(([first + edge, first + next], along))
    }

    /// Radius of a circle about the body's origin that holds all shapes, m; infinite with a
    /// half-plane.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The shapes, as given.
    #[must_use]
    pub fn shapes(&self) -> &[Shape] {
        &self.shapes
    }

    /// Whether there is no shape.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.shapes.is_empty()
    }

    /// Whether it is a copy of the other or the other itself.
    pub(crate) fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.outlines, &other.outlines)
    }

    pub(crate) fn outlines(&self) -> &[Outline] {
        &self.outlines
    }
}
