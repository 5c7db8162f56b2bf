//! What does a box weigh? A ball of known mass hits it, and gradient descent through the contact
//! finds the box's mass from where both were seen afterwards.
//!
//! Prints mass, loss and gradient per update; the true mass is 2.5.

#![expect(clippy::print_stdout, reason = "an example prints what it found")]

use tangency::diff::{Parameter, StateVector, gradient};
use tangency::{BodyDef, Scene, SceneDef, Shape, State, default_solver, simulate};

const STEPS: usize = 150;
const RATE: f64 = 1.2;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let ball = BodyDef {
        name: "ball".into(),
        velocity: [2.0, 0.0],
        mass: Some(1.0),
        shapes: vec![Shape::Circle { radius: 0.1, center: [0.0, 0.0] }],
        restitution: 0.5,
        ..BodyDef::default()
    };
    let cube = BodyDef {
        name: "box".into(),
        position: [1.0, 0.05],
        mass: Some(2.5),
        shapes: vec![Shape::Rectangle { width: 0.4, height: 0.4, center: [0.0; 2], angle: 0.0 }],
        restitution: 0.5,
        ..BodyDef::default()
    };
    let def = SceneDef { gravity: [0.0, 0.0], bodies: vec![ball, cube], ..SceneDef::default() };
    let mut scene = Scene::new(&def)?;
    let solver = default_solver();
    let seen = simulate(&scene, solver.as_ref(), STEPS)?.last().clone();

    let mass = Parameter::parse(&scene, "mass:box")?;
    let mut guess = 1.0;
    println!("update      mass        loss    gradient");
    for update in 0..=12 {
        mass.set(&mut scene, guess)?;
        let run = simulate(&scene, solver.as_ref(), STEPS)?;
        let error = |state: &State| [0, 1].map(|body| state.q[body] - seen.q[body]);
        let loss = error(run.last()).map(|e| e.norm_squared()).iter().sum::<f64>();
        let found = gradient(&scene, &run, |k, state| {
            (k == STEPS).then(|| StateVector {
                q: error(state).map(|e| 2.0 * e).into(),
                ..StateVector::like(state)
            })
        })?;
        let slope = mass.gradient(&scene, &found.by);
        println!("{update:6} {guess:9.6} {loss:11.3e} {slope:11.3e}");
        guess -= (RATE * slope).clamp(-0.4, 0.4);
    }
    Ok(())
}
