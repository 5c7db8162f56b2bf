//! The mixed complementarity problem of one time step (or of one island of it), kept as blocks.
//!
//! ```text
//!  M v − Σ Jᵢᵀ λᵢ = p                       momentum; p = M v⁻ + dt f
//!  uᵢ = Jᵢ v + cᵢ λᵢ − bᵢ                    what row i leaves over
//!
//!  equality      uᵢ = 0
//!  unilateral    0 ≤ λᵢ ⟂ uᵢ ≥ 0
//!  bounded       |λᵢ| ≤ hᵢ;  uᵢ > 0 ⇒ λᵢ = −hᵢ;  uᵢ < 0 ⇒ λᵢ = +hᵢ
//!  friction      the same with hᵢ = μ λₙ, n the contact's normal row
//! ```
//!
//! One signed tangential impulse per contact (Pfeiffer & Glocker 1996) in place of the paper's two
//! non-negative ones: sticking is then strictly complementary.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Stands for "no unknown" in [`Row::bodies`]: the world, a static or a kinematic body.
pub const NO_BODY: u32 = u32::MAX;

/// What a row's impulse and remainder must satisfy.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Law {
    /// u = 0: joints, ideal motors, springs (with compliance).
    Equality,
    /// 0 ≤ λ ⟂ u ≥ 0: contact normals, joint limits.
    Unilateral,
    /// |λ| ≤ max: motors with a greatest impulse, N·s (or N·m·s).
    Bounded {
        /// Greatest impulse, N·s or N·m·s; positive.
        max: f64,
    },
    /// |λ| ≤ μ λₙ: Coulomb friction.
    Friction {
        /// Index of the contact's normal row; smaller than the friction row's own.
        normal: u32,
        /// Friction coefficient; positive.
        mu: f64,
    },
}

/// One scalar row over at most two bodies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Bodies a and b as indices into [`Lcp::mass`], or [`NO_BODY`].
    pub bodies: [u32; 2],
    /// Jacobian blocks, 1 × 3 each; a block without a body is zero.
    pub jacobian: [Vector3<f64>; 2],
    /// Right-hand side b, m/s or rad/s.
    pub rhs: f64,
    /// Compliance c ≥ 0, velocity per impulse; 0 for rigid rows.
    pub compliance: f64,
    /// The law that λ and u obey.
    pub law: Law,
}

/// The problem: diagonal mass, momentum and rows.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Lcp {
    /// Diagonal of the mass matrix per body, (kg, kg, kg·m²); positive.
    pub mass: Vec<Vector3<f64>>,
    /// Momentum without the rows' impulses p = M v⁻ + dt f per body, (N·s, N·s, N·m·s).
    pub momentum: Vec<Vector3<f64>>,
    /// The rows; a friction row comes after its normal row.
    pub rows: Vec<Row>,
}
