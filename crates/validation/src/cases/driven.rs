//! A spool that is pulled and a box on a belt.

use tangency_bench::scenes::{conveyor, spool};
use tangency_core::{Param, SceneDef, State};

use crate::lab::recommended;
use crate::run::{Run, Slope, by_friction};
use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V15",
    title: "Spool and conveyor",
    parts: &[
        Part::new("spool", pulled),
        Part::new("conveyor", rides),
        Part::new("conveyor, derivatives", derivatives),
    ],
}];

const SPOOL: usize = 1;
const BOX: usize = 1;
/// Angle of the pull in degrees, and the acceleration.
const PULLS: [(f64, f64); 4] =
    [(0.0, 1.0), (40.0, 0.649_066_664_678_467_05), (90.0, -0.5), (70.528_779_365_509_309, 0.0)];
const RIDES_FROM: f64 = 0.509_683_995_922_528_03;
const RIDDEN: f64 = 1.490_316_004_077_472;

fn pulled(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for (degrees, exact) in PULLS {
        for dt in [1e-2, 1e-3] {
            let def = SceneDef { dt, ..spool(degrees.to_radians()) };
            let found = lab.run(&def, 1.0)?.last().v[SPOOL].x;
            lab.near(format!("(a) {degrees} deg at dt={dt}"), found, exact, dt);
        }
        let fine = lab.run(&recommended(spool(degrees.to_radians())), 1.0)?;
        lab.fine(format!("(a) {degrees} deg"), fine.last().v[SPOOL].x, exact, 1e-10);
    }
    Ok(())
}

fn belt(dt: f64) -> SceneDef {
    SceneDef { dt, ..conveyor() }
}

fn slides(state: &State) -> bool {
    (state.v[BOX].x - 2.0).abs() > 1e-9
}

fn rides(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for dt in [1e-2, 1e-3] {
        let run = lab.run(&belt(dt), 1.0)?;
        let first = run.first(|state| !slides(state)).unwrap_or(usize::MAX);
        let time = first as f64 * dt;
        lab.near(format!("(b) rides along from, at dt={dt}"), time, RIDES_FROM, 2.0 * dt);
        lab.near(format!("(b) x(1) at dt={dt}"), run.last().q[BOX].x, RIDDEN, 2.0 * dt);
    }
    lab.order("(b) x(1)", 0.9, |lab, dt| Ok(lab.run(&belt(dt), 1.0)?.last().q[BOX].x - RIDDEN))?;
    let fine = lab.run(&recommended(conveyor()), 1.0)?;
    lab.fine("(b) rides along from", ride_time(&fine), RIDES_FROM, 1e-5);
    lab.fine("(b) x(1)", fine.last().q[BOX].x, RIDDEN, 1e-5);
    Ok(())
}

/// When the box reaches the belt's speed, by the line through two of the last sliding states.
fn ride_time(run: &Run) -> f64 {
    let Some(k) = run.first(|state| !slides(state)) else { return f64::NAN };
    let [a, b] = [k - 3, k - 2].map(|i| run.tape.state(i));
    let acceleration = (b.v[BOX].x - a.v[BOX].x) / (b.time - a.time);
    b.time + (2.0 - b.v[BOX].x) / acceleration
}

fn derivatives(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let friction = by_friction(0, BOX);
    let entries: [Slope<'_>; 2] = [
        ("mu", &friction, 1.274_209_989_806_320_1),
        ("(belt)", &[(Param::Velocity(0, 0), 1.0)], 0.490_316_004_077_471_97),
    ];
    lab.slopes("(b) x", (&conveyor(), 1.0), |s| s.q[BOX].x = 1.0, &entries, 1e-6)
}
