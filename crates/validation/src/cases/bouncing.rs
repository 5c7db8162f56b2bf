//! Discs that bounce: to rest, and for ever.

use tangency_bench::scenes::{billiard, falling_disc};
use tangency_core::{Param, SceneDef, State};

use crate::lab::{recommended, steps};
use crate::run::{Run, Slope, by_restitution};
use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[
    Case {
        id: "V04",
        title: "Bouncing and coming to rest",
        parts: &[
            Part::new("motion", bounce),
            Part::new("recommended stepping", bounce_fine),
            Part::new("derivatives", bounce_derivatives),
        ],
    },
    Case {
        id: "V10",
        title: "Billiard",
        parts: &[
            Part::new("ten seconds", ten_seconds),
            Part::new("a hundred seconds", hundred_seconds),
            Part::new("into a corner", corner),
            Part::new("derivatives", billiard_derivatives),
        ],
    },
];

const BALL: usize = 1;
const FIRST_IMPACT: f64 = 0.451_523_640_985_730_9;
const REST: f64 = 4.063_712_768_871_578_1;
/// Time, gap, impacts so far.
const GAPS: [(f64, f64, usize); 4] = [
    (1.0, 0.468_004_452_526_036_31, 1),
    (2.0, 0.260_741_728_327_057_2, 3),
    (3.0, 0.068_707_460_965_765_722, 6),
    (4.0, 7.767_499_142_788_777_5e-5, 19),
];

fn drop(dt: f64) -> SceneDef {
    SceneDef { dt, ..falling_disc(1.0, 0.8) }
}

fn gap(state: &State) -> f64 {
    state.q[BALL].y - 0.1
}

/// Times of the states from which the ball rises after it fell.
fn impacts(run: &Run) -> Vec<f64> {
    let states: Vec<_> = run.moments().collect();
    let turns = states.windows(2).filter(|s| s[0].v[BALL].y < 0.0 && s[1].v[BALL].y > 0.0);
    turns.map(|s| s[1].time).collect()
}

fn impacts_until(run: &Run, time: f64) -> f64 {
    impacts(run).iter().filter(|impact| **impact <= time).count() as f64
}

/// The last time at which the ball moves faster than a millionth.
fn moves_until(run: &Run) -> f64 {
    let moving = run.moments().filter(|s| s.v[BALL].y.abs() > 1e-6);
    moving.last().map_or(f64::NAN, |s| s.time)
}

fn bounce(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for dt in [4e-3, 1e-3] {
        let run = lab.run(&drop(dt), 5.0)?;
        let first = impacts(&run).first().copied().unwrap_or(f64::NAN);
        lab.near(format!("first impact, dt={dt}"), first, FIRST_IMPACT, 8.0 * dt);
        for (t, exact, _) in GAPS {
            lab.near(format!("gap({t}) at dt={dt}"), gap(run.at(t)), exact, 8.0 * dt);
        }
        // Beyond, flights are shorter than the error of the times of impact.
        for (t, _, count) in &GAPS[..3] {
            let found = impacts_until(&run, *t);
            lab.near(format!("impacts until {t}, dt={dt}"), found, *count as f64, 0.0);
        }
        lab.at_most(format!("gap(5) at dt={dt}"), gap(run.last()), 1e-4);
        lab.at_most(format!("speed at 5 s, dt={dt}"), run.last().v[BALL].y.abs(), 2e-2);
        // Within a step a bounce leaves from where the step began, which shifts the energy by up
        // to (g e dt)²/(2 (1 − e²)); from top to top it never grows.
        let tops = tops(&run);
        lab.near(format!("rise from one top to the next, dt={dt}"), rise(&tops), 0.0, 1e-12);
    }
    for (t, exact, _) in GAPS {
        let miss = |lab: &mut Lab<'_>, dt| Ok(gap(lab.run(&drop(dt), t)?.last()) - exact);
        lab.order(&format!("gap({t})"), 0.7, miss)?;
    }
    Ok(())
}

fn energies(run: &Run) -> Vec<f64> {
    run.tape.states().map(|s| run.scene.energy(s)).collect()
}

/// Gaps where the ball stops rising.
fn tops(run: &Run) -> Vec<f64> {
    let states: Vec<_> = run.tape.states().collect();
    let turns = states.windows(2).filter(|s| s[0].v[BALL].y > 0.0 && s[1].v[BALL].y <= 0.0);
    turns.map(|s| gap(s[0])).collect()
}

/// The greatest rise from one number to the next.
fn rise(numbers: &[f64]) -> f64 {
    numbers.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max)
}

fn bounce_fine(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let run = lab.run(&recommended(falling_disc(1.0, 0.8)), 5.0)?;
    let first = impacts(&run).first().copied().unwrap_or(f64::NAN);
    lab.fine("first impact", first, FIRST_IMPACT, 1e-9);
    for (t, exact, count) in GAPS {
        let tolerance = if t > 3.0 { 1e-6 } else { 1e-9 };
        lab.fine(format!("gap({t})"), gap(run.at(t)), exact, tolerance);
        lab.fine(format!("impacts until {t}"), impacts_until(&run, t), count as f64, 0.0);
    }
    // The ball is slower than a millionth for the last microsecond.
    lab.fine("motion ends", moves_until(&run), REST, 1e-5);
    lab.fine("gap(5)", gap(run.last()), 0.0, 1e-6);
    lab.fine("speed at 5 s", run.last().v[BALL].y, 0.0, 1e-6);
    lab.fine("rise of energy in a step", rise(&energies(&run)), 0.0, 1e-12);
    Ok(())
}

