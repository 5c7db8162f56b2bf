//! Same input, same bits.

use std::process::Command;

use tangency::{Scene, StepScratch, next_step, parse_scene, scene_to_json, step};
use tangency_bench::{scenes, state_hash};

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
fn a_run_goes_on_from_any_of_its_records() {
    for solver in backends() {
        for scene in busy() {
            let whole = run(&scene, &*solver, 40);
            let (mut record, mut scratch) = (whole.records[24].clone(), StepScratch::default());
            for expected in &whole.records[25..] {
                record = next_step(&scene, &*solver, &record, &[], &mut scratch).expect("a step");
                assert_eq!(&record, expected, "{}", scene.def().name);
            }
        }
    }
}

/// A state alone does not tell which rows were active; what it leads to is the same but for rounding.
#[test]
fn a_run_goes_on_from_any_of_its_states() {
    for solver in backends() {
        for scene in busy() {
            let whole = run(&scene, &*solver, 40);
            let middle = whole.state(25).clone();
            let zeros = |_: usize, _: &tangency::State| Vec::new();
            let rest = tangency::rollout(&scene, &*solver, middle, 15, zeros).expect("the rest");
            for (a, b) in whole.last().q.iter().zip(&rest.last().q) {
                assert!((a - b).amax() < 1e-11, "{}: {a} and {b}", scene.def().name);
            }
        }
    }
}

/// One number per backend for all that the busy scenes do.
fn hashes() -> Vec<u64> {
    let hash = |solver: Box<dyn tangency::lcp::LcpSolver>| {
        let runs: Vec<_> = busy().iter().map(|scene| run(scene, &*solver, 150)).collect();
        state_hash(runs.iter().flat_map(tangency::Rollout::states))
    };
    backends().into_iter().map(hash).collect()
}

#[test]
fn a_hash_sees_the_last_bit() {
    let scene = built_zero_control(&scenes::piston());
    let states = || vec![scene.initial_state(); 2];
    let mut changed = states();
    changed[1].v[2].y = f64::from_bits(changed[1].v[2].y.to_bits() ^ 1);
    assert_ne!(state_hash(&states()), state_hash(&changed));
    assert_ne!(state_hash(&states()), state_hash(&states()[..1]));
}

#[test]
fn runs_in_threads_side_by_side_are_equal() {
    let alone = hashes();
    for threads in [1, 2, 4] {
        let together: Vec<Vec<u64>> = std::thread::scope(|scope| {
            let running: Vec<_> = (0..threads).map(|_| scope.spawn(hashes)).collect();
            running.into_iter().map(|thread| thread.join().expect("a run")).collect()
        });
        assert!(together.iter().all(|hashes| *hashes == alone), "{threads} threads: {together:?}");
    }
}

const MARK: &str = "hashes of this process: ";

/// What [`a_fresh_process_moves_the_same`] reads.
#[test]
#[expect(clippy::print_stdout, reason = "captured unless another process asks for it")]
fn hashes_of_this_process() {
    let hashes = hashes();
    assert_eq!(hashes.len(), tangency::solvers().len());
    println!("{MARK}{hashes:?}");
}

#[test]
fn a_fresh_process_moves_the_same() {
    let this = std::env::current_exe().expect("the path of the tests");
    let asked = ["--exact", "determinism::hashes_of_this_process", "--nocapture"];
    let output = Command::new(this).args(asked).output().expect("the tests start again");
    let text = String::from_utf8(output.stdout).expect("text");
    let found = text.lines().find_map(|line| line.split_once(MARK));
    assert_eq!(found.map(|(_, hashes)| hashes), Some(format!("{:?}", hashes()).as_str()));
}

/// Forty leaning stacks, each an island: with everything that is shared out over threads.
#[cfg(feature = "parallel")]
#[test]
fn islands_side_by_side_are_solved_to_the_same_bits() {
    let mut def = scenes::copies(&scenes::stack(&[1.0, 2.0, 0.5, 1.0]), 40, 50.0);
    for (k, body) in def.bodies[1..].iter_mut().enumerate() {
        body.velocity[0] = 0.02 * (k / 4) as f64;
    }
    for solver in backends() {
        let scene = built(&def);
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("threads").install(|| run(&scene, &*solver, 25))
        };
        let alone = on(1);
        assert_eq!(alone.records[0].islands.len(), 40);
        for threads in [2, 3, 4] {
            assert_eq!(on(threads), alone, "{threads} threads, {}", solver.name());
        }
    }
}
