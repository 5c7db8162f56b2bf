//! All shapes of one body, ready for contact queries.

use std::sync::Arc;

use crate::{Shape, ShapeError, outline::Outline};

/// The shapes of one body in the body's frame, whose origin is where the body's pose says.
///
/// Copies share what was prepared.
#[derive(Clone, Debug)]
pub struct Collider {
    shapes: Arc<[Shape]>,
    outlines: Arc<[Outline]>,
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
        Ok(Self { shapes: shapes.into(), outlines, radius })
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
