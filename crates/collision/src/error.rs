//! Why a shape is refused and why contacts cannot be found.

use crate::ShapeNumber;

/// A shape whose numbers describe no solid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// A length that must be positive and finite is not.
    #[error("{field} is {value}; it must be positive and finite")]
    NotPositive {
        /// The field, as the scene file names it.
        field: &'static str,
        /// Its value, m.
        value: f64,
    },
    /// A coordinate or an angle is infinite or not a number.
    #[error("{field} is {value}; it must be finite")]
    NotFinite {
        /// The field, as the scene file names it.
        field: &'static str,
        /// Its value.
        value: f64,
    },
    /// A length so large or so small that areas and moments over- or underflow.
    #[error("{field} is {value:e}; lengths from 1e-50 to 1e50 can be computed with, change units")]
    OutOfRange {
        /// The field, as the scene file names it.
        field: &'static str,
        /// Its value, m or rad.
        value: f64,
    },
    /// A polygon with too few points.
    #[error("points has {count} entries; a polygon needs at least 3")]
    TooFewPoints {
        /// Number of points given.
        count: usize,
    },
    /// A polygon whose points lie on one line, or nearly.
    #[error(
        "points span an area of {area} m² over an extent of {extent} m; move a point off the line \
         of the others"
    )]
    DegenerateHull {
        /// Area of the convex hull, m².
        area: f64,
        /// Greater side of the points' bounding box, m.
        extent: f64,
    },
    /// A half-plane without a direction.
    #[error("normal is [{x:?}, {y:?}]; it must have a direction, give for example [0, 1]")]
    ZeroNormal {
        /// First component of the normal.
        x: f64,
        /// Second component of the normal.
        y: f64,
    },
    /// A capsule whose ends coincide.
    #[error("a and b of the capsule are {length} m apart; use a circle of radius {radius} instead")]
    ZeroLength {
        /// Distance of the two ends, m.
        length: f64,
        /// Radius of the capsule, m.
        radius: f64,
    },
    /// A number of another kind of shape.
    #[error("the shape has no number {number:?}; ask it for its numbers")]
    NoSuchNumber {
        /// The number.
        number: ShapeNumber,
    },
    /// A polygon that is changed so far that points become, or cease to be, vertices.
    #[error("{number:?}: moved so far the polygon has other vertices; keep it convex")]
    OtherVertices {
        /// The number that was changed.
        number: ShapeNumber,
    },
    /// More entries than contact identifiers can number.
    #[error("{field} has {count} entries; at most 65535 can be numbered, split the body")]
    TooMany {
        /// The field, as the scene file names it.
        field: &'static str,
        /// Number of entries given.
        count: usize,
    },
}

/// A configuration for which contacts are not defined.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CollisionError {
    /// Two round features have the same centre, so that no direction separates them.
    #[error(
        "the centres of touching round features of bodies {} and {} coincide, so that their contact \
         has no normal; move one of the bodies",
        bodies[0], bodies[1]
    )]
    CoincidentPoints {
        /// Indices of both bodies.
        bodies: [u32; 2],
    },
    /// A pose with an infinite or undefined component.
    #[error("the pose of body {body} is ({x}, {y}, {angle}); it must be finite")]
    PoseNotFinite {
        /// Index of the body.
        body: u32,
        /// First coordinate, m.
        x: f64,
        /// Second coordinate, m.
        y: f64,
        /// Angle, rad.
        angle: f64,
    },
    /// Two bodies so far from each other or so fast that their distance overflows.
    #[error("the distance of bodies {} and {} overflows; they have left the scene", bodies[0], bodies[1])]
    TooFar {
        /// Indices of both bodies.
        bodies: [u32; 2],
    },
    /// A velocity, reach or horizon with an infinite or undefined component.
    #[error("{what} is {value}; it must be finite")]
    NotFinite {
        /// The quantity.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The search for a time of impact did not converge.
    #[error("no time of impact to full accuracy within the first {time} s; shorten the horizon")]
    ImpactNotLocated {
        /// Time that was reached, s.
        time: f64,
    },
}
