//! Boxes upon boxes.

use nalgebra::Vector3;
use tangency_bench::scenes::{pyramid, stack};
use tangency_core::{ContactImpulse, RowSource, Scene, SceneDef, State, StepRecord};
use tangency_diff::DiffError;
use tangency_diff::lcp::{LcpVector, lcp_jvp};

use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[
    Case { id: "V19", title: "Mass ratio", parts: &[Part::new("heavy on light", mass_ratio)] },
    Case {
        id: "V20",
        title: "Tower and pyramid",
        parts: &[
            Part::new("tower of 20", |lab| tower(lab, 20, 600)),
            Part::new("tower of 100, half a second", |lab| tower(lab, 100, 30)),
            Part::new("pyramid of base 8", |lab| pile(lab, 8, 300)),
            Part::long("tower of 100", |lab| tower(lab, 100, 600)),
            Part::long("pyramid of base 20", |lab| pile(lab, 20, 600)),
        ],
    },
];

const G: f64 = 9.81;

/// Sum of the normal impulses between two bodies, N·s.
pub(crate) fn between(record: &StepRecord, pair: [u32; 2]) -> f64 {
    let of_pair = |i: &&ContactImpulse| record.contacts[i.contact].feature.id.bodies == pair;
    record.contact_impulses().iter().filter(of_pair).map(|i| i.normal).sum()
}

/// Sum of the normal impulses on body 0, N·s.
pub(crate) fn on_floor(record: &StepRecord) -> f64 {
    let of_floor = |i: &&ContactImpulse| record.contacts[i.contact].feature.id.bodies[0] == 0;
    record.contact_impulses().iter().filter(of_floor).map(|i| i.normal).sum()
}

/// The worst of a quantity of two lists of vectors.
fn worst(
    a: &[Vector3<f64>],
    b: &[Vector3<f64>],
    of: impl Fn(&Vector3<f64>, &Vector3<f64>) -> f64,
) -> f64 {
    a.iter().zip(b).map(|(a, b)| of(a, b)).fold(0.0, f64::max)
}

fn mass_ratio(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for ratio in [1e3, 1e6, 1e8] {
        let run = lab.run(&SceneDef { dt: 0.01, ..stack(&[1.0, ratio]) }, 10.0)?;
        let (last, dt) = (run.end(), run.scene.dt());
        let floor = between(last, [0, 1]) / dt;
        lab.relative(format!("floor force at {ratio:e}"), floor, (1.0 + ratio) * G, 1e-8);
        let upper = between(last, [1, 2]) / dt;
        lab.relative(format!("upper force at {ratio:e}"), upper, ratio * G, 1e-8);
        let speed = run.worst(|s| s.v.iter().map(Vector3::norm).fold(0.0, f64::max));
        lab.near(format!("speed at {ratio:e}"), speed, 0.0, 1e-9);
        let moved = worst(&last.after.q, &run.tape.initial.q, |a, b| (a - b).norm());
        lab.near(format!("sinking at {ratio:e}"), moved, 0.0, 1e-9);
        let by_top = floor_by_top(&run.scene, last)?;
        lab.relative(format!("d(floor force)/d(top mass) at {ratio:e}"), by_top, G, 1e-6);
    }
    Ok(())
}

/// The change of the floor's force with the mass of the upper box, whose momentum is −m dt g.
fn floor_by_top(scene: &Scene, record: &StepRecord) -> Result<f64, DiffError> {
    let Some((island, top)) = record
        .islands
        .iter()
        .find_map(|island| Some((island, island.bodies.iter().position(|body| *body == 2)?)))
    else {
        return Ok(f64::NAN);
    };
    let mass = scene.bodies()[2].mass;
    let mut tangent = LcpVector::zeros(&island.problem);
    tangent.mass[top] = mass / mass.x;
    tangent.momentum[top].y = -G * scene.dt();
    let (_, impulses) = lcp_jvp(&island.problem, &island.solution, &tangent)?;
    let floor = |source: &RowSource| match source {
        RowSource::Normal { contact } => {
            record.contacts[*contact as usize].feature.id.bodies == [0, 1]
        }
        _ => false,
    };
    let rows = island.sources.iter().zip(&impulses).filter(|(source, _)| floor(source));
    Ok(rows.map(|(_, impulse)| impulse).sum::<f64>() / scene.dt())
}

fn tower(lab: &mut Lab<'_>, n: u32, count: usize) -> Result<(), Stop> {
    let def = SceneDef { dt: 1.0 / 60.0, ..stack(&vec![1.0; n as usize]) };
    let start = Scene::new(&def)?.initial_state();
    let (mut forces, mut drift, mut tilt) = (0.0_f64, 0.0_f64, 0.0_f64);
    let mut energy = 0.0_f64;
    lab.watch(&def, count, |scene, record| {
        energy = energy.max((scene.energy(&record.after) / scene.energy(&start) - 1.0).abs());
        for i in 0..n {
            let weight = f64::from(n - i) * G;
            let force = between(record, [i, i + 1]) / scene.dt();
            forces = forces.max((force / weight - 1.0).abs());
        }
        drift = drift.max(worst(&record.after.q, &start.q, |a, b| (a - b).xy().norm()));
        tilt = tilt.max(worst(&record.after.q, &start.q, |a, b| (a.z - b.z).abs()));
    })?;
    let name = format!("tower of {n}, {count} steps");
    lab.near(format!("{name}, worst force, relative"), forces, 0.0, 1e-8);
    lab.near(format!("{name}, drift"), drift, 0.0, 1e-8);
    lab.near(format!("{name}, tilt"), tilt, 0.0, 1e-9);
    lab.near(format!("{name}, change of energy, relative"), energy, 0.0, 1e-9);
    Ok(())
}

fn pile(lab: &mut Lab<'_>, base: usize, count: usize) -> Result<(), Stop> {
    let def = SceneDef { dt: 1.0 / 60.0, ..pyramid(base) };
    let weight = (def.bodies.len() - 1) as f64 * G;
    let start = Scene::new(&def)?.initial_state();
    let (mut floor, mut speed, mut skew) = (0.0_f64, 0.0_f64, 0.0_f64);
    let mut energy = 0.0_f64;
    lab.watch(&def, count, |scene, record| {
        energy = energy.max((scene.energy(&record.after) / scene.energy(&start) - 1.0).abs());
        floor = floor.max((on_floor(record) / scene.dt() / weight - 1.0).abs());
        speed = speed.max(record.after.v.iter().map(Vector3::norm).fold(0.0, f64::max));
        skew = skew.max(asymmetry(base, &record.after));
    })?;
    let name = format!("pyramid of base {base}, {count} steps");
    lab.near(format!("{name}, floor sum over weight"), 1.0 + floor, 1.0, 1e-8);
    lab.near(format!("{name}, speed"), speed, 0.0, 1e-8);
    lab.near(format!("{name}, asymmetry"), skew, 0.0, 1e-8);
    lab.near(format!("{name}, change of energy, relative"), energy, 0.0, 1e-9);
    Ok(())
}

/// How far the poses are from their mirror image; rows from below, each from the left.
fn asymmetry(base: usize, state: &State) -> f64 {
    let (mut first, mut worst) = (1, 0.0_f64);
    for count in (1..=base).rev() {
        for i in 0..count {
            let (a, b) = (state.q[first + i], state.q[first + count - 1 - i]);
            worst = worst.max(Vector3::new(a.x + b.x, a.y - b.y, a.z + b.z).norm());
        }
        first += count;
    }
    worst
}
