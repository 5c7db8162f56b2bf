//! A crank mechanism, and what hinges take in a first step.

use std::f64::consts::TAU;

use tangency_bench::scenes::{level_pair, slider_crank, supported_rod};
use tangency_core::SceneDef;

use super::held_impulse;
use crate::lab::recommended;
use crate::run::Run;
use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V13",
    title: "Slider-crank and first-step reactions",
    parts: &[
        Part::new("slider-crank", mechanism),
        Part::new("support removed", support_removed),
        Part::new("two level rods", level_rods),
    ],
}];

const CRANK: usize = 0;
const SLIDER: usize = 2;
const START: f64 = 0.5;
/// Crank angle, its rate and the slider's place after 1 s.
const AFTER_ONE: [f64; 3] = [10.051_575_636_715_08, 13.789_201_607_996_32, 0.741_423_201_341_878_5];

/// Number of the joint at a wall, and of the row that holds its height.
const WALL: u32 = 0;
const HEIGHT: u32 = 1;

fn turning(dt: f64) -> SceneDef {
    SceneDef { dt, ..slider_crank(START, 10.0) }
}

fn mechanism(lab: &mut Lab<'_>) -> Result<(), Stop> {
    const NAMES: [&str; 3] = ["(a) angle(1)", "(a) rate(1)", "(a) slider(1)"];
    for dt in [4e-3, 1e-3] {
        let [angle, _, slider] = coordinates(&lab.run(&turning(dt), 1.0)?);
        lab.near(format!("(a) angle(1) at dt={dt}"), angle, AFTER_ONE[0], 40.0 * dt);
        lab.near(format!("(a) slider(1) at dt={dt}"), slider, AFTER_ONE[2], 40.0 * dt);
        // Plain stepping misses the rate by 155 dt: its lag in angle meets a slope of some 30/s.
        let smooth = SceneDef { dt, ..recommended(turning(dt)) };
        let fine = coordinates(&lab.run(&smooth, 1.0)?)[1];
        lab.fine(format!("(a) rate(1) at dt={dt}, C=40"), fine, AFTER_ONE[1], 40.0 * dt);
    }
    lab.order("(a) angle(1)", 0.9, |lab, dt| {
        Ok(coordinates(&lab.run(&turning(dt), 1.0)?)[0] - AFTER_ONE[0])
    })?;
    let fine = recommended(turning(1e-3));
    let found = coordinates(&lab.run(&fine, 1.0)?);
    for ((name, got), exact) in NAMES.iter().zip(found).zip(AFTER_ONE) {
        lab.fine(*name, got, exact, 1e-3);
    }
    let run = lab.run(&fine, 2.0)?;
    lab.fine("(a) angle(2)", coordinates(&run)[0], 19.953_410_911_896_29, 1e-3);
    lab.fine("(a) time of a turn", turn_time(&run), 0.639_875_397_860_437_4, 1e-3);
    Ok(())
}

fn coordinates(run: &Run) -> [f64; 3] {
    let last = run.last();
    [last.q[CRANK].z, last.v[CRANK].z, last.q[SLIDER].x]
}

/// When the crank has turned once, by the line between two states.
fn turn_time(run: &Run) -> f64 {
    let past = |angle: f64| angle - START - TAU;
    let Some(k) = run.first(|state| past(state.q[CRANK].z) >= 0.0) else { return f64::NAN };
    let (before, after) = (run.tape.state(k - 1), run.tape.state(k));
    let [a, b] = [before, after].map(|state| past(state.q[CRANK].z));
    before.time + (after.time - before.time) * a / (a - b)
}

fn support_removed(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for (name, both, exact) in
        [("(b) left force, held", true, 14.715), ("(b) left force, released", false, 7.357_5)]
    {
        let def = supported_rod(both);
        let force = held_impulse(&lab.first_step(&def)?, WALL, HEIGHT) / def.dt;
        lab.near(name, force, exact, 1e-6);
    }
    Ok(())
}

/// Rates in units of g/L downwards, reaction in units of m g.
fn level_rods(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let def = level_pair();
    let record = lab.first_step(&def)?;
    let unit = 9.81 * def.dt;
    lab.near("(c) inner rod", -record.after.v[0].z / unit, 9.0 / 7.0, 1e-6);
    lab.near("(c) outer rod", -record.after.v[1].z / unit, -3.0 / 7.0, 1e-6);
    lab.near("(c) wall", held_impulse(&record, WALL, HEIGHT) / unit, 2.0 / 7.0, 1e-6);
    Ok(())
}
