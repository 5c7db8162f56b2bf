//! The derivatives of a bounce: of steps of fixed length, of located impacts, of accurate steps, and of the
//! motion itself.
//!
//! A disc falls from one metre onto a floor; asked is its height after 0.75 s.

#![expect(clippy::print_stdout, reason = "an example prints what it found")]

use tangency::diff::{StateVector, gradient};
use tangency::{
    BodyDef, BodyKind, PairDef, Param, Scene, SceneDef, Shape, Stepping, default_solver, simulate,
};

const G: f64 = 9.81;
const R: f64 = 0.1;
const Y: f64 = 1.0;
const E: f64 = 0.5;
const T: f64 = 0.75;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("                       y        dy/dy0       dy/dv0");
    for (name, stepping) in [
        ("fixed", Stepping::Fixed),
        ("impact-resolved", Stepping::ImpactResolved { max_impacts: 8 }),
        ("accurate", Stepping::Accurate { max_events: 32 }),
    ] {
        let scene = Scene::new(&SceneDef { stepping, ..dropped() })?;
        let run = simulate(&scene, default_solver().as_ref(), 150)?;
        let mut seed = StateVector::zeros(2);
        seed.q[1].y = 1.0;
        let found = gradient(&scene, &run, |k, _| (k == 150).then(|| seed.clone()))?;
        let by = |param| found.by.by(&scene, param);
        let (height, speed) = (by(Param::Position(1, 1)), by(Param::Velocity(1, 1)));
        println!("{name:15} {:12.9} {height:12.9} {speed:12.9}", run.last().q[1].y);
    }
    // w = √(2 g (y₀ − r)) at the time w/g, then e w: y = r + e w s − ½ g s² with s = T − w/g.
    let w = (2.0 * G * (Y - R)).sqrt();
    let s = T - w / G;
    let (by_w, by_s) = (E * s, E * w - G * s);
    let y = R + E * w * s - 0.5 * G * s * s;
    let (height, speed) = (by_w * G / w - by_s / w, -by_s / G);
    println!("{:15} {y:12.9} {height:12.9} {speed:12.9}", "closed form");
    Ok(())
}

/// The disc over the floor, in steps of 5 ms.
fn dropped() -> SceneDef {
    let floor = BodyDef {
        name: "floor".into(),
        kind: BodyKind::Static,
        shapes: vec![Shape::HalfPlane { normal: [0.0, 1.0], offset: 0.0 }],
        ..BodyDef::default()
    };
    let disc = BodyDef {
        name: "disc".into(),
        position: [0.0, Y],
        shapes: vec![Shape::Circle { radius: R, center: [0.0, 0.0] }],
        ..BodyDef::default()
    };
    let bodies = ["floor".into(), "disc".into()];
    let pair = PairDef { bodies, restitution: Some(E), friction: Some(0.0), ..PairDef::default() };
    SceneDef { dt: 0.005, bodies: vec![floor, disc], pairs: vec![pair], ..SceneDef::default() }
}
