//! The native solver: active-set polish of a guess, then a primal-dual interior point that is
//! polished as soon as it shows the modes.
//!
//! Knows [`Lcp`](tangency_lcp::Lcp) and nothing physical. Read `solve` (the order of the stages),
//! `box_form` (the problem as the interior point sees it), `newton`, `mehrotra`.

mod solve;
mod box_form;
mod newton;
mod mehrotra;
mod lemke;
mod pivoting;
mod feasibility;
mod raw;
mod raw_active;

pub use solve::InteriorPoint;
pub use raw::{RawLcp, RawSolution, solve_raw};
