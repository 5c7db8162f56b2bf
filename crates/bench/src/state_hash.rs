//! One number for a whole run.

use tangency_core::State;

/// FNV-1a (Fowler, Noll & Vo 1991) over the bits of all numbers of all states: time, poses,
/// velocities, in order. Two runs have the same hash if they agree to the last bit, and hardly ever
/// otherwise; zeros of either sign are told apart.
#[must_use]
pub fn state_hash<'a>(states: impl IntoIterator<Item = &'a State>) -> u64 {
    let numbers = states.into_iter().flat_map(|state| {
        let vectors = state.q.iter().chain(&state.v).flat_map(|x| x.iter());
        std::iter::once(&state.time).chain(vectors)
    });
    let bytes = numbers.flat_map(|x| x.to_bits().to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}
