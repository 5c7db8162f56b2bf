//! What a solver returns.

use std::sync::Arc;

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::{ActiveSystem, CentralPoint};

/// On which piece of its law a row lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// u = 0 and λ free: joints, closed contacts, sticking friction, motors within their bound.
    Active,
    /// λ = 0: open contacts and limits, and the friction of an open contact.
    Open,
    /// λ at its upper bound (u ≤ 0): contact sliding against −t, motor at its limit.
    Upper,
    /// λ at its lower bound (u ≥ 0).
    Lower,
}

/// How a solution was found.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Equalities only, or nothing at all: one linear solve.
    #[default]
    Linear,
    /// The modes of the step before, corrected where need be.
    Warm,
    /// Modes read at the free velocities, and corrected.
    ActiveSet,
    /// An interior point, or a fixed point of convex programs, and the modes that it showed.
    InteriorPoint,
    /// Projected Gauss–Seidel, and a walk along the active sets from there.
    Walk,
    /// Lemke's pivoting.
    Pivoting,
    /// All modes of the rows that were in doubt.
    Enumeration,
}

/// What a solve cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SolveStats {
    /// How the solution was found.
    #[serde(default)]
    pub method: Method,
    /// Interior-point iterations (0 when an active set was verified at once).
    pub iterations: u32,
    /// Matrix factorisations, those of the polish included.
    pub factorisations: u32,
    /// Which solver of a [`Fallback`](crate::Fallback) answered, from 0; 0 otherwise.
    #[serde(default)]
    pub attempt: u32,
}

/// Velocities, impulses and remainders of an [`Lcp`](crate::Lcp).
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct LcpSolution {
    /// Velocities v⁺ per body, (m/s, m/s, rad/s).
    pub velocities: Vec<Vector3<f64>>,
    /// Impulses λ per row, N·s or N·m·s.
    pub impulses: Vec<f64>,
    /// Remainders u per row, m/s or rad/s.
    pub slacks: Vec<f64>,
    /// Mode per row.
    pub modes: Vec<Mode>,
    /// Cost.
    pub stats: SolveStats,
    /// The factored system of these modes, if it is at hand: saves the derivative a factorisation.
    /// Not serialised and not compared.
    #[serde(skip)]
    pub system: Option<Arc<ActiveSystem>>,
    /// The point nearby at which derivatives are taken instead, if they are smoothed. Not serialised
    /// and not compared.
    #[serde(skip)]
    pub central: Option<Arc<CentralPoint>>,
}

impl LcpSolution {
    /// Velocities and impulses at which derivatives are taken: the solution's own, or those of
    /// [`central`](Self::central).
    #[must_use]
    #[inline]
    pub fn linearised(&self) -> &Self {
        self.central.as_deref().map_or(self, |central| &central.solution)
    }
}

impl PartialEq for LcpSolution {
    fn eq(&self, other: &Self) -> bool {
        self.velocities == other.velocities
            && self.impulses == other.impulses
            && self.slacks == other.slacks
            && self.modes == other.modes
            && self.stats == other.stats
    }
}
