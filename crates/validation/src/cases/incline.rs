//! A block on a slope.

use tangency_bench::scenes::incline_block;
use tangency_core::{Param, SceneDef};

use crate::lab::recommended;
use crate::run::{Run, Slope, by_friction};
use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V05",
    title: "Block on an incline",
    parts: &[
        Part::new("slides from rest", slides),
        Part::new("stops and stays", stops),
        Part::new("derivatives", derivatives),
    ],
}];

const BLOCK: usize = 1;
const SLIDES: f64 = 0.328_572_697_218_664_22;
const STOPS: f64 = 0.414_670_242_627_784_71;

fn slope_angle() -> f64 {
    30.0_f64.to_radians()
}

fn scene(friction: f64, speed: f64, dt: f64) -> SceneDef {
    SceneDef { dt, ..incline_block(slope_angle(), friction, speed) }
}

/// Distance travelled up the slope.
fn travel(run: &Run) -> f64 {
    let (sin, cos) = slope_angle().sin_cos();
    let d = run.last().q[BLOCK] - run.tape.initial.q[BLOCK];
    d.x * cos + d.y * sin
}

fn slides(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for dt in [1e-2, 1e-3] {
        let run = lab.run(&scene(0.5, 0.0, dt), 1.0)?;
        lab.near(format!("(a) s(1) at dt={dt}"), -travel(&run), SLIDES, 0.5 * dt);
    }
    lab.order("(a) s(1)", 0.9, |lab, dt| {
        Ok(-travel(&lab.run(&scene(0.5, 0.0, dt), 1.0)?) - SLIDES)
    })?;
    let fine = lab.run(&recommended(scene(0.5, 0.0, 1e-3)), 1.0)?;
    lab.fine("(a) s(1)", -travel(&fine), SLIDES, 1e-9);
    Ok(())
}

fn stops(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for dt in [1e-2, 1e-3] {
        let run = lab.run(&scene(0.7, 3.0, dt), 0.5)?;
        lab.near(format!("(b) stop at dt={dt}"), travel(&run), STOPS, 2.0 * dt);
        let first = run.first(|s| s.v[BLOCK].norm() <= 1e-9).unwrap_or(usize::MAX);
        let time = first as f64 * dt;
        lab.near(format!("(b) time at dt={dt}"), time, 0.276_446_828_418_523_14, 2.0 * dt);
    }
    lab.order("(b) stop", 0.9, |lab, dt| Ok(travel(&lab.run(&scene(0.7, 3.0, dt), 0.5)?) - STOPS))?;
    let fine = lab.run(&recommended(scene(0.7, 3.0, 1e-3)), 0.5)?;
    lab.fine("(b) stop", travel(&fine), STOPS, 1e-5);

    let long = lab.run(&scene(0.7, 3.0, 1e-2), 100.5)?;
    let creep = (long.last().q[BLOCK] - long.tape.state(50).q[BLOCK]).norm();
    lab.near("(b) creep over 100 s", creep, 0.0, 1e-9);
    let (normal, friction) = super::contact_sums(long.end());
    lab.near("(b) friction at rest", friction.abs() / 1e-2, 9.81 / 2.0, 1e-9);
    lab.near("(b) normal force at rest", normal / 1e-2, 9.81 * slope_angle().cos(), 1e-9);
    Ok(())
}

fn derivatives(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let (sin, cos) = slope_angle().sin_cos();
    let by_speed = [(Param::Velocity(BLOCK, 0), cos), (Param::Velocity(BLOCK, 1), sin)];
    let by_gravity = [(Param::Gravity(1), -1.0)];
    let friction = by_friction(0, BLOCK);
    let from_rest: [Slope<'_>; 3] = [
        ("mu", &friction, -4.247_854_605_562_671_6),
        ("angle", &by_angle(0.0), 5.474_104_605_562_671_6),
        ("g", &by_gravity, 0.033_493_649_053_890_338),
    ];
    let thrown: [Slope<'_>; 3] = [
        ("v0", &by_speed, 0.276_446_828_418_523_14),
        ("mu", &friction, -0.324_633_150_851_300_21),
        ("angle", &by_angle(3.0), -0.193_434_224_928_988_01),
    ];
    table(lab, "(a)", &scene(0.5, 0.0, 1e-3), (1.0, -1.0), &from_rest)?;
    table(lab, "(b)", &scene(0.7, 3.0, 1e-3), (0.5, 1.0), &thrown)
}

/// d(sign · travel) of a run, entry by entry.
fn table(
    lab: &mut Lab<'_>,
    part: &str,
    def: &SceneDef,
    (duration, sign): (f64, f64),
    entries: &[Slope<'_>],
) -> Result<(), Stop> {
    let (plain, fine) = (lab.run(def, duration)?, lab.run(&recommended(def.clone()), duration)?);
    for entry in entries {
        let (what, _, exact) = entry;
        let found = by(lab, &plain, sign, entry)?;
        lab.relative(format!("{part} ds/d{what}"), found, *exact, 2e-2);
        let found = by(lab, &fine, sign, entry)?;
        lab.fine_slope(format!("{part} ds/d{what}, exact"), found, *exact, 1e-6);
    }
    Ok(())
}

/// One entry of a run.
fn by(lab: &mut Lab<'_>, run: &Run, sign: f64, entry: &Slope<'_>) -> Result<f64, Stop> {
    let (sin, cos) = slope_angle().sin_cos();
    let seed = run.pick(|s| (s.q[BLOCK].x, s.q[BLOCK].y) = (sign * cos, sign * sin));
    let (what, direction, _) = entry;
    let found = lab.slope(run, &seed, direction)?;
    if *what != "angle" {
        return Ok(found);
    }
    // The slope that the travel is measured along turns too, and so does the start.
    let start = run.tape.initial.q[BLOCK];
    let d = run.last().q[BLOCK] - start;
    let moved = sign * (cos * -start.y + sin * start.x);
    Ok(found + sign * (-d.x * sin + d.y * cos) - moved)
}

/// The slope turns about the origin, with the block and its velocity.
fn by_angle(speed: f64) -> [(Param, f64); 6] {
    let (sin, cos) = slope_angle().sin_cos();
    [
        (Param::Position(0, 2), 1.0),
        (Param::Position(BLOCK, 0), -0.1 * cos),
        (Param::Position(BLOCK, 1), -0.1 * sin),
        (Param::Position(BLOCK, 2), 1.0),
        (Param::Velocity(BLOCK, 0), -speed * sin),
        (Param::Velocity(BLOCK, 1), speed * cos),
    ]
}
