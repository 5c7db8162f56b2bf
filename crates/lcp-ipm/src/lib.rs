//! The native solver: active-set polish of a guess, then a primal-dual interior point that is
//! polished as soon as it shows the modes.
//!
//! Knows [`Lcp`](tangency_lcp::Lcp) and nothing physical. Read `solve` (the order of the stages; the
//! problem as it sees it is a [`BoxForm`](tangency_lcp::BoxForm)), `mehrotra`, `newton`; `raw` for
//! problems without physics.

mod feasibility;
mod iterate;
mod mehrotra;
mod newton;
mod raw;
mod solve;
mod system;

pub use raw::solve_raw;
pub use solve::InteriorPoint;
pub use tangency_lcp::{RawLcp, RawSolution};
