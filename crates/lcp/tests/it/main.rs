//! The problem, its residual, its reduced systems and its dense form, through the public interface.

#![expect(non_snake_case, reason = "matrices carry their names from the paper")]

// Problems that the others share,
mod problems;
// what is refused,
mod refusals;
// what judges,
mod residual;
// what solves when the modes are known or guessed,
mod active_system;
mod band;
mod body_system;
mod central;
mod polish;
// and the paper's matrices.
mod dense;
