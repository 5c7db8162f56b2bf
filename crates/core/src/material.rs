//! How the friction and restitution of two bodies mix.
//!
//! ```text
//!  μ = √(μ_a μ_b)         one frictionless body is enough for a frictionless contact
//!  e = (e_a + e_b)/2      as in the paper's code
//! ```
//!
//! A pair may be given its own numbers instead, which then do not depend on the bodies'.

/// A mixed coefficient with its derivatives by the two bodies' own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mixed {
    /// The pair's coefficient.
    pub value: f64,
    /// Its derivative by the coefficients of bodies a and b.
    pub d: [f64; 2],
}

/// Friction of a pair from that of its bodies. Where either is zero so is the derivative.
#[must_use]
pub fn friction(a: f64, b: f64) -> Mixed {
    let value = (a * b).sqrt();
    if value == 0.0 {
        return Mixed::default();
    }
    Mixed { value, d: [0.5 * value / a, 0.5 * value / b] }
}

/// Restitution of a pair from that of its bodies.
#[must_use]
pub fn restitution(a: f64, b: f64) -> Mixed {
    Mixed { value: f64::midpoint(a, b), d: [0.5, 0.5] }
}
