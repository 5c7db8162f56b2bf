//! Contacts at which nothing should happen.

use tangency_bench::scenes::{
    block, disc, fixed_block, floor, material, plane, sliding_box, stack, unit_scene,
};
use tangency_core::{BodyDef, Scene, SceneDef};

use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V29",
    title: "Quiet contact",
    parts: &[
        Part::new("disc at rest with e = 1", rests),
        Part::new("no force at a distance", keeps_away),
        Part::new("sliding block", slides),
        Part::new("seam", crosses_seam),
        Part::new("corner", stops_in_corner),
        Part::new("stack of three", stands),
        Part::long("stack of three for a million steps", stands_for_long),
    ],
}];

/// With gravity.
fn on_floor(body: BodyDef, friction: f64, restitution: f64) -> SceneDef {
    let def = SceneDef { bodies: vec![floor(), body], ..SceneDef::default() };
    material(def, friction, restitution)
}

fn rests(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let run = lab.run_steps(&on_floor(disc("disc", 0.1, [0.0, 0.1]), 0.0, 1.0), 1000)?;
    lab.near("disc at rest, e=1: speed", run.worst(|s| s.v[1].norm()), 0.0, 1e-12);
    Ok(())
}

/// The contact of a disc that is fast along the floor is modelled, that of a slow one is not, even if
/// another disc far away is fast.
fn keeps_away(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for (e, along) in [(0.0, 0.0), (0.5, 0.0), (0.0, 50.0), (0.5, 50.0), (1.0, 50.0)] {
        let near = BodyDef { velocity: [along, -0.01], ..disc("disc", 0.1, [0.0, 0.15]) };
        let fast = BodyDef { velocity: [50.0, 0.0], ..disc("fast", 0.1, [50.0, 9.0]) };
        let def = material(unit_scene("approach", vec![floor(), near, fast]), 0.0, e);
        let record = lab.first_step(&def)?;
        let what = format!("gap 0.05, e={e}, along the floor at {along} m/s");
        lab.holds(format!("{what}: modelled"), record.contacts.is_empty() == (along == 0.0));
        lab.near(format!("{what}: vy"), record.after.v[1].y, -0.01, 1e-17);
        let impulses = record.contact_impulses().len() as f64; // those that are not zero
        lab.near(format!("{what}: impulses"), impulses, 0.0, 0.0);
    }
    Ok(())
}

fn slides(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let run = lab.run(&sliding_box(1.0, 0.5, 3.0), 1.0)?;
    lab.near("sliding block: gap", run.worst(|s| (s.q[1].y - 0.1).abs()), 0.0, 1e-9);
    Ok(())
}

/// A box crosses the common edge of two static boxes at 2 m/s.
fn crosses_seam(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let left = fixed_block("left", [2.0, 0.5], [-1.0, -0.25]);
    let right = fixed_block("right", [2.0, 0.5], [1.0, -0.25]);
    let slider = BodyDef { velocity: [2.0, 0.0], ..block("box", [0.4, 0.2], [-0.7, 0.1]) };
    let def = SceneDef { bodies: vec![left, right, slider], ..SceneDef::default() };
    let run = lab.run_steps(&material(def, 0.0, 0.0), 70)?;
    lab.at_least("seam: x at the end", run.last().q[2].x, 0.6);
    lab.near("seam: speed less 2 m/s", run.worst(|s| (s.v[2].x - 2.0).abs()), 0.0, 1e-12);
    lab.near("seam: turn", run.worst(|s| s.q[2].z.abs()), 0.0, 1e-12);
    lab.near("seam: rate of turn", run.worst(|s| s.v[2].z.abs()), 0.0, 1e-12);
    Ok(())
}

fn stops_in_corner(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let wall = plane("wall", [-1.0, 0.0], -1.0); // solid where x >= 1
    let moving = BodyDef { velocity: [2.0, -1.0], ..block("box", [0.5, 0.5], [0.75, 0.25]) };
    let def = material(unit_scene("corner", vec![floor(), wall, moving]), 0.0, 0.0);
    let after = lab.first_step(&def)?.after;
    lab.near("corner: speed", after.v[2].norm(), 0.0, 1e-12);
    Ok(())
}

fn stands(lab: &mut Lab<'_>) -> Result<(), Stop> {
    drift(lab, 20_000)
}

fn stands_for_long(lab: &mut Lab<'_>) -> Result<(), Stop> {
    drift(lab, 1_000_000)
}

fn drift(lab: &mut Lab<'_>, steps: usize) -> Result<(), Stop> {
    let def = stack(&[1.0; 3]);
    let start = Scene::new(&def)?.initial_state();
    let (mut worst, mut energy) = (0.0_f64, 0.0_f64);
    lab.watch(&def, steps, |scene, record| {
        let drift = record.after.q.iter().zip(&start.q).map(|(q, start)| (q - start).norm());
        worst = drift.fold(worst, f64::max);
        energy = energy.max((scene.energy(&record.after) / scene.energy(&start) - 1.0).abs());
    })?;
    let name = format!("stack of three, {steps} steps");
    lab.near(format!("{name}: drift"), worst, 0.0, 1e-9);
    lab.near(format!("{name}: change of energy, relative"), energy, 0.0, 1e-9);
    Ok(())
}
