//! The stages in which a step's problem gives way.

use serde::{Deserialize, Serialize};

/// Which problem of a step the rows belong to, and how much of it gives way.
///
/// Rows ask for what must be (bodies and limits do not pass each other, joints move as one) and for
/// what should be (contacts bounce, position errors go away). What should be can contradict itself:
/// a ball that fits its slot cannot leave both walls at once. The first stage of a list that has a
/// solution counts, and [`IslandRecord::stage`](crate::IslandRecord::stage) tells it:
///
/// ```text
///  velocities      Velocity  →  Loose  →  Plastic
///  displacement    Post  →  SoftPost
/// ```
///
/// `Plastic` and `SoftPost` always have one, unless motors or kinematic bodies drive the rows against
/// each other, or a joint is off by more than drift explains (`docs/maths.md`, section 2).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// The velocities at the end of the step.
    #[default]
    Velocity,
    /// The same without removing position errors: that is left to the displacement after the move.
    /// Joints give way as far as drift makes them contradict each other.
    Loose,
    /// The same as [`Loose`](Self::Loose), without restitution.
    Plastic,
    /// A displacement that removes position errors after the move.
    Post,
    /// The same where rows give way by [`RowContext::softness`](crate::row::RowContext::softness) times Wᵢᵢ per impulse.
    SoftPost,
}

impl Stage {
    /// Whether the unknowns are the velocities at the end of the step.
    #[must_use]
    pub fn is_velocity(self) -> bool {
        matches!(self, Self::Velocity | Self::Plastic | Self::Loose)
    }

    /// Whether something gives way.
    #[must_use]
    pub fn gives_way(self) -> bool {
        !matches!(self, Self::Velocity | Self::Post)
    }

    /// Whether position errors stay.
    #[must_use]
    pub fn drifts(self) -> bool {
        matches!(self, Self::Loose | Self::Plastic)
    }

    /// What is tried if this has no solution.
    #[must_use]
    pub fn next(self) -> Option<Self> {
        match self {
            Self::Velocity => Some(Self::Loose),
            Self::Loose => Some(Self::Plastic),
            Self::Post => Some(Self::SoftPost),
            Self::Plastic | Self::SoftPost => None,
        }
    }
}
