//! Contact features: the discrete part of a contact, with the local geometry that it needs.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

/// A vertex or an edge of a shape.
///
/// A circle is vertex 0; a capsule has its ends as vertices 0 and 1 and its sides as edges 0 (right
/// of a → b) and 1; a half-plane is edge 0. Polygons number their vertices counter-clockwise, and
/// edge k leads from vertex k to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// Vertex by number.
    Vertex(u16),
    /// Edge by number.
    Edge(u16),
}

/// Names a contact; the same from step to step while the same features touch.
///
/// The order of the fields is the order of contacts everywhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct ContactId {
    /// Indices of bodies a and b, a < b.
    pub bodies: [u32; 2],
    /// Which shape of each body.
    pub shapes: [u16; 2],
    /// Which part of each shape.
    pub parts: [Part; 2],
}

/// Which features touch, and where they are on their bodies.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Feature {
    /// Two points, such as centres of discs; the normal joins them.
    Points {
        /// Point of body a, local, m.
        a: Vector2<f64>,
        /// Point of body b, local, m.
        b: Vector2<f64>,
    },
    /// A line of body a and a point of body b; the normal is the line's.
    LineA {
        /// Some point of a's line, local to a, m.
        point: Vector2<f64>,
        /// Unit normal of the line, outward from a, local to a.
        normal: Vector2<f64>,
        /// Point of body b, local to b, m.
        b: Vector2<f64>,
    },
    /// A point of body a and a line of body b; the normal is opposite to the line's.
    LineB {
        /// Point of body a, local to a, m.
        a: Vector2<f64>,
        /// Some point of b's line, local to b, m.
        point: Vector2<f64>,
        /// Unit normal of the line, outward from b, local to b.
        normal: Vector2<f64>,
    },
}

/// A selected contact before any pose enters: identity, features and the radii around them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactFeature {
    /// Name of the contact.
    pub id: ContactId,
    /// The features that touch.
    pub feature: Feature,
    /// Radius around either feature, m: that of a circle or capsule, else 0.
    pub radii: [f64; 2],
}
