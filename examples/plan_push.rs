//! Which push brings a box to rest at x = 1 after two seconds?
//!
//! The force of every step is a control. Gradient descent through friction finds the whole push:
//! prints what is left to do per round, then the force every 0.2 s.

#![expect(clippy::print_stdout, reason = "an example prints what it found")]

use tangency::diff::{StateVector, gradient};
use tangency::{
    BodyDef, BodyKind, ControlDef, ControlInput, Scene, SceneDef, Shape, default_solver, rollout,
};

const STEPS: usize = 100;
const RATE: f64 = 6.0;
/// What a force costs beside missing the goal, per N².
const EFFORT: f64 = 1e-5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let body = |name: &str, kind, height, shape| BodyDef {
        name: name.into(),
        kind,
        position: [0.0, height],
        shapes: vec![shape],
        friction: 0.1,
        ..BodyDef::default()
    };
    let cube = Shape::Rectangle { width: 1.0, height: 1.0, center: [0.0; 2], angle: 0.0 };
    let ground = Shape::HalfPlane { normal: [0.0, 1.0], offset: 0.0 };
    let floor = body("floor", BodyKind::Static, 0.0, ground);
    let cube = body("box", BodyKind::Dynamic, 0.5, cube);
    let input = ControlInput::ForceX { body: "box".into() };
    let scene = Scene::new(&SceneDef {
        dt: 0.02,
        bodies: vec![floor, cube],
        controls: vec![ControlDef { name: "push".into(), input }],
        ..SceneDef::default()
    })?;

    let solver = default_solver();
    let mut forces = vec![2.0; STEPS];
    for round in 0..=200 {
        let control = |k: usize, _: &_| vec![forces[k]];
        let run = rollout(&scene, solver.as_ref(), scene.initial_state(), STEPS, control)?;
        let (off, speed) = (run.last().q[1].x - 1.0, run.last().v[1].x);
        if round % 20 == 0 {
            println!("round {round:3}: {off:9.5} m off, {speed:9.5} m/s");
        }
        let found = gradient(&scene, &run, |k, state| {
            (k == STEPS).then(|| {
                let mut seed = StateVector::like(state);
                (seed.q[1].x, seed.v[1].x) = (2.0 * off, 2.0 * speed);
                seed
            })
        })?;
        for (force, slope) in forces.iter_mut().zip(&found.by.controls) {
            *force -= RATE * (slope[0] + 2.0 * EFFORT * *force);
        }
    }
    for (k, force) in forces.iter().enumerate().step_by(10) {
        println!("{:4.1} s {force:8.3} N", 0.02 * k as f64);
    }
    Ok(())
}
