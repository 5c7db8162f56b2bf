//! Where does a ball land, and how does that depend on how it was thrown?
//!
//! Prints where it is after a flight, a bounce off a wall and bounces on the floor, and the
//! derivative of that by launch velocity, gravity, friction and restitution, beside central
//! differences of the same.

#![expect(clippy::print_stdout, reason = "an example prints what it found")]

use tangency::diff::{Parameter, StateVector, gradient};
use tangency::{BodyDef, BodyKind, Scene, SceneDef, Shape, default_solver, simulate};
use tangency_bench::finite_difference::derivative;

const STEPS: usize = 150;
const PARAMETERS: [&str; 5] =
    ["velocity.x:ball", "velocity.y:ball", "gravity.y", "friction:ball", "restitution:ball"];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let plane = |name: &str, normal: [f64; 2], offset: f64| BodyDef {
        name: name.into(),
        kind: BodyKind::Static,
        shapes: vec![Shape::HalfPlane { normal, offset }],
        ..BodyDef::default()
    };
    let ball = BodyDef {
        name: "ball".into(),
        position: [0.0, 1.0],
        velocity: [3.0, 1.0],
        shapes: vec![Shape::Circle { radius: 0.1, center: [0.0, 0.0] }],
        friction: 0.2,
        restitution: 0.4,
        ..BodyDef::default()
    };
    let (floor, wall) = (plane("floor", [0.0, 1.0], 0.0), plane("wall", [-1.0, 0.0], -1.5));
    let scene = Scene::new(&SceneDef { bodies: vec![floor, wall, ball], ..SceneDef::default() })?;
    let solver = default_solver();
    let run = simulate(&scene, solver.as_ref(), STEPS)?;
    let found = gradient(&scene, &run, |k, state| {
        (k == STEPS).then(|| {
            let mut seed = StateVector::like(state);
            seed.q[2].x = 1.0;
            seed
        })
    })?;

    println!("the ball is at x = {:.6} m after {:.2} s", run.last().q[2].x, run.last().time);
    println!("{:18} {:>15} {:>15}", "by", "exact", "difference");
    for name in PARAMETERS {
        let parameter = Parameter::parse(&scene, name)?;
        let place = |value: f64| {
            let mut scene = scene.clone();
            parameter.set(&mut scene, value).expect("values near the scene's own are valid");
            let run = simulate(&scene, solver.as_ref(), STEPS);
            run.map_or(f64::NAN, |run| run.last().q[2].x)
        };
        let difference = derivative(place, parameter.value(&scene), 1e-5).value;
        println!("{name:18} {:15.9} {difference:15.9}", parameter.gradient(&scene, &found.by));
    }
    Ok(())
}
