//! Bodies that travel many times their size in one step.

use tangency_bench::scenes::{block, bullet, spin_up};
use tangency_core::{BodyDef, Param, SceneDef};

use crate::lab::recommended;
use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V28",
    title: "Fast things",
    parts: &[
        Part::new("bullet", bounces_off),
        Part::new("spinning box", spins),
        Part::new("spinning disc", drives_off),
    ],
}];

const BULLET: usize = 1;
const DISC: usize = 1;

/// Where the bullet is at a time after the impact: face less radius, at half the speed.
fn way_back(time: f64) -> f64 {
    4.99 - 500.0 * (time - 4.99e-3)
}

fn bounces_off(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let run = lab.run_steps(&bullet(), 1)?;
    lab.near("bullet, vx after a step of 1/60 s", run.last().v[BULLET].x, -500.0, 1e-10);
    let run = lab.run(&bullet(), 1.0)?;
    lab.near("bullet, vx after 1 s", run.last().v[BULLET].x, -500.0, 1e-10);
    lab.at_most("bullet, greatest x", run.worst(|s| s.q[BULLET].x), 4.99);

    let fine = lab.run(&recommended(bullet()), 1.0 / 60.0)?;
    let (x, back) = (fine.last().q[BULLET].x, way_back(fine.last().time));
    lab.fine("bullet, x", x, back, 1e-9);
    let seed = fine.pick(|s| s.q[BULLET].x = 1.0);
    let by_start = lab.slope(&fine, &seed, &[(Param::Position(BULLET, 0), 1.0)])?;
    lab.impact("bullet, dx/dx0", by_start, -0.5, 0.5e-6);
    Ok(())
}

fn spins(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for dt in [1.0 / 60.0, 1e-2, 1e-3] {
        let top = BodyDef { angular_velocity: 1e5, ..block("box", [0.4, 0.2], [0.0; 2]) };
        let run = lab.run(&SceneDef { dt, bodies: vec![top], ..SceneDef::default() }, 1.0)?;
        lab.relative(format!("box, angle(1) at dt={dt:.4}"), run.last().q[0].z, 1e5, 1e-12);
    }
    Ok(())
}

/// The slip R w is slowed down by 3 mu g, a third of it by the disc's drive: it rolls at R w/3.
fn drives_off(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let run = lab.run(&spin_up(), 70.0)?;
    let dt = run.scene.dt();
    let slips = run.first(|s| rim(s.v[DISC]).abs() <= 1e-6).unwrap_or(usize::MAX);
    lab.near("disc, time of rolling", slips as f64 * dt, 1000.0 / (3.0 * 4.905), dt);
    let gained = |k: usize| run.tape.state(k).v[DISC].x / (k as f64 * dt);
    let worst = (1..slips).map(|k| (gained(k) - 4.905).abs()).fold(0.0, f64::max);
    lab.near("disc, acceleration until it rolls", 4.905 + worst, 4.905, 1e-10);
    lab.relative("disc, v once it rolls", run.last().v[DISC].x, 1000.0 / 3.0, 1e-10);
    lab.near("disc, slip once it rolls", rim(run.last().v[DISC]), 0.0, 1e-10);
    Ok(())
}

/// Speed of the disc's lowest point, m/s.
fn rim(v: nalgebra::Vector3<f64>) -> f64 {
    v.x + 0.1 * v.z
}
