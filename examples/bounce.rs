//! A ball falls from one metre and bounces with restitution 0.8.
//!
//! Prints, for every bounce, the time at which the engine saw it, the speed at which the ball
//! leaves, and the height that it reaches next: each 0.64 times the one before.

#![expect(clippy::print_stdout, reason = "an example prints what it found")]

use tangency::{
    BodyDef, BodyKind, PairDef, Scene, SceneDef, Shape, StepScratch, default_solver, step,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let floor = BodyDef {
        name: "floor".into(),
        kind: BodyKind::Static,
        shapes: vec![Shape::HalfPlane { normal: [0.0, 1.0], offset: 0.0 }],
        ..BodyDef::default()
    };
    let ball = BodyDef {
        name: "ball".into(),
        position: [0.0, 1.1],
        shapes: vec![Shape::Circle { radius: 0.1, center: [0.0, 0.0] }],
        ..BodyDef::default()
    };
    let pair = PairDef {
        bodies: ["floor".into(), "ball".into()],
        restitution: Some(0.8),
        ..PairDef::default()
    };
    let scene = Scene::new(&SceneDef {
        dt: 1e-4,
        bodies: vec![floor, ball],
        pairs: vec![pair],
        ..SceneDef::default()
    })?;

    let (solver, mut scratch) = (default_solver(), StepScratch::default());
    let mut state = scene.initial_state();
    println!("bounce   time, s   leaves with, m/s   next height, m");
    let mut bounces = 0;
    while bounces < 6 {
        let record = step(&scene, solver.as_ref(), &state, &[], &mut scratch)?;
        if !record.contact_impulses().is_empty() {
            bounces += 1;
            let (time, speed) = (record.after.time, record.after.v[1].y);
            let height = speed.powi(2) / (2.0 * 9.81);
            println!("{bounces:6} {time:9.4} {speed:18.4} {height:16.4}");
        }
        state = record.after;
    }
    Ok(())
}
