//! One edge of a placed core, and where points are relative to it.

use nalgebra::Vector2;

use crate::{pose::perp, world::View};

/// An edge of a core in the world.
#[derive(Clone, Copy)]
pub(crate) struct Edge<'a> {
    core: &'a View<'a>,
    /// Its number.
    pub(crate) index: usize,
}

impl<'a> Edge<'a> {
    /// Edge number `index` of a core.
    pub(crate) fn new(core: &'a View<'a>, index: usize) -> Self {
        Self { core, index }
    }

    /// Unit outward normal.
    pub(crate) fn normal(&self) -> Vector2<f64> {
        self.core.normals[self.index]
    }

    /// Numbers of the vertices at which it starts and ends.
    pub(crate) fn ends(&self) -> [usize; 2] {
        [self.index, (self.index + 1) % self.core.vertices.len()]
    }

    /// Positions of its start and end, m.
    pub(crate) fn end_points(&self) -> [Vector2<f64>; 2] {
        self.ends().map(|k| self.core.vertices[k])
    }

    /// Distance of a point from its line, positive outside, m.
    pub(crate) fn height(&self, x: &Vector2<f64>) -> f64 {
        self.normal().dot(&(x - self.core.vertices[self.index]))
    }

    /// Distance of a point's foot on its line from its start, m.
    pub(crate) fn along(&self, x: &Vector2<f64>) -> f64 {
        perp(&self.normal()).dot(&(x - self.core.vertices[self.index]))
    }

    /// Length, m.
    pub(crate) fn length(&self) -> f64 {
        let [start, end] = self.end_points();
        (end - start).norm()
    }

    /// Whether a point's foot is on the edge made longer by `margin` (m) at either end.
    pub(crate) fn is_under(&self, x: &Vector2<f64>, margin: f64) -> bool {
        let u = self.along(x);
        -margin < u && u < self.length() + margin
    }

    /// Range of another edge along this one, m.
    pub(crate) fn shadow_of(&self, other: &Self) -> [f64; 2] {
        let [u, w] = other.end_points().map(|x| self.along(&x));
        [u.min(w), u.max(w)]
    }

    /// The core's edge at vertex `k` whose normal is most opposite to `n`; none for a circle.
    ///
    /// Normals within `rounding` of each other tie, and the lower number wins.
    pub(crate) fn facing(
        core: &'a View<'a>,
        k: usize,
        n: &Vector2<f64>,
        rounding: f64,
    ) -> Option<Self> {
        let count = core.normals.len();
        let last = (k + count.checked_sub(1)?) % count;
        let (low, high) = (Self::new(core, k.min(last)), Self::new(core, k.max(last)));
        let turned = high.normal().dot(n) < low.normal().dot(n) - rounding;
        Some(if turned { high } else { low })
    }
}
