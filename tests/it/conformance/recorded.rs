//! Every island of every step of the shipped scenes and of the validation cases.

use tangency::lcp::Lcp;
use tangency::{Scene, SceneDef, StepScratch, step};
use tangency_bench::scenes;

use super::compare::{Verdict, compare};
use crate::backends::shipped;
use crate::engine::{backends, built};

/// Steps per scene.
const STEPS: usize = 150;

/// The problems that a run solves.
fn problems(scene: &Scene) -> Vec<Lcp> {
    let solvers = backends();
    let (mut state, mut scratch) = (scene.initial_state(), StepScratch::default());
    let control = vec![0.0; scene.controls().len()];
    let mut all = Vec::new();
    for _ in 0..STEPS {
        // Whether every backend runs every scene is the question of `backends`.
        let Ok(record) = step(scene, &*solvers[0], &state, &control, &mut scratch) else { break };
        state = record.after;
        let post = record.post.into_iter().flat_map(|post| post.islands);
        all.extend(record.islands.into_iter().chain(post).map(|island| island.problem));
    }
    all.retain(|problem| !problem.is_linear());
    all
}

/// What the backends made of many problems.
#[derive(Default)]
struct Tally {
    problems: usize,
    derivatives: usize,
    failed: Vec<(&'static str, String)>,
    multiple: Vec<String>,
    wrong: Vec<String>,
}

impl Tally {
    /// Compares on all problems of a scene.
    fn add(&mut self, name: &str, scene: &Scene) {
        let solvers = tangency::all_solvers();
        for (k, problem) in problems(scene).iter().enumerate() {
            let place = format!("{name}, problem {k}");
            self.problems += 1;
            match compare(problem, &solvers) {
                Ok(Verdict { failed, multiple, derivatives, .. }) => {
                    self.derivatives += derivatives;
                    self.failed.extend(failed.into_iter().map(|who| (who, place.clone())));
                    self.multiple.extend((multiple > 0).then_some(place));
                }
                Err(found) => self.wrong.extend(found.iter().map(|w| format!("{place}: {w}"))),
            }
        }
    }

    /// All that answered agree. The interior point answers always, Clarabel in 99 of 100 problems;
    /// Lemke's method need not: it does not try large ones.
    fn check(&self) {
        assert!(self.wrong.is_empty(), "{}", self.wrong.join("\n"));
        assert!(self.problems > 100, "{} problems", self.problems);
        if tangency::all_solvers().len() > 1 {
            assert!(2 * self.derivatives > self.problems, "{} derivatives", self.derivatives);
        }
        let failures = |name: &str| -> Vec<&String> {
            self.failed.iter().filter(|(who, _)| *who == name).map(|(_, place)| place).collect()
        };
        assert!(failures("interior point").is_empty(), "{:?}", failures("interior point"));
        let clarabel = failures("clarabel");
        assert!(100 * clarabel.len() <= self.problems, "{clarabel:?}");
    }
}

/// Only the pyramid's collapse has steps with several solutions.
#[test]
fn shipped_scenes() {
    let mut tally = Tally::default();
    for (file, scene) in shipped() {
        let name = file.file_stem().expect("a name").to_string_lossy().into_owned();
        tally.add(&name, &scene);
    }
    tally.check();
    assert!(tally.multiple.iter().all(|m| m.starts_with("pyramid")), "{:?}", tally.multiple);
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
    let mut tally = Tally::default();
    for mut def in cases() {
        def.controls.clear();
        tally.add(&def.name, &built(&def));
    }
    tally.check();
    assert!(tally.multiple.is_empty(), "{:?}", tally.multiple);
}
