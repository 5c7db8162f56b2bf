//! Convex hulls, with the numbering that contact identifiers rely on.

use nalgebra::Vector2;

use crate::{ShapeError, shape::vector};

/// A point nearer than this times the extent to a line between two others is not a vertex.
const COLLINEAR: f64 = 1e-10;

/// A hull whose area is below this times the squared extent is refused.
const FLAT: f64 = 1e-9;

/// Hulls of a smaller extent are refused: powers of it underflow, m.
const SMALLEST: f64 = 1e-50;

/// Vertices of the convex hull as indices into `points`, counter-clockwise, the smallest index first.
///
/// A convex polygon that is given counter-clockwise keeps its order. Points on an edge are no
/// vertices. (Andrew 1979, monotone chain. Parry's hull starts anywhere, so it cannot number
/// vertices that parameters of a scene refer to.)
#[must_use]
pub fn convex_hull(points: &[[f64; 2]]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&i, &j| {
        let ([xi, yi], [xj, yj]) = (points[i], points[j]);
        xi.total_cmp(&xj).then(yi.total_cmp(&yj)).then(i.cmp(&j))
    });
    let tolerance = COLLINEAR * extent(points);
    let mut hull = chain(points, order.iter().copied(), tolerance);
    hull.extend(chain(points, order.iter().rev().copied(), tolerance));
    let first = (0..hull.len()).min_by_key(|&k| hull[k]).unwrap_or(0);
    hull.rotate_left(first);
    hull
}

/// Positions of the hull's vertices, m.
pub(crate) fn vertices(points: &[[f64; 2]]) -> Vec<Vector2<f64>> {
    convex_hull(points).into_iter().map(|i| vector(&points[i])).collect()
}

/// Refuses a hull that is (nearly) a segment or a point.
pub(crate) fn validate(points: &[[f64; 2]]) -> Result<(), ShapeError> {
    let hull = vertices(points);
    let extent = extent(points);
    let area = area(&hull);
    if extent > 0.0 && extent < SMALLEST {
        return Err(ShapeError::OutOfRange { field: "extent of points", value: extent });
    }
    if hull.len() >= 3 && area > FLAT * extent * extent {
        return Ok(());
    }
    Err(ShapeError::DegenerateHull { area, extent })
}

/// Twice the area of the triangle o p q, positive when counter-clockwise, m².
pub(crate) fn cross(o: &Vector2<f64>, p: &Vector2<f64>, q: &Vector2<f64>) -> f64 {
    (p - o).perp(&(q - o))
}

/// One half of the hull over sorted points, without its last point.
fn chain(points: &[[f64; 2]], order: impl Iterator<Item = usize>, tolerance: f64) -> Vec<usize> {
    let at = |i: usize| vector(&points[i]);
    let mut half: Vec<usize> = Vec::new();
    for k in order {
        while let [.., i, j] = half[..] {
            let base = (at(k) - at(i)).norm();
            if cross(&at(i), &at(j), &at(k)) > tolerance * base {
                break;
            }
            half.pop();
        }
        half.push(k);
    }
    half.pop();
    half
}

fn area(hull: &[Vector2<f64>]) -> f64 {
    hull.windows(2).map(|w| cross(&hull[0], &w[0], &w[1]) / 2.0).sum()
}

/// Greater side of the bounding box, m.
fn extent(points: &[[f64; 2]]) -> f64 {
    let side = |axis: usize| {
        let values = points.iter().map(|p| p[axis]);
        values.clone().fold(f64::NEG_INFINITY, f64::max) - values.fold(f64::INFINITY, f64::min)
    };
    side(0).max(side(1))
}
