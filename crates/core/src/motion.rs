//! How bodies move in a part of a step.

use serde::{Deserialize, Serialize};

/// How bodies move in a part of a step, from (q, v⁻) to (q⁺, v⁺) in the time h:
///
/// ```text
///  Fixed     rows at q            q⁺ = q + h v⁺
///  Flow      rows at q + ½ h v⁻   q⁺ = q + ½ h (v⁻ + v⁺)
///  Impact    rows at q            q⁺ = q,  h = 0
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Motion {
    /// Semi-implicit Euler over everything in reach.
    #[default]
    Fixed,
    /// Motion between impacts: what touches has rows, nothing else.
    Flow,
    /// A jump of the velocities.
    Impact,
}

impl Motion {
    /// Whether forces that are finite have time to act.
    #[must_use]
    pub fn lasts(self, dt: f64) -> bool {
        self == Self::Fixed || dt > 0.0
    }
}
