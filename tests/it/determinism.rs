//! Same input, same bits.

use tangency::{Scene, StepScratch, parse_scene, scene_to_json, step};
use tangency_bench::scenes;

use crate::engine::{backends, built, run};

/// Scenes that between them use every path of the engine.
fn busy() -> Vec<Scene> {
    [
        scenes::soft_bridge(6),
        scenes::compound_tumble(),
        scenes::stack(&[1.0, 2.0, 0.5]),
        scenes::spring_cart(),
        scenes::piston(),
        scenes::paper_chain(5, 7.0),
    ]
    .iter()
    .map(built_zero_control)
    .collect()
}

fn built_zero_control(def: &tangency::SceneDef) -> Scene {
    let mut def = def.clone();
    def.controls.clear();
    built(&def)
}

#[test]
fn repeated_runs_are_equal() {
    for solver in backends() {
        for scene in busy() {
            let (one, two) = (run(&scene, &*solver, 150), run(&scene, &*solver, 150));
            assert_eq!(one, two, "{}", scene.def().name);
        }
    }
}

#[test]
fn scratch_memory_never_changes_a_result() {
    for solver in backends() {
        let mut used = StepScratch::default();
        for scene in busy() {
            let state = scene.initial_state();
            let with_used = step(&scene, &*solver, &state, &[], &mut used).expect("a step");
            let fresh = step(&scene, &*solver, &state, &[], &mut StepScratch::default());
            assert_eq!(with_used, fresh.expect("a step"), "{}", scene.def().name);
        }
    }
}

#[test]
fn a_scene_that_went_through_a_file_moves_the_same() {
    for solver in backends() {
        for scene in busy() {
            let text = scene_to_json(scene.def());
            let again = parse_scene(&text, tangency::SceneFormat::Json).expect("its own text");
            assert_eq!(&again, scene.def());
            let again = built(&again);
            assert_eq!(run(&scene, &*solver, 50), run(&again, &*solver, 50));
        }
    }
}

#[test]
fn a_run_can_be_split_anywhere() {
    for solver in backends() {
        for scene in busy() {
            let whole = run(&scene, &*solver, 40);
            let middle = whole.state(25).clone();
            let zeros = |_: usize, _: &tangency::State| Vec::new();
            let rest = tangency::rollout(&scene, &*solver, middle, 15, zeros).expect("the rest");
            assert_eq!(whole.last(), rest.last(), "{}", scene.def().name);
        }
    }
}
