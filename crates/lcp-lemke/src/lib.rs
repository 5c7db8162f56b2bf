//! Lemke's complementary pivoting behind the solver traits: dense, exact up to rounding, and
//! independent of the other backends.
//!
//! The last resort for small hard problems, and the oracle of the tests. Knows
//! [`BoxForm`](tangency_lcp::BoxForm) and nothing physical. Read `solve` (the order of the stages),
//! `standard` (friction and motors as complementary pairs), `tableau` (the pivots).

mod solve;
mod standard;
mod tableau;

pub use solve::Lemke;
pub use standard::candidates;
