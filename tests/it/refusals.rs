//! What is refused, word for word.

use tangency::{Scene, SceneDef, WORLD};
use tangency_bench::scenes::{block, disc, floor, hinge};

mod bodies;
mod conflicts;
mod derivatives;
mod inputs;
mod joints;
mod numbers;
mod problems;
mod settings;
mod shapes;
mod sizes;
mod states;

/// A good scene; each test spoils one thing.
fn good() -> SceneDef {
    let bodies = vec![floor(), block("box", [1.0, 1.0], [0.0, 0.5]), disc("ball", 0.2, [3.0, 1.0])];
    let joints = vec![hinge("pin", WORLD, "ball", [3.0, 2.0])];
    SceneDef { bodies, joints, ..SceneDef::default() }
}

#[track_caller]
fn check(spoil: impl FnOnce(&mut SceneDef), message: &str) {
    let mut def = good();
    Scene::new(&def).expect("the scene is good before it is spoilt");
    spoil(&mut def);
    let error = Scene::new(&def).expect_err("it must be refused");
    assert_eq!(error.to_string(), message);
    assert!(message.starts_with(error.path()), "path {}", error.path());
}
