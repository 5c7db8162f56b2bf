//! Boxes around shapes.

use nalgebra::Vector2;

/// An axis-parallel box, world, m; infinite around a half-plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    /// Lower left corner.
    pub(crate) min: Vector2<f64>,
    /// Upper right corner.
    pub(crate) max: Vector2<f64>,
}

impl Bounds {
    /// Around nothing.
    pub(crate) const EMPTY: Self = Self::all(f64::INFINITY, f64::NEG_INFINITY);
    /// Around a half-plane.
    pub(crate) const EVERYTHING: Self = Self::all(f64::NEG_INFINITY, f64::INFINITY);

    /// Around some points.
    pub(crate) fn around(points: &[Vector2<f64>]) -> Self {
        points.iter().fold(Self::EMPTY, |b, p| b.joined(Self { min: *p, max: *p }))
    }

    /// Around both.
    pub(crate) fn joined(self, other: Self) -> Self {
        let min = Vector2::new(least(self.min.x, other.min.x), least(self.min.y, other.min.y));
        let max =
            Vector2::new(greatest(self.max.x, other.max.x), greatest(self.max.y, other.max.y));
        Self { min, max }
    }

    /// Wider by a length on every side, m.
    pub(crate) fn grown(self, by: f64) -> Self {
        Self { min: self.min.add_scalar(-by), max: self.max.add_scalar(by) }
    }

    /// Whether the boxes are within `reach` of each other along both axes, m.
    pub(crate) fn near(&self, other: &Self, reach: f64) -> bool {
        self.min.x - other.max.x <= reach
            && other.min.x - self.max.x <= reach
            && self.min.y - other.max.y <= reach
            && other.min.y - self.max.y <= reach
    }

    /// The least reach at which the boxes are near each other, m; at most the distance of what is in
    /// them, negative where they overlap.
    pub(crate) fn apart(&self, other: &Self) -> f64 {
        let x = greatest(self.min.x - other.max.x, other.min.x - self.max.x);
        let y = greatest(self.min.y - other.max.y, other.min.y - self.max.y);
        greatest(x, y)
    }

    /// Whether there is something in it that ends everywhere: not a half-plane.
    pub(crate) fn is_finite(&self) -> bool {
        let Self { min, max } = self;
        min.x.is_finite() && min.y.is_finite() && max.x.is_finite() && max.y.is_finite()
    }

    const fn all(min: f64, max: f64) -> Self {
        Self { min: Vector2::new(min, min), max: Vector2::new(max, max) }
    }
}

// Of numbers that are not NaN these are one instruction each; `f64::min` and `f64::max` are four.

fn least(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

fn greatest(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}
