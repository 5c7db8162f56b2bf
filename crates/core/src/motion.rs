//! How bodies move in a part of a step.

use serde::{Deserialize, Serialize};

/// How bodies move in a part of a step, from (q, v⁻) to (q⁺, v⁺) in the time h:
///
/// ```text
///  Fixed     rows at q            q⁺ = q + h v⁺
///  Flow      rows at q + ½ h v⁻   q⁺ = q + ½ h (v⁻ + v⁺)
///  Impact    rows at q            q⁺ = q,  h = 0
///  Smooth    rows at the states of Runge and Kutta's method, for accelerations
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
    /// Motion between events, of order 4. Rows of its problems ask for accelerations.
    Smooth,
    /// Velocities brought back to what a smooth flow holds, by impulses of least size.
    Projection,
}

impl Motion {
    /// Whether contacts that pressed stay closed, and positions are mended whatever the scene says.
    #[must_use]
    pub fn flows(self) -> bool {
        matches!(self, Self::Flow | Self::Smooth)
    }

    /// Whether springs and dampers are rows; in a smooth flow they are forces.
    #[must_use]
    pub fn has_springs(self, dt: f64) -> bool {
        match self {
            Self::Fixed => true,
            Self::Flow => dt > 0.0,
            Self::Impact | Self::Smooth | Self::Projection => false,
        }
    }
}
