//! From features and poses to point, normal and gap.
//!
//! ```text
//!      ________
//!     |   b    |
//!     |___.____|        x_b   point of b
//!         ↑ n           n     unit normal, from a to b
//!         × point       gap   positive when apart
//!   ──────┴──────
//!         a
//! ```

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use crate::{ContactFeature, Feature, Pose, pose::Frame};

/// A contact at given poses.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// What touches.
    pub feature: ContactFeature,
    /// Midway between the two surfaces, m.
    pub point: Vector2<f64>,
    /// Unit normal from body a to body b.
    pub normal: Vector2<f64>,
    /// Distance of the two surfaces along the normal, m; negative where they overlap.
    pub gap: f64,
}

impl ContactFeature {
    /// Point, normal and gap of these features at the poses of bodies a and b.
    ///
    /// With x = p + R(θ) l for every local point l, and r the radii:
    ///
    /// ```text
    /// Points   r = x_b − x_a,  d = |r|     n = r/d       gap = d − r_a − r_b
    /// LineA    x_l on a's line             n = R_a n̂     gap = n·(x_b − x_l) − r_a − r_b
    /// LineB    x_l on b's line             n = −R_b n̂    gap = n·(x_l − x_a) − r_a − r_b
    ///
    /// point = x_a + n (r_a + gap/2)  (Points, LineB),   x_b − n (r_b + gap/2)  (LineA)
    /// ```
    ///
    /// The normal of coincident `Points` is not a number; [`contacts`](crate::contacts) refuses them.
    #[must_use]
    pub fn evaluate(&self, a: &Pose, b: &Pose) -> Contact {
        self.evaluate_in(&Frame::new(a), &Frame::new(b))
    }

    /// `evaluate`, where sines and cosines are at hand.
    #[must_use]
    pub fn evaluate_in(&self, a: &Frame, b: &Frame) -> Contact {
        match &self.feature {
            Feature::Points { a: l_a, b: l_b } => {
                self.placed(a.point(l_a), b.point(l_b), Vector2::zeros())
            }
            Feature::LineA { point, normal, b: l_b } => {
                self.placed(a.point(point), b.point(l_b), a.direction(normal))
            }
            Feature::LineB { a: l_a, point, normal } => {
                self.placed(a.point(l_a), b.point(point), b.direction(normal))
            }
        }
    }

    /// `evaluate`, where the points of a and b and the outward normal of the line, if there is one,
    /// are at hand in the world.
    #[inline]
    pub(crate) fn placed(
        &self,
        x_a: Vector2<f64>,
        x_b: Vector2<f64>,
        line: Vector2<f64>,
    ) -> Contact {
        let [r_a, r_b] = self.radii;
        let r = x_b - x_a;
        let (n, d) = match &self.feature {
            Feature::Points { .. } => (r / r.norm(), r.norm()),
            Feature::LineA { .. } => (line, line.dot(&r)),
            Feature::LineB { .. } => (-line, (-line).dot(&r)),
        };
        let gap = d - r_a - r_b;
        let point = match &self.feature {
            Feature::LineA { .. } => x_b - n * (r_b + gap / 2.0),
            Feature::Points { .. } | Feature::LineB { .. } => x_a + n * (r_a + gap / 2.0),
        };
        Contact { feature: *self, point, normal: n, gap }
    }
}
