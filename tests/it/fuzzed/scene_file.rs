//! What must hold of any bytes that are offered as a scene file.

use tangency::diff::StateVector;
use tangency::{
    Rollout, Scene, SceneDef, SceneFormat, State, StepScratch, default_solver, gradient, inspect,
    parse_scene, scene_to_json, step,
};

const STEPS: usize = 20;
/// Larger scenes are not run: they would say the same, slowly.
const MOST_BODIES: usize = 30;
const MOST_POINTS: usize = 300;

/// The bytes are refused by a typed error, or make a scene whose states and derivatives are finite
/// as long as its steps are not refused. Says whether a scene came of them.
pub(crate) fn check(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    let formats = [SceneFormat::Toml, SceneFormat::Json];
    let defs = formats.into_iter().filter_map(|format| parse_scene(text, format).ok());
    let mut built = false;
    for def in defs.filter(is_small) {
        if let Ok(scene) = Scene::new(&def) {
            check_scene(&def, &scene);
            built = true;
        }
    }
    built
}

fn is_small(def: &SceneDef) -> bool {
    let shapes = def.bodies.iter().flat_map(|body| &body.shapes);
    let points = shapes.map(|shape| match shape {
        tangency::Shape::Polygon { points } => points.len(),
        _ => 1,
    });
    def.bodies.len() <= MOST_BODIES && points.sum::<usize>() <= MOST_POINTS
}

fn check_scene(def: &SceneDef, scene: &Scene) {
    let again = parse_scene(&scene_to_json(def), SceneFormat::Json);
    assert_eq!(again.ok().as_ref(), Some(def), "a valid scene survives being written and read");
    let rollout = run(scene);
    rollout.states().for_each(|state| assert!(is_finite(state), "not finite: {state:?}"));
    let last = rollout.last();
    let ones = |_: &_| nalgebra::Vector3::repeat(1.0);
    let (q, v) = (last.q.iter().map(ones).collect(), last.v.iter().map(ones).collect());
    let seed = StateVector { time: 1.0, q, v };
    let steps = rollout.records.len();
    if let Ok(found) = gradient(scene, &rollout, |k, _| (k == steps).then(|| seed.clone())) {
        let numbers = found.by.initial.q.iter().chain(&found.by.initial.v).flatten();
        let controls = found.by.controls.iter().flatten();
        assert!(numbers.chain(controls).all(|x| x.is_finite()), "a gradient is not finite");
    }
}

/// Steps until one is refused.
fn run(scene: &Scene) -> Rollout {
    let (solver, mut scratch) = (default_solver(), StepScratch::default());
    let mut rollout = Rollout { initial: scene.initial_state(), records: Vec::new() };
    let control = vec![0.0; scene.controls().len()];
    for k in 0..STEPS {
        let state = rollout.state(k);
        let inspected = inspect(scene, state);
        match step(scene, &*solver, state, &control, &mut scratch) {
            Ok(record) => {
                assert!(inspected.is_ok(), "what can be stepped can be inspected");
                rollout.records.push(record);
            }
            Err(refusal) => {
                assert!(!refusal.to_string().is_empty());
                break;
            }
        }
    }
    rollout
}

fn is_finite(state: &State) -> bool {
    state.time.is_finite() && state.q.iter().chain(&state.v).flatten().all(|x| x.is_finite())
}
