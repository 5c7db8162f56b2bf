//! The numbers of a shape, and how its outline follows them.
//!
//! ```text
//!  rectangle    vertex = c + R(α) (± w/2, ± h/2)      ∂c = e        ∂w, ∂h = R (± ½, 0), R (0, ± ½)
//!                                                     ∂α = ⊥(vertex − c)
//!  polygon, capsule     vertices are numbers themselves
//!  half-plane   n̂ = m/|m|,  point = n̂ offset          ∂offset = n̂   ∂m: dψ = ⊥n̂·dm/|m|, dn̂ = ⊥n̂ dψ
//! ```

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use crate::pose::perp;
use crate::shape::{rectangle_corners, vector};
use crate::{Shape, ShapeError, hull};

/// A number of a shape that has a derivative, besides [radii](Shape::Circle). Axes 0, 1 are x, y of the
/// body's frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ShapeNumber {
    /// Width (0) or height (1) of a rectangle, m.
    Size(usize),
    /// Centre of a circle or a rectangle, m.
    Center(usize),
    /// Angle of a rectangle's first axis, rad.
    Angle,
    /// A point of a polygon by its place in the list, or an end (0, 1) of a capsule, and an axis, m.
    /// Points that are no vertices of the hull are none.
    Vertex(usize, usize),
    /// Offset of a half-plane, m.
    Offset,
    /// Normal of a half-plane, of any length.
    Normal(usize),
}

/// How an outline changes with a number.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OutlineChange {
    /// Of its vertices, in the order of [`Part::Vertex`](crate::Part::Vertex).
    pub vertices: Vec<Vector2<f64>>,
    /// Of the direction of a half-plane's normal, rad.
    pub turn: f64,
}

impl Shape {
    /// The value of a number; `None` if the shape has none such.
    #[must_use]
    pub fn number(&self, number: ShapeNumber) -> Option<f64> {
        let mut copy = self.clone();
        copy.number_mut(number).map(|value| *value)
    }

    /// The shape with another value of a number.
    ///
    /// # Errors
    /// What [`Shape::validate`] refuses; [`ShapeError::NoSuchNumber`] for a number that the shape has not,
    /// and [`ShapeError::OtherVertices`] where a polygon would have other vertices than before.
    pub fn with_number(&self, number: ShapeNumber, value: f64) -> Result<Self, ShapeError> {
        let mut changed = self.clone();
        *changed.number_mut(number).ok_or(ShapeError::NoSuchNumber { number })? = value;
        changed.validate()?;
        if let (Self::Polygon { points: old }, Self::Polygon { points: new }) = (self, &changed)
            && hull::convex_hull(old) != hull::convex_hull(new)
        {
            return Err(ShapeError::OtherVertices { number });
        }
        Ok(changed)
    }

    fn number_mut(&mut self, number: ShapeNumber) -> Option<&mut f64> {
        match (self, number) {
            (Self::Rectangle { width, .. }, ShapeNumber::Size(0)) => Some(width),
            (Self::Rectangle { height, .. }, ShapeNumber::Size(1)) => Some(height),
            (
                Self::Circle { center, .. } | Self::Rectangle { center, .. },
                ShapeNumber::Center(axis),
            ) => center.get_mut(axis),
            (Self::Rectangle { angle, .. }, ShapeNumber::Angle) => Some(angle),
            (Self::Polygon { points }, ShapeNumber::Vertex(k, axis)) => {
                let is_vertex = hull::convex_hull(points).contains(&k);
                points.get_mut(k).filter(|_| is_vertex)?.get_mut(axis)
            }
            (Self::Capsule { a, .. }, ShapeNumber::Vertex(0, axis)) => a.get_mut(axis),
            (Self::Capsule { b, .. }, ShapeNumber::Vertex(1, axis)) => b.get_mut(axis),
            (Self::HalfPlane { offset, .. }, ShapeNumber::Offset) => Some(offset),
            (Self::HalfPlane { normal, .. }, ShapeNumber::Normal(axis)) => normal.get_mut(axis),
            _ => None,
        }
    }

    /// All numbers of the shape.
    #[must_use]
    pub fn numbers(&self) -> Vec<ShapeNumber> {
        let both = |of: fn(usize) -> ShapeNumber| [of(0), of(1)];
        match self {
            Self::Circle { .. } => both(ShapeNumber::Center).to_vec(),
            Self::Rectangle { .. } => {
                let lengths = [both(ShapeNumber::Size), both(ShapeNumber::Center)].concat();
                [lengths, vec![ShapeNumber::Angle]].concat()
            }
            Self::Polygon { points } => vertices(hull::convex_hull(points)),
            Self::Capsule { .. } => vertices(vec![0, 1]),
            Self::HalfPlane { .. } => {
                [vec![ShapeNumber::Offset], both(ShapeNumber::Normal).to_vec()].concat()
            }
        }
    }

    /// How the outline changes with a number that the shape has.
    #[must_use]
    pub fn outline_change(&self, number: ShapeNumber) -> OutlineChange {
        let unit = |axis: usize| Vector2::ith(axis, 1.0);
        let mut change = OutlineChange::default();
        match (self, number) {
            (Self::Circle { .. }, ShapeNumber::Center(axis)) => change.vertices = vec![unit(axis)],
            (Self::Rectangle { width, height, center, angle }, _) => {
                change.vertices = rectangle_change([*width, *height], center, *angle, number);
            }
            (Self::Polygon { points }, ShapeNumber::Vertex(k, axis)) => {
                let moved = |i: usize| if i == k { unit(axis) } else { Vector2::zeros() };
                change.vertices = hull::convex_hull(points).into_iter().map(moved).collect();
            }
            (Self::Capsule { .. }, ShapeNumber::Vertex(k, axis)) => {
                change.vertices = vec![Vector2::zeros(); 2];
                change.vertices[k] = unit(axis);
            }
            (Self::HalfPlane { normal, .. }, ShapeNumber::Offset) => {
                change.vertices = vec![vector(normal).normalize()];
            }
            (Self::HalfPlane { normal, offset }, ShapeNumber::Normal(axis)) => {
                let n = vector(normal).normalize();
                change.turn = perp(&n)[axis] / vector(normal).norm();
                change.vertices = vec![perp(&n) * (change.turn * offset)];
            }
            _ => {}
        }
        change
    }
}

fn vertices(list: Vec<usize>) -> Vec<ShapeNumber> {
    list.into_iter().flat_map(|k| [0, 1].map(|axis| ShapeNumber::Vertex(k, axis))).collect()
}

fn rectangle_change(
    [width, height]: [f64; 2],
    center: &[f64; 2],
    angle: f64,
    number: ShapeNumber,
) -> Vec<Vector2<f64>> {
    match number {
        ShapeNumber::Size(0) => rectangle_corners(1.0, 0.0, &[0.0; 2], angle),
        ShapeNumber::Size(_) => rectangle_corners(0.0, 1.0, &[0.0; 2], angle),
        ShapeNumber::Center(axis) => vec![Vector2::ith(axis, 1.0); 4],
        ShapeNumber::Angle => {
            let corners = rectangle_corners(width, height, center, angle);
            corners.iter().map(|corner| perp(&(corner - vector(center)))).collect()
        }
        _ => Vec::new(),
    }
}
