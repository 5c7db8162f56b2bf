//! Every island of every step of the shipped scenes and of the validation cases.

use tangency::lcp::Lcp;
use tangency::{Scene, SceneDef, simulate};
use tangency_bench::scenes;

use super::compare::{Verdict, compare};
use crate::backends::shipped;
use crate::engine::{backends, built};

/// Steps per scene.
const STEPS: usize = 150;

/// The problems that a run solves.
fn problems(scene: &Scene) -> Vec<Lcp> {
    let solvers = backends();
    let tape = simulate(scene, &*solvers[0], STEPS)
        .unwrap_or_else(|error| panic!("{}: {error}", scene.def().name));
    let mut all = Vec::new();
    for record in tape.records {
        let post = record.post.into_iter().flat_map(|post| post.islands);
        all.extend(record.islands.into_iter().chain(post).map(|island| island.problem));
    }
    all.retain(|problem| !problem.is_linear());
    all
}

/// Compares on all problems of a scene; what is wrong, and how often solutions were several.
fn check(name: &str, scene: &Scene, wrong: &mut Vec<String>) -> usize {
    let solvers = backends();
    let mut multiple = 0;
    for (k, problem) in problems(scene).iter().enumerate() {
        match compare(problem, &solvers) {
            Ok(Verdict { solved, multiple: several, .. }) => {
                multiple += several;
                if solved < solvers.len() {
                    wrong.push(format!("{name}, problem {k}: {solved} backends solved it"));
                }
            }
            Err(found) => wrong.extend(found.iter().map(|w| format!("{name}, problem {k}: {w}"))),
        }
    }
    multiple
}

#[test]
fn shipped_scenes() {
    let mut wrong = Vec::new();
    for (file, scene) in shipped() {
        let name = file.file_stem().expect("a name").to_string_lossy().into_owned();
        let multiple = check(&name, &scene, &mut wrong);
        println!("{name}: {multiple} answers differ where Coulomb's law has several");
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The scenes of the validation cases.
fn cases() -> Vec<SceneDef> {
    vec![
        scenes::incline_block(0.5, 0.3, 0.7),
        scenes::incline_block(0.3, 0.6, 0.0),
        scenes::incline_disc(0.2),
        scenes::incline_disc(0.9),
        scenes::sliding_disc(),
        scenes::sliding_box(1.0, 0.3, 1.0),
        scenes::falling_disc(0.2, 0.8),
        scenes::line_collision(),
        scenes::oblique_collision(0.3, [0.5, 0.2]),
        scenes::spinning_disc(0.3),
        scenes::rod_hit(),
        scenes::head_on(0.2),
        scenes::tipping_box(3.0, 0.8),
        scenes::stack(&[1.0, 1e3, 1.0, 1e-3]),
        scenes::redundant_floor(4),
        scenes::cradle(5, 0.0, 1.0, 1.0),
        scenes::doubled_hinge(2.0, 3),
        scenes::hanging_chain_hit(),
        scenes::paper_chain(5, 1.0),
        scenes::motor_arm(),
        scenes::spring_cart(),
        scenes::soft_bridge(6),
        scenes::conveyor(),
        scenes::piston(),
        scenes::compound_tumble(),
    ]
}

#[test]
fn validation_cases() {
    let mut wrong = Vec::new();
    for mut def in cases() {
        def.controls.clear();
        check(&def.name, &built(&def), &mut wrong);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
