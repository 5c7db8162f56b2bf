//! The native solver: active-set polish of a guess, then a primal-dual interior point that is
//! polished as soon as it shows the modes.
//!
//! Knows [`Lcp`](tangency_lcp::Lcp) and nothing physical. Read `solve` (the order of the stages),
//! `box_form` (the problem as the interior point sees it), `newton`, `mehrotra`.

mod box_form;
mod feasibility;
mod lemke;
mod mehrotra;
mod newton;
mod pivoting;
mod raw;
mod raw_active;
mod solve;

pub use raw::{RawLcp, RawSolution, solve_raw};
pub use solve::InteriorPoint;
