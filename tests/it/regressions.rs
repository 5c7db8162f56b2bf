//! Scenes that once were refused or exploded, by what was wrong.

use tangency::lcp::LcpSolver;
use tangency::{Scene, StepScratch, step};
use tangency_bench::random_scene;

use crate::backends::shipped;
use crate::engine::built;

/// Takes the steps; no body may become faster than `fastest`, m/s.
#[track_caller]
fn check(scene: &Scene, solver: &dyn LcpSolver, steps: usize, fastest: f64) {
    let (mut state, mut scratch) = (scene.initial_state(), StepScratch::default());
    for k in 0..steps {
        let record = step(scene, solver, &state, &[], &mut scratch)
            .unwrap_or_else(|error| panic!("{}, step {k}: {error}", scene.def().name));
        state = record.after;
        let speed = state.v.iter().map(|v| v.xy().norm()).fold(0.0, f64::max);
        assert!(speed <= fastest, "{}, step {k}: {speed} m/s", scene.def().name);
    }
}

#[cfg(feature = "ipm")]
#[test]
fn random_scenes() {
    let solver = tangency::backend("ipm").expect("the native solver");
    for (seed, bodies, steps, what) in [
        (2, 29, 40, "limits of a joint held at a distance in the velocity model"),
        (104, 17, 40, "joints that depend on each other up to their drift"),
        (131, 20, 10, "displacements that tore joints apart"),
        (168, 13, 40, "joints against contacts"),
        (259, 12, 20, "corrections of joints that nearly contradict each other"),
        (261, 10, 40, "momentum of a light body between heavy ones"),
        (428, 23, 10, "nearly dependent rows under mass ratios"),
        (467, 14, 40, "a loose stage that was not solved"),
        (592, 9, 40, "displacements that nearly contradict each other"),
        (643, 18, 40, "momenta too small for normal numbers"),
        (648, 13, 40, "a light body pinned and pressed by a heavy one"),
        (1264, 27, 40, "contacts that hold each other"),
        (11451, 10, 12, "redundant joints in the displacement"),
        (12883, 18, 12, "bounces that nearly contradict each other"),
        (14529, 22, 12, "redundant joints in the displacement, too"),
        (38762, 29, 20, "two points that the move made coincide"),
    ] {
        let scene = built(&random_scene(seed, bodies));
        assert!(!what.is_empty());
        check(&scene, &*solver, steps, 1e3);
    }
}

/// A ball many times heavier than the boxes hits a pile of 55 of them.
#[cfg(feature = "ipm")]
#[test]
fn pile_hit_by_a_heavy_ball() {
    let solver = tangency::backend("ipm").expect("the native solver");
    let pyramid = shipped().into_iter().find(|(_, scene)| scene.def().name == "Pyramid");
    let mut def = pyramid.expect("it ships").1.def().clone();
    for (mass, steps) in [(100.0, 47), (1000.0, 49)] {
        let ball = def.bodies.iter_mut().find(|body| body.name.contains("ball")).expect("a ball");
        (ball.mass, ball.density) = (Some(mass), None);
        check(&built(&def), &*solver, steps, 1e3);
    }
}
