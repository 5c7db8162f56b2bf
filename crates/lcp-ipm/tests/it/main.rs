//! The native solver through its public interface.

#![expect(non_snake_case, reason = "matrices carry their names from the paper")]

mod problems;
mod raw;
mod reliability;
