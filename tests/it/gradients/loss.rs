//! A loss that sees every coordinate of every state, with coefficients that look random.

use nalgebra::Vector3;
use tangency::diff::StateVector;
use tangency::{Rollout, State};

/// The coefficients of state k.
pub(crate) fn coefficients(k: usize, state: &State) -> StateVector {
    let mut seed = StateVector::like(state);
    let wave = |i: usize, phase: f64| (3.1 * i as f64 + 0.37 * k as f64 + phase).sin();
    let vector = |i: usize, phase: f64| {
        Vector3::new(wave(i, phase), wave(i, phase + 1.3), wave(i, phase + 2.9))
    };
    seed.time = wave(7, 0.0);
    for i in 0..state.q.len() {
        (seed.q[i], seed.v[i]) = (vector(i, 0.0), vector(i, 0.7) * 0.1);
    }
    seed
}

/// Σ coefficients · states.
pub(crate) fn loss(tape: &Rollout) -> f64 {
    let at = |(k, state): (usize, &State)| {
        let as_vector = StateVector { time: state.time, q: state.q.clone(), v: state.v.clone() };
        coefficients(k, state).dot(&as_vector)
    };
    tape.states().enumerate().map(at).sum()
}
