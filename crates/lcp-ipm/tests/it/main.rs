//! The native solver through its public interface.

#![expect(non_snake_case, reason = "matrices carry their names from the paper")]

// How many hard problems are solved,
mod reliability;
// mixed problems with known answers,
mod mixed;
// and raw ones.
mod raw;
