//! What of a line or a convex polygon is inside a rectangle (Sutherland & Hodgman 1974).
//!
//! A scene may reach far beyond its picture; the rasteriser counts in `f32` and is given no more than is
//! seen. Convex forms stay convex.

/// A point of the picture, pixels.
pub(crate) type Point = [f64; 2];

/// The points x of a convex polygon where height(x) ≤ 0, for a linear function `height`.
///
/// An edge from a to b leaves or enters at a + s (b − a), s = h_a / (h_a − h_b).
pub(crate) fn below(points: &[Point], height: impl Fn(Point) -> f64) -> Vec<Point> {
    let mut kept = Vec::with_capacity(points.len() + 1);
    for (i, b) in points.iter().enumerate() {
        let a = &points[(i + points.len() - 1) % points.len()];
        let (ha, hb) = (height(*a), height(*b));
        if (ha > 0.0) != (hb > 0.0) {
            let s = ha / (ha - hb);
            kept.push([0, 1].map(|k| a[k] + s * (b[k] - a[k])));
        }
        if hb <= 0.0 {
            kept.push(*b);
        }
    }
    kept
}

/// The part of a convex polygon within `lower` and `upper`; of a line too, as a polygon of two points.
pub(crate) fn within(points: &[Point], lower: Point, upper: Point) -> Vec<Point> {
    let inside = |p: &Point| (0..2).all(|k| lower[k] <= p[k] && p[k] <= upper[k]);
    let mut kept = points.to_vec();
    if kept.iter().all(inside) {
        return kept;
    }
    for k in 0..2 {
        kept = below(&kept, |p| lower[k] - p[k]);
        kept = below(&kept, |p| p[k] - upper[k]);
    }
    kept
}
