//! The native solver through its public interface.

// How many hard problems are solved,
mod reliability;
// and mixed problems with known answers; raw ones are validation cases.
mod mixed;
