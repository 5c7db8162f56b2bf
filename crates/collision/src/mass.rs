//! Area, centroid and second moment of area in closed form.

use std::f64::consts::PI;

use nalgebra::Vector2;

use crate::hull::cross;

/// What a shape contributes to its body's mass and inertia, per unit of density.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassProperties {
    /// Area, m².
    pub area: f64,
    /// Centroid in the body's frame, m.
    pub centroid: Vector2<f64>,
    /// Polar second moment of area about the centroid, m⁴.
    pub second_moment: f64,
}

impl MassProperties {
    /// The properties of several parts taken together; `None` without parts.
    ///
    /// Where parts overlap, the overlap counts twice.
    ///
    /// ```text
    /// A = Σ Aᵢ,   c = Σ Aᵢ cᵢ / A,   I = Σ Iᵢ + Aᵢ |cᵢ − c|²
    /// ```
    #[must_use]
    pub fn combined(parts: impl Iterator<Item = Self>) -> Option<Self> {
        let parts: Vec<Self> = parts.collect();
        let first = *parts.first()?;
        if parts.len() == 1 {
            return Some(first); // the sums below would round
        }
        let area = parts.iter().map(|p| p.area).sum::<f64>();
        let centroid = parts.iter().map(|p| p.centroid * p.area).sum::<Vector2<f64>>() / area;
        let about = |p: &Self| p.second_moment + p.area * (p.centroid - centroid).norm_squared();
        Some(Self { area, centroid, second_moment: parts.iter().map(about).sum() })
    }
}

/// A = π r², I = A r²/2.
pub(crate) fn circle(radius: f64, centroid: Vector2<f64>) -> MassProperties {
    let area = PI * radius * radius;
    MassProperties { area, centroid, second_moment: area * radius * radius / 2.0 }
}

/// A = w h, I = A (w² + h²)/12.
pub(crate) fn rectangle(width: f64, height: f64, centroid: Vector2<f64>) -> MassProperties {
    let area = width * height;
    let second_moment = area * (width * width + height * height) / 12.0;
    MassProperties { area, centroid, second_moment }
}

/// A rectangle L × 2r and two half discs.
///
/// A half disc has moment π r⁴/4 about the centre of its flat side, and its own centroid 4r/(3π)
/// beyond it; moved out by L/2 both together contribute π r⁴/2 + π r² L²/4 + (4/3) r³ L.
pub(crate) fn capsule(a: Vector2<f64>, b: Vector2<f64>, radius: f64) -> MassProperties {
    let (l, r) = ((b - a).norm(), radius);
    let middle = rectangle(l, 2.0 * r, (a + b) / 2.0);
    let disc = PI * r * r;
    let caps = disc * (r * r / 2.0 + l * l / 4.0) + 4.0 / 3.0 * r.powi(3) * l;
    MassProperties {
        area: middle.area + disc,
        centroid: middle.centroid,
        second_moment: middle.second_moment + caps,
    }
}

/// Sum over the fan of triangles from the first vertex o, so that nothing cancels far from the origin.
///
/// A triangle with edges e, f from o has A = e×f/2, centroid o + (e + f)/3, and moment
/// A (e·e + e·f + f·f)/6 about o.
pub(crate) fn polygon(vertices: &[Vector2<f64>]) -> MassProperties {
    let o = vertices[0];
    let (mut area, mut first, mut second) = (0.0, Vector2::zeros(), 0.0);
    for w in vertices.windows(2) {
        let (e, f) = (w[0] - o, w[1] - o);
        let part = cross(&o, &w[0], &w[1]) / 2.0;
        area += part;
        first += part / 3.0 * (e + f);
        second += part / 6.0 * (e.dot(&e) + e.dot(&f) + f.dot(&f));
    }
    let centroid: Vector2<f64> = first / area;
    MassProperties {
        area,
        centroid: o + centroid,
        second_moment: second - area * centroid.norm_squared(),
    }
}
