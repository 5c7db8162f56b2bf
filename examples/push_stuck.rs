//! Which constant push moves a box by 1 m in 2 s, beginning with one that does not move it at all?
//! Up to 4.9 N friction holds the box, and the exact gradient is zero; a smoothed one feels that it is about
//! to slip. Prints the push, where the box comes to and both gradients, round by round.

#![expect(clippy::print_stdout, reason = "an example prints what it found")]

use tangency::{
    BodyDef, BodyKind, ControlDef, ControlInput, GradientMode, Rollout, Scene, SceneDef, Shape,
    StateVector, default_solver, gradient, rollout,
};

const STEPS: usize = 100;
const GOAL: f64 = 1.0;
const RATE: f64 = 0.2;

fn slope(scene: &Scene, run: &Rollout) -> Result<f64, tangency::diff::DiffError> {
    let found = gradient(scene, run, |k, state| {
        let mut seed = StateVector::like(state);
        seed.q[1].x = 2.0 * (state.q[1].x - GOAL);
        (k == STEPS).then_some(seed)
    })?;
    Ok(found.by.controls.iter().map(|by| by[0]).sum())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let body = |name: &str, kind, height, shape| BodyDef {
        name: name.into(),
        kind,
        mass: (kind == BodyKind::Dynamic).then_some(1.0),
        position: [0.0, height],
        shapes: vec![shape],
        friction: 0.5,
        ..BodyDef::default()
    };
    let ground = Shape::HalfPlane { normal: [0.0, 1.0], offset: 0.0 };
    let cube = Shape::Rectangle { width: 0.4, height: 0.4, center: [0.0; 2], angle: 0.0 };
    let floor = body("floor", BodyKind::Static, 0.0, ground);
    let cube = body("box", BodyKind::Dynamic, 0.2, cube);
    let input = ControlInput::ForceX { body: "box".into() };
    let controls = vec![ControlDef { name: "push".into(), input }];
    let bodies = vec![floor, cube];
    let scene = Scene::new(&SceneDef { dt: 0.02, bodies, controls, ..SceneDef::default() })?;

    let (solver, mut push) = (default_solver(), 2.0);
    println!("round     push, N      box, m       exact    smoothed");
    for round in 0..=200 {
        let mut run = rollout(&scene, &*solver, scene.initial_state(), STEPS, |_, _| vec![push])?;
        let exact = slope(&scene, &run)?;
        GradientMode::Smoothed { kappa: 0.1 }.prepare(&mut run)?;
        let smoothed = slope(&scene, &run)?;
        if round % 10 == 0 {
            println!(
                "{round:5} {push:11.6} {:11.6} {exact:11.6} {smoothed:11.6}",
                run.last().q[1].x
            );
        }
        push -= RATE * smoothed;
    }
    Ok(())
}
