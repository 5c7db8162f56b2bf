//! More contacts and hinges than the motion needs.

use tangency_bench::scenes::{doubled_hinge, redundant_floor};
use tangency_core::{Param, SceneDef};

use super::{contact_sums, held_impulse};
use crate::lab::recommended;
use crate::run::{Run, Slope, by_friction};
use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V22",
    title: "Redundant contacts and joints",
    parts: &[
        Part::new("(a) motion", slides),
        Part::new("(a) derivatives", derivatives),
        Part::new("(b) hinge entered again", hinges),
    ],
}];

const BOX: usize = 1;
const T: f64 = 1.1;
const POINTS: [usize; 4] = [2, 3, 10, 100];
const STOP: f64 = 1.529_051_987_767_584_1;
const STOP_TIME: f64 = 1.019_367_991_845_056_1;

fn scene(k: usize, dt: f64) -> SceneDef {
    SceneDef { dt, ..redundant_floor(k) }
}

/// The first time at which the box rests.
fn stops_at(run: &Run) -> f64 {
    let first = run.moments().find(|s| s.v[BOX].norm() <= 1e-9);
    first.map_or(f64::NAN, |state| state.time)
}

fn slides(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for dt in [1e-2, 1e-3] {
        let plain = lab.run(&scene(2, dt), T)?;
        for k in POINTS {
            let run = lab.run(&scene(k, dt), T)?;
            let name = format!("k={k}, dt={dt}");
            let points = run.tape.records[0].contacts.len();
            lab.near(format!("(a) contact points, {name}"), points as f64, k as f64, 0.0);
            let weight = 9.81 * dt;
            let sums = run.tape.records.iter().map(|r| (contact_sums(r).0 - weight).abs());
            let off = sums.fold(0.0, f64::max);
            lab.near(format!("(a) normal sum less m g dt, {name}"), off, 0.0, 1e-9);
            lab.near(format!("(a) stop, {name}"), run.last().q[BOX].x, STOP, 2.0 * dt);
            lab.near(format!("(a) time of stop, {name}"), stops_at(&run), STOP_TIME, 2.0 * dt);
            lab.near(format!("(a) turn, {name}"), run.worst(|s| s.q[BOX].z.abs()), 0.0, 1e-9);
            lab.near(format!("(a) against k=2, {name}"), apart(&run, &plain), 0.0, 1e-9);
        }
    }
    for k in POINTS {
        let fine = lab.run(&recommended(redundant_floor(k)), T)?;
        lab.fine(format!("(a) stop, k={k}"), fine.last().q[BOX].x, STOP, 1e-5);
        lab.fine(format!("(a) time of stop, k={k}"), stops_at(&fine), STOP_TIME, 1e-5);
    }
    Ok(())
}

/// The greatest distance between two runs' states of the last body.
fn apart(one: &Run, other: &Run) -> f64 {
    let body = one.scene.bodies().len() - 1;
    let off = one
        .tape
        .states()
        .zip(other.tape.states())
        .map(|(a, b)| (a.q[body] - b.q[body]).norm().max((a.v[body] - b.v[body]).norm()));
    off.fold(0.0, f64::max)
}

fn derivatives(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let speed = [(Param::Velocity(BOX, 0), 1.0)];
    let mass = [(Param::Mass(BOX), 1.0), (Param::Inertia(BOX), 1.0 / 6.0)];
    let friction = by_friction(0, BOX);
    for k in POINTS {
        let run = lab.run(&scene(k, 1e-2), T)?;
        let seed = run.pick(|s| s.q[BOX].x = 1.0);
        // Sums over the steps until the stop.
        let entries: [Slope<'_>; 3] =
            [("mu", &friction, -5.053_131), ("v0", &speed, 1.01), ("m", &mass, 0.0)];
        for (by, direction, exact) in entries {
            let found = lab.slope(&run, &seed, direction)?;
            lab.near(format!("(a) dx/d{by}, k={k}, dt=0.01"), found, exact, 1e-8);
        }
        let entries: [Slope<'_>; 3] = [
            ("v0", &speed, STOP_TIME),
            ("mu", &friction, -5.096_839_959_225_280_3),
            ("m", &mass, 0.0),
        ];
        let what = format!("x, k={k}");
        lab.slopes(&what, (&redundant_floor(k), T), |s| s.q[BOX].x = 1.0, &entries, 1e-6)?;
    }
    Ok(())
}

fn hinges(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let single = lab.run(&SceneDef { dt: 1e-3, ..doubled_hinge(2.5, 1) }, 2.0)?;
    for k in [2_u32, 5] {
        let again = lab.run(&SceneDef { dt: 1e-3, ..doubled_hinge(2.5, k as usize) }, 2.0)?;
        lab.near(format!("(b) motion, {k} hinges"), apart(&single, &again), 0.0, 1e-9);
        for row in 0..2 {
            let pairs = single.tape.records.iter().zip(&again.tape.records);
            let off = pairs.map(|(one, many)| {
                let sum: f64 = (0..k).map(|joint| held_impulse(many, joint, row)).sum();
                (sum - held_impulse(one, 0, row)).abs()
            });
            let worst = off.fold(0.0, f64::max);
            lab.near(format!("(b) sum of multipliers {row}, {k} hinges"), worst, 0.0, 1e-9);
        }
    }
    Ok(())
}
