//! The native solver: active-set polish of a guess, then a primal-dual interior point that is
//! polished as soon as it shows the modes.
//!
//! Knows [`Lcp`](tangency_lcp::Lcp) and nothing physical. Read `solve` (the settings), `stages`
//! (their order), `mehrotra` (the loop), `polishing` (what becomes of its iterates), `iterate`, `newton` (its equations), `system` (their matrix, by bodies or by
//! rows), `last_resorts`; `raw` for problems without physics.

mod solve;
mod stages;

mod mehrotra;
mod polishing;

mod iterate;
mod newton;
mod system;

mod feasibility;
mod last_resorts;
mod raw;

pub use raw::solve_raw;
pub use solve::InteriorPoint;
pub use tangency_lcp::{RawLcp, RawSolution};
