//! Any scene that can be built moves, or says why not: random scenes of 1 to 30 bodies, overlapping,
//! jointed in loops, with friction up to 10 and masses over eight decades.

use proptest::{prelude::*, test_runner::RngSeed};
use tangency::diff::StateVector;
use tangency::{Scene, State, StepError, StepScratch, gradient, simulate, step};
use tangency_bench::{is_driven, random_scene};

use crate::engine::{backends, built};

const STEPS: usize = 12;

fn fixed(cases: u32) -> ProptestConfig {
    let rng_seed = RngSeed::Fixed(20_181_203);
    ProptestConfig { cases, rng_seed, failure_persistence: None, ..ProptestConfig::default() }
}

fn is_finite(state: &State) -> bool {
    state.q.iter().chain(&state.v).all(|x| x.iter().all(|x| x.is_finite()))
}

/// Steps until the end or a refusal, which is returned.
fn play(scene: &Scene, solver: &dyn tangency::LcpSolver) -> Result<(), StepError> {
    let (mut state, mut scratch) = (scene.initial_state(), StepScratch::default());
    for _ in 0..STEPS {
        let record = step(scene, solver, &state, &[], &mut scratch)?;
        assert!(record.residual() <= scene.tolerance(), "residual {:e}", record.residual());
        assert!(is_finite(&record.after), "a state is not finite");
        state = record.after;
    }
    Ok(())
}

proptest! {
    #![proptest_config(fixed(256))]

    /// The native solver refuses only what kinematic bodies or motors drive against itself, and
    /// then with what was violated.
    #[cfg(feature = "ipm")]
    #[test]
    fn native_solver_refuses_nothing_that_can_move(seed: u64, bodies in 1_usize..=30) {
        let solver = tangency::backend("ipm").expect("the native solver");
        if let Err(error) = play(&built(&random_scene(seed, bodies)), &*solver) {
            prop_assert!(is_driven(seed), "{error}");
            let StepError::Lcp { source, .. } = error else { panic!("{error}") };
            prop_assert!(source.residual().is_some_and(|residual| residual > 1e-10), "{source}");
        }
    }

    /// Whatever the backend, an answer is right or there is none.
    #[test]
    fn every_backend_is_right_or_refuses(seed: u64, bodies in 1_usize..=12) {
        for solver in backends() {
            if let Err(error) = play(&built(&random_scene(seed, bodies)), &*solver) {
                let typed = matches!(error, StepError::Lcp { .. } | StepError::Collision { .. });
                prop_assert!(typed, "{error}");
            }
        }
    }

    /// A run that was accepted has a finite gradient.
    #[test]
    fn gradients_are_finite(seed: u64, bodies in 1_usize..=12) {
        for solver in backends() {
            let scene = built(&random_scene(seed, bodies));
            let Ok(tape) = simulate(&scene, &*solver, 5) else { continue };
            let seed = |k: usize, state: &State| {
                let mut seed = StateVector::like(state);
                seed.q.iter_mut().chain(&mut seed.v).for_each(|x| x.fill(1.0));
                (k == 5).then_some(seed)
            };
            let by = gradient(&scene, &tape, seed).expect("a gradient").by;
            let initial = by.initial.q.iter().chain(&by.initial.v);
            let masses = by.scene.bodies.iter().map(|body| &body.mass);
            prop_assert!(initial.chain(masses).all(|x| x.iter().all(|x| x.is_finite())));
        }
    }
}
