//! One edge of a placed core, and where points are relative to it.

use nalgebra::Vector2;

use crate::{pose::perp, world::View};

/// An edge of a core in the world.
#[derive(Clone, Copy)]
pub(crate) struct Edge {
    /// Its number.
    pub(crate) index: usize,
    /// Numbers of the vertices at which it starts and ends.
    pub(crate) ends: [usize; 2],
    /// Positions of its start and end, m.
    pub(crate) end_points: [Vector2<f64>; 2],
    /// Unit outward normal.
    pub(crate) normal: Vector2<f64>,
    /// Length, m.
    pub(crate) length: f64,
}

impl Edge {
    /// Edge number `index` of a core.
    pub(crate) fn new(core: &View<'_>, index: usize) -> Self {
        let next = if index + 1 == core.vertices.len() { 0 } else { index + 1 };
        let ends = [index, next];
        let end_points = ends.map(|k| core.vertices[k]);
        let length = (end_points[1] - end_points[0]).norm();
        Self { index, ends, end_points, normal: core.normals[index], length }
    }

    /// Distance of a point's foot on its line from its start, m.
    pub(crate) fn along(&self, x: &Vector2<f64>) -> f64 {
        perp(&self.normal).dot(&(x - self.end_points[0]))
    }

    /// Whether a point's foot is on the edge made longer by `margin` (m) at either end.
    pub(crate) fn is_under(&self, x: &Vector2<f64>, margin: f64) -> bool {
        let u = self.along(x);
        -margin < u && u < self.length + margin
    }

    /// Range of another edge along this one, m.
    pub(crate) fn shadow_of(&self, other: &Self) -> [f64; 2] {
        let [u, w] = other.end_points.map(|x| self.along(&x));
        [u.min(w), u.max(w)]
    }

    /// The core's edge at vertex `k` whose normal is most opposite to `n`; none for a circle.
    ///
    /// Normals within `rounding` of each other tie, and the lower number wins.
    pub(crate) fn facing(
        core: &View<'_>,
        k: usize,
        n: &Vector2<f64>,
        rounding: f64,
    ) -> Option<Self> {
        let before = if k == 0 { core.normals.len().checked_sub(1)? } else { k - 1 };
        let (low, high) = (k.min(before), k.max(before));
        let turned = core.normals[high].dot(n) < core.normals[low].dot(n) - rounding;
        Some(Self::new(core, if turned { high } else { low }))
    }
}