fn bounce_derivatives(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let (height, e, g) =
        ([(Param::Position(BALL, 1), 1.0)], by_restitution(0, BALL), [(Param::Gravity(1), -1.0)]);
    let entries: [Slope<'_>; 3] = [
        ("height", &height, 0.426_610_864_163_528_6),
        ("e", &e, 2.499_324_113_317_087_3),
        ("g", &g, -0.016_908_168_790_669_868),
    ];
    let run = lab.run(&recommended(falling_disc(1.0, 0.8)), 2.0)?;
    let seed = run.pick(|s| s.q[BALL].y = 1.0);
    for (by, direction, exact) in entries {
        let found = lab.slope(&run, &seed, direction)?;
        lab.impact(format!("d/d{by} of gap(2)"), found, exact, 1e-6 * exact.abs());
    }
    // At rest the gap is zero whatever came before.
    let at_rest = entries.map(|(by, direction, _)| (by, direction, 0.0));
    let scene = falling_disc(1.0, 0.8);
    lab.slopes("gap(5)", (&scene, 5.0), |s| s.q[BALL].y = 1.0, &at_rest, 1e-6)
}

const DISC: usize = 4;
const START: [f64; 2] = [0.3, 0.4];
const VELOCITY: [f64; 2] = [1.7, 1.1];

fn table() -> SceneDef {
    SceneDef { dt: 1e-3, ..billiard(START, VELOCITY) }
}

/// What is measured along the way.
struct Tour {
    last: State,
    impacts: [usize; 2],
    speed_error: f64,
}

fn tour(lab: &mut Lab<'_>, def: &SceneDef, duration: f64) -> Result<Tour, Stop> {
    let (mut before, mut impacts, mut speed_error) = (VELOCITY, [0; 2], 0.0_f64);
    let exact = VELOCITY[0].hypot(VELOCITY[1]);
    let last = lab.watch(def, steps(duration, def.dt), |_, record| {
        let v = record.after.v[DISC];
        for axis in [0, 1] {
            impacts[axis] += usize::from(before[axis] * v[axis] < 0.0);
        }
        (before, speed_error) = ([v.x, v.y], speed_error.max((v.xy().norm() - exact).abs()));
    })?;
    Ok(Tour { last, impacts, speed_error })
}

fn ten_seconds(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for dt in [4e-3, 1e-3] {
        let Tour { last, impacts, speed_error } = tour(lab, &SceneDef { dt, ..table() }, 10.0)?;
        let [x, y] = [last.q[DISC].x, last.q[DISC].y];
        lab.near(format!("x(10) at dt={dt}"), x, 1.8, 80.0 * dt);
        lab.near(format!("y(10) at dt={dt}"), y, 0.6, 80.0 * dt);
        lab.near(format!("impacts with sides until 10 s, dt={dt}"), impacts[0] as f64, 9.0, 0.0);
        lab.near(format!("impacts with floor and ceiling, dt={dt}"), impacts[1] as f64, 12.0, 0.0);
        lab.near(format!("speed error over 10 s, dt={dt}"), speed_error, 0.0, 1e-12);
    }
    lab.order("position(10)", 0.7, |lab, dt| {
        let last = tour(lab, &SceneDef { dt, ..table() }, 10.0)?.last;
        Ok((last.q[DISC].x - 1.8).hypot(last.q[DISC].y - 0.6))
    })
}

fn hundred_seconds(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let Tour { speed_error, .. } = tour(lab, &table(), 100.0)?;
    lab.near("speed error over 100 s, dt=0.001", speed_error, 0.0, 1e-12);
    let Tour { last, impacts, speed_error } = tour(lab, &recommended(table()), 100.0)?;
    lab.fine("x(100)", last.q[DISC].x, 0.8, 1e-9);
    lab.fine("y(100)", last.q[DISC].y, 0.6, 1e-9);
    lab.fine("impacts with sides until 100 s", impacts[0] as f64, 89.0, 0.0);
    lab.fine("impacts with floor and ceiling until 100 s", impacts[1] as f64, 122.0, 0.0);
    lab.fine("speed error over 100 s", speed_error, 0.0, 1e-12);
    Ok(())
}

/// Both walls are reached at 0.5 s, so that the disc returns to where it came from at 1 s.
fn corner(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let scene = billiard([1.95 - 0.5, 0.95 - 0.25], [1.0, 0.5]);
    for dt in [1e-2, 1e-3] {
        let run = lab.run(&SceneDef { dt, ..scene.clone() }, 1.0)?;
        let v = run.last().v[DISC];
        lab.near(format!("vx after a corner, dt={dt}"), v.x, -1.0, 1e-12);
        lab.near(format!("vy after a corner, dt={dt}"), v.y, -0.5, 1e-12);
    }
    let fine = lab.run(&recommended(scene), 1.0)?;
    let back = (fine.last().q[DISC] - fine.tape.initial.q[DISC]).norm();
    lab.fine("distance from the start after a corner", back, 0.0, 1e-9);
    Ok(())
}

fn billiard_derivatives(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let run = lab.run(&recommended(table()), 10.0)?;
    for (axis, name, sign) in [(0, "x", -1.0), (1, "y", 1.0)] {
        let seed = run.pick(|s| s.q[DISC][axis] = 1.0);
        let place = lab.slope(&run, &seed, &[(Param::Position(DISC, axis), 1.0)])?;
        lab.impact(format!("d{name}/d{name}0"), place, sign, 1e-6);
        let speed = lab.slope(&run, &seed, &[(Param::Velocity(DISC, axis), 1.0)])?;
        lab.impact(format!("d{name}/dv{name}"), speed, 10.0 * sign, 1e-5);
    }
    Ok(())
}
