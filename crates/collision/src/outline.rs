//! One description for all shapes: a convex core and a radius around it.
//!
//! | shape      | core          | edges                          | radius |
//! |------------|---------------|--------------------------------|--------|
//! | circle     | a point       | none                           | r      |
//! | capsule    | a segment     | two, one for either side       | r      |
//! | polygon    | itself        | one after each vertex          | 0      |
//! | half-plane | a point of it | the line                       | 0      |
//!
//! Vertices run counter-clockwise; edge k leads from vertex k to the next.

use nalgebra::Vector2;

use crate::{Shape, hull, pose::perp, shape};

/// A shape's core in the body's frame, and the radius around it.
#[derive(Clone, Debug)]
pub(crate) struct Outline {
    /// Vertices of the core, m; for a half-plane one point of its line.
    pub(crate) vertices: Vec<Vector2<f64>>,
    /// Unit outward normals of the edges.
    pub(crate) normals: Vec<Vector2<f64>>,
    /// Radius around the core, m.
    pub(crate) radius: f64,
    /// Whether it is a half-plane.
    pub(crate) unbounded: bool,
    /// Order of magnitude of the shape, m; tolerances are relative to it.
    pub(crate) size: f64,
}

impl Outline {
    /// The outline of a valid shape.
    pub(crate) fn new(shape: &Shape) -> Self {
        match shape {
            Shape::Circle { radius, center } => Self::core(vec![shape::vector(center)], *radius),
            Shape::Rectangle { width, height, center, angle } => {
                Self::core(shape::rectangle_corners(*width, *height, center, *angle), 0.0)
            }
            Shape::Polygon { points } => Self::core(hull::vertices(points), 0.0),
            Shape::Capsule { a, b, radius } => {
                Self::core(vec![shape::vector(a), shape::vector(b)], *radius)
            }
            Shape::HalfPlane { normal, offset } => {
                Self::half_plane(shape::vector(normal).normalize(), *offset)
            }
        }
    }

    /// Greatest distance of a point of the core from the body's origin, m.
    pub(crate) fn core_reach(&self) -> f64 {
        if self.unbounded {
            return f64::INFINITY;
        }
        self.vertices.iter().map(Vector2::norm).fold(0.0, f64::max)
    }

    fn core(vertices: Vec<Vector2<f64>>, radius: f64) -> Self {
        let normals = edge_normals(&vertices);
        let span = vertices.iter().map(|v| (v - vertices[0]).norm()).fold(0.0, f64::max);
        Self { vertices, normals, radius, unbounded: false, size: span + radius }
    }

    fn half_plane(normal: Vector2<f64>, offset: f64) -> Self {
        let vertices = vec![normal * offset];
        Self { vertices, normals: vec![normal], radius: 0.0, unbounded: true, size: 0.0 }
    }
}

/// A counter-clockwise outline has its outside on the right of each edge.
fn edge_normals(vertices: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
    if vertices.len() < 2 {
        return Vec::new();
    }
    let next = vertices.iter().cycle().skip(1);
    vertices.iter().zip(next).map(|(v, w)| -perp(&(w - v).normalize())).collect()
}
