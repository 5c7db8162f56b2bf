//! The solids that bodies are made of.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use crate::{MassProperties, ShapeError, hull, mass, pose};

/// Lengths outside this range are refused: their fourth powers, and products of those, over- or
/// underflow.
const LENGTHS: std::ops::RangeInclusive<f64> = 1e-50..=1e50;

/// A capsule shorter than this times its radius is a circle.
const SHORTEST_CAPSULE: f64 = 1e-9;

/// A convex solid in the frame of its body.
///
/// In a scene file a shape is a table with one entry, `{ circle = { radius = 0.1 } }`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Shape {
    /// A disc.
    Circle {
        /// Radius, m.
        radius: f64,
        /// Centre, m.
        #[serde(default)]
        center: [f64; 2],
    },
    /// A rectangle, turned by an angle about its centre.
    ///
    /// Its vertices are numbered counter-clockwise from (−width/2, −height/2).
    Rectangle {
        /// Side along its own first axis, m.
        width: f64,
        /// Side along its own second axis, m.
        height: f64,
        /// Centre, m.
        #[serde(default)]
        center: [f64; 2],
        /// Angle of its first axis, rad.
        #[serde(default)]
        angle: f64,
    },
    /// The convex hull of some points.
    ///
    /// Its vertices are numbered as [`convex_hull`](crate::convex_hull) lists them: a convex polygon
    /// that is given counter-clockwise keeps its numbers.
    Polygon {
        /// At least three points, m.
        points: Vec<[f64; 2]>,
    },
    /// All points within a radius of a segment.
    Capsule {
        /// One end of the segment, m.
        a: [f64; 2],
        /// The other end, m.
        b: [f64; 2],
        /// Radius, m.
        radius: f64,
    },
    /// Everything on one side of a line: solid where n·x ≤ offset, n = normal/|normal|.
    ///
    /// Only a body that does not move can be unbounded; whoever makes bodies checks that.
    HalfPlane {
        /// Direction out of the solid, of any length.
        normal: [f64; 2],
        /// Distance of the line from the origin along the unit normal, m.
        #[serde(default)]
        offset: f64,
    },
}

impl Shape {
    /// Refuses numbers that describe no solid.
    ///
    /// # Errors
    ///
    /// The first [`ShapeError`] found; it names the field.
    pub fn validate(&self) -> Result<(), ShapeError> {
        match self {
            Self::Circle { radius, center } => {
                positive("radius", *radius)?;
                finite_point("center", center)
            }
            Self::Rectangle { width, height, center, angle } => {
                positive("width", *width)?;
                positive("height", *height)?;
                finite_point("center", center)?;
                finite("angle", *angle)
            }
            Self::Polygon { points } => validate_polygon(points),
            Self::Capsule { a, b, radius } => validate_capsule(a, b, *radius),
            Self::HalfPlane { normal, offset } => {
                finite_point("normal", normal)?;
                finite("offset", *offset)?;
                validate_normal(normal)
            }
        }
    }

    /// Area, centroid and second moment; `None` for a half-plane.
    ///
    /// # Panics
    ///
    /// May panic on a shape that [`Shape::validate`] refuses.
    #[must_use]
    pub fn mass_properties(&self) -> Option<MassProperties> {
        match self {
            Self::Circle { radius, center } => Some(mass::circle(*radius, vector(center))),
            Self::Rectangle { width, height, center, .. } => {
                Some(mass::rectangle(*width, *height, vector(center)))
            }
            Self::Polygon { points } => Some(mass::polygon(&hull::vertices(points))),
            Self::Capsule { a, b, radius } => Some(mass::capsule(vector(a), vector(b), *radius)),
            Self::HalfPlane { .. } => None,
        }
    }

    /// The same shape moved in the body's frame, m.
    #[must_use]
    pub fn translated(&self, by: Vector2<f64>) -> Self {
        let moved = |p: &[f64; 2]| [p[0] + by.x, p[1] + by.y];
        let mut shape = self.clone();
        match &mut shape {
            Self::Circle { center, .. } | Self::Rectangle { center, .. } => *center = moved(center),
            Self::Polygon { points } => points.iter_mut().for_each(|p| *p = moved(p)),
            Self::Capsule { a, b, .. } => (*a, *b) = (moved(a), moved(b)),
            Self::HalfPlane { normal, offset } => *offset += vector(normal).normalize().dot(&by),
        }
        shape
    }
}

/// Corners of a rectangle, counter-clockwise from its own lower left, m.
pub(crate) fn rectangle_corners(
    width: f64,
    height: f64,
    center: &[f64; 2],
    angle: f64,
) -> Vec<Vector2<f64>> {
    let (w, h) = (width / 2.0, height / 2.0);
    let frame = pose::Pose::new(center[0], center[1], angle);
    let corners = [(-w, -h), (w, -h), (w, h), (-w, h)];
    corners.iter().map(|&(x, y)| pose::point(&frame, &Vector2::new(x, y))).collect()
}

/// The two numbers of a scene file as a vector.
pub(crate) fn vector(p: &[f64; 2]) -> Vector2<f64> {
    Vector2::new(p[0], p[1])
}

fn validate_polygon(points: &[[f64; 2]]) -> Result<(), ShapeError> {
    points.iter().try_for_each(|p| finite_point("points", p))?;
    match points.len() {
        count @ 0..3 => Err(ShapeError::TooFewPoints { count }),
        count if count > usize::from(u16::MAX) => {
            Err(ShapeError::TooMany { field: "points", count })
        }
        _ => hull::validate(points),
    }
}

fn validate_capsule(a: &[f64; 2], b: &[f64; 2], radius: f64) -> Result<(), ShapeError> {
    positive("radius", radius)?;
    finite_point("a", a)?;
    finite_point("b", b)?;
    let length = (vector(b) - vector(a)).norm();
    if length <= SHORTEST_CAPSULE * radius || length < *LENGTHS.start() {
        return Err(ShapeError::ZeroLength { length, radius });
    }
    Ok(())
}

fn validate_normal(normal: &[f64; 2]) -> Result<(), ShapeError> {
    // Of a shorter one the square underflows, and the direction is noise.
    if vector(normal).norm() >= *LENGTHS.start() {
        return Ok(());
    }
    Err(ShapeError::ZeroNormal { x: normal[0], y: normal[1] })
}

fn positive(field: &'static str, value: f64) -> Result<(), ShapeError> {
    if !(value.is_finite() && value > 0.0) {
        return Err(ShapeError::NotPositive { field, value });
    }
    if LENGTHS.contains(&value) { Ok(()) } else { Err(ShapeError::OutOfRange { field, value }) }
}

fn finite(field: &'static str, value: f64) -> Result<(), ShapeError> {
    if !value.is_finite() {
        return Err(ShapeError::NotFinite { field, value });
    }
    if value.abs() <= *LENGTHS.end() {
        Ok(())
    } else {
        Err(ShapeError::OutOfRange { field, value })
    }
}

fn finite_point(field: &'static str, point: &[f64; 2]) -> Result<(), ShapeError> {
    point.iter().try_for_each(|&value| finite(field, value))
}
