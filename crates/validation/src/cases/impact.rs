//! Derivatives through an impact, whose time they move.
//!
//! Plain stepping differentiates a saw-tooth: for a full bounce it gives +1 by the height and −0.10
//! by the speed at every dt, where the motion has −1 and −1.

use tangency_bench::scenes::{pursuit, thrown_down};
use tangency_core::{Param, SceneDef};

use crate::lab::resolved;
use crate::run::{Direction, Run, by_restitution};
use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V34",
    title: "Through an impact",
    parts: &[
        Part::new("(a) bounce without gravity", bounces),
        Part::new("(a) landing", lands),
        Part::new("(b) bounce with gravity", falls),
        Part::new("(c) equal discs", equal_discs),
        Part::new("(d) unequal discs", unequal_discs),
    ],
}];

const BALL: usize = 1;
const TOLERANCE: f64 = 1e-8;
/// For as long acts the force, s.
const DT: f64 = 1.0 / 480.0;

type Entry<'a> = (&'a str, &'a [(Param, f64)], f64);

/// Derivatives of one coordinate of a body at the end.
fn table(
    lab: &mut Lab<'_>,
    what: &str,
    (run, body, axis): (&Run, usize, usize),
    entries: &[Entry<'_>],
) -> Result<(), Stop> {
    let seed = run.pick(|s| s.q[body][axis] = 1.0);
    for (by, direction, exact) in entries {
        let slope = lab.slope(run, &seed, direction)?;
        lab.impact(format!("{what}, d/d{by}"), slope, *exact, TOLERANCE);
    }
    Ok(())
}

const HEIGHT: &[(Param, f64)] = &[(Param::Position(BALL, 1), 1.0)];
const SPEED: &[(Param, f64)] = &[(Param::Velocity(BALL, 1), 1.0)];
const RADIUS: &[(Param, f64)] = &[(Param::Radius(BALL, 0), 1.0)];
const GRAVITY: &[(Param, f64)] = &[(Param::Gravity(1), -1.0)];
/// Of 1 kg, so that the force is the acceleration.
const PUSH: &[(Param, f64)] = &[(Param::Force(0, 1), 1.0)];

fn thrown(
    lab: &mut Lab<'_>,
    what: &str,
    (def, duration): (SceneDef, f64),
    y: f64,
    entries: &[Entry<'_>],
) -> Result<(), Stop> {
    let run = lab.run(&resolved(def, DT), duration)?;
    lab.fine(format!("{what}, y"), run.last().q[BALL].y, y, TOLERANCE);
    table(lab, &format!("{what}, y"), (&run, BALL, 1), entries)
}

fn bounces(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let restitution = by_restitution(0, BALL);
    let full: [Entry<'_>; 5] = [
        ("y0", HEIGHT, -1.0),
        ("v0", SPEED, -1.0),
        ("e", &restitution, 1.1),
        ("r", RADIUS, 2.0),
        ("a", PUSH, -0.002_081_163_194_444_444_4),
    ];
    thrown(lab, "(a) e=1", (thrown_down(0.0, 1.0), 1.0), 1.2, &full)?;
    let half: [Entry<'_>; 2] = [("y0", HEIGHT, -0.5), ("v0", SPEED, -0.5)];
    // 0.1 and what is left of the second at half the speed.
    thrown(lab, "(a) e=0.5", (thrown_down(0.0, 0.5), 1.0), 0.65, &half)
}

/// Without a bounce nothing of the start is left, and plain stepping is exact. From 1 m the disc
/// lands at the end of a step; from 1.0037 m within one.
fn lands(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for (height, dt) in [(1.0037, 1e-2), (1.0037, 1e-3)] {
        let mut def = SceneDef { dt, ..thrown_down(0.0, 0.0) };
        def.bodies[BALL].position[1] = height;
        let run = lab.run(&def, 1.0)?;
        let what = format!("(a) e=0 from {height} m at dt={dt}");
        lab.near(format!("{what}, y"), run.last().q[BALL].y, 0.1, TOLERANCE);
        let seed = run.pick(|s| s.q[BALL].y = 1.0);
        for (by, direction) in [("y0", HEIGHT), ("v0", SPEED)] {
            let slope = lab.slope(&run, &seed, direction)?;
            lab.near(format!("{what}, dy/d{by}"), slope, 0.0, TOLERANCE);
        }
    }
    let none: [Entry<'_>; 2] = [("y0", HEIGHT, 0.0), ("v0", SPEED, 0.0)];
    thrown(lab, "(a) e=0", (thrown_down(0.0, 0.0), 1.0), 0.1, &none)
}

fn falls(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let restitution = by_restitution(0, BALL);
    let full: [Entry<'_>; 5] = [
        ("y0", HEIGHT, 0.389_047_015_202_521),
        ("v0", SPEED, -0.224_232_956_984_510_95),
        ("e", &restitution, 1.533_332_326_975_341_5),
        ("g", GRAVITY, 0.020_617_372_711_456_898),
        ("r", RADIUS, 0.610_952_984_797_479),
    ];
    let scene = |e| (thrown_down(9.81, e), 0.6);
    thrown(lab, "(b) e=1", scene(1.0), 1.100_864_653_950_683, &full)?;
    let part: [Entry<'_>; 3] = [
        ("y0", HEIGHT, 0.450_142_313_682_268_9),
        ("v0", SPEED, -0.141_809_661_286_059_85),
        ("e", &restitution, 1.533_332_326_975_341_5),
    ];
    thrown(lab, "(b) e=0.8", scene(0.8), 0.794_198_188_555_614_67, &part)
}

/// One number of each disc in turn.
fn each(param: fn(usize) -> Param) -> [[(Param, f64); 1]; 2] {
    [[(param(0), 1.0)], [(param(1), 1.0)]]
}

/// Derivatives of a disc's x by x1, x2, v1, v2, m1, m2, e, and by both radii if they are given.
fn discs(
    lab: &mut Lab<'_>,
    what: &str,
    (def, body): (SceneDef, usize),
    x: f64,
    exact: &[f64],
) -> Result<(), Stop> {
    let run = lab.run(&resolved(def, DT), 1.0)?;
    lab.fine(what, run.last().q[body].x, x, TOLERANCE);
    let [x1, x2] = each(|i| Param::Position(i, 0));
    let [v1, v2] = each(|i| Param::Velocity(i, 0));
    let [m1, m2] = each(Param::Mass);
    let [r1, r2] = each(|i| Param::Radius(i, 0));
    let e = by_restitution(0, 1);
    let directions: [(&str, Direction<'_>); 9] = [
        ("x1", &x1),
        ("x2", &x2),
        ("v1", &v1),
        ("v2", &v2),
        ("m1", &m1),
        ("m2", &m2),
        ("e", &e),
        ("r1", &r1),
        ("r2", &r2),
    ];
    let entry = |((by, direction), exact): ((_, _), &f64)| (by, direction, *exact);
    let entries: Vec<Entry<'_>> = directions.into_iter().zip(exact).map(entry).collect();
    table(lab, what, (&run, body, 0), &entries)
}

fn equal_discs(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let def = pursuit([[0.0, 1.0, 1.0, 0.1], [0.52, 0.0, 1.0, 0.1]], 1.0);
    discs(lab, "(c) x2", (def, 1), 1.2, &[1.0, 0.0, 1.0, 0.0, 0.34, -0.34, 0.34])
}

fn unequal_discs(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let def = pursuit([[0.0, 2.0, 1.0, 0.1], [1.2, -0.5, 3.0, 0.2]], 0.6);
    let first = [-0.2, 1.2, -0.2, 1.2, 0.48, -0.16, -1.2, -1.2, -1.2];
    discs(lab, "(d) x1", (def.clone(), 0), 0.08, &first)?;
    let second = [0.4, 0.6, 0.4, 0.6, 0.48, -0.16, 0.4, 0.4, 0.4];
    discs(lab, "(d) x2", (def, 1), 1.34, &second)
}
