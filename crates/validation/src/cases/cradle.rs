//! Discs in a row, one of which arrives.
//!
//! Touching discs obey Newton's law for all contacts at once: every contact that closes leaves at e
//! times the speed it closed at, and those that did not close may not close afterwards. A chain of
//! single impacts, as with gaps, would send off the last disc alone.

use tangency_bench::scenes::cradle;
use tangency_core::{Param, SceneDef, StepRecord};

use crate::lab::recommended;
use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V08",
    title: "Five discs in a row",
    parts: &[
        Part::new("with gaps", with_gaps),
        Part::new("touching", touching),
        Part::new("derivatives", derivatives),
    ],
}];

/// Long enough for all impacts: the first disc has 0.3 m to go, the others three gaps of 0.01 m.
const T: f64 = 0.5;

fn with_gaps(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let scene = cradle(5, 0.01, 0.3, 1.0);
    for dt in [1e-2, 1e-3] {
        let run = lab.run(&SceneDef { dt, ..scene.clone() }, T)?;
        for (ball, exact) in [0.0, 0.0, 0.0, 0.0, 1.0].into_iter().enumerate() {
            let v = run.last().v[ball];
            lab.near(format!("gaps: v of disc {ball}, dt={dt}"), v.x, exact, 1e-10);
        }
        lab.near(format!("gaps: energy, dt={dt}"), run.scene.energy(run.last()), 0.5, 1e-10);
    }
    Ok(())
}

fn touching(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let impulses = [1.6, 1.2, 0.8, 0.4];
    check(lab, "five, e=1", (5, 1.0), &[-0.6, 0.4, 0.4, 0.4, 0.4], &impulses)?;
    let third = 1.0 / 3.0;
    let impulses = [4.0 * third, 2.0 * third];
    check(lab, "three, e=1", (3, 1.0), &[-third, 2.0 * third, 2.0 * third], &impulses)?;
    let impulses = [1.2, 0.9, 0.6, 0.3];
    check(lab, "five, e=1/2", (5, 0.5), &[-0.2, 0.3, 0.3, 0.3, 0.3], &impulses)
}

/// Velocities, impulses and energy of one step of touching discs.
fn check(
    lab: &mut Lab<'_>,
    what: &str,
    (n, e): (usize, f64),
    velocities: &[f64],
    impulses: &[f64],
) -> Result<(), Stop> {
    let run = lab.run_steps(&cradle(n, 0.0, 0.0, e), 1)?;
    for (i, exact) in velocities.iter().enumerate() {
        lab.near(format!("touching {what}: v of disc {i}"), run.last().v[i].x, *exact, 1e-10);
    }
    for (i, exact) in impulses.iter().enumerate() {
        let found = between(run.end(), i);
        lab.near(format!("touching {what}: impulse {i}"), found, *exact, 1e-10);
    }
    let exact: f64 = velocities.iter().map(|v| 0.5 * v * v).sum();
    lab.near(format!("touching {what}: energy"), run.scene.energy(run.last()), exact, 1e-10);
    Ok(())
}

/// Impulse between a disc and the next.
fn between(record: &StepRecord, disc: usize) -> f64 {
    let impulses = record.contact_impulses();
    let pair = |contact: usize| record.contacts[contact].feature.id.bodies.map(|b| b as usize);
    let same = impulses.iter().find(|i| pair(i.contact) == [disc, disc + 1]);
    same.map_or(0.0, |i| i.normal)
}

fn derivatives(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for (what, gap, start, exact) in [("gaps", 0.01, 0.3, 1.0), ("touching", 0.0, 0.0, 0.4)] {
        let by_first = |lab: &mut Lab<'_>, def: &SceneDef| {
            let run = lab.run(def, T)?;
            let seed = run.pick(|s| s.v[4].x = 1.0);
            lab.slope(&run, &seed, &[(Param::Velocity(0, 0), 1.0)])
        };
        let scene = cradle(5, gap, start, 1.0);
        let found = by_first(lab, &SceneDef { dt: 1e-3, ..scene.clone() })?;
        lab.near(format!("{what}: d(last)/d(first) at dt=0.001"), found, exact, 1e-10);
        let found = by_first(lab, &recommended(scene))?;
        lab.fine(format!("{what}: d(last)/d(first)"), found, exact, 1e-10);
    }
    Ok(())
}
