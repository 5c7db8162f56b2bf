//! How derivatives grow along a motion: by impacts, linearly, and by an unstable rest.

use std::f64::consts::PI;

use tangency_bench::scenes::{between_discs, disc, material, pendulum, plane, unit_scene};
use tangency_core::{BodyDef, Param, SceneDef};

use crate::lab::{recommended, resolved};
use crate::run::Run;
use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V37",
    title: "Growth",
    parts: &[
        Part::new("(a) between discs", scatters),
        Part::new("(b) billiard", runs_straight),
        Part::new("(b) billiard for 100 s", runs_straight_for_long),
        Part::new("(c) balanced rod", balances),
    ],
}];

const DT: f64 = 0.01;

/// dy/d(y0 or vy0) of a body.
fn across(
    lab: &mut Lab<'_>,
    run: &Run,
    body: usize,
    param: fn(usize, usize) -> Param,
) -> Result<f64, Stop> {
    lab.slope(run, &run.pick(|s| s.q[body].y = 1.0), &[(param(body, 1), 1.0)])
}

fn scatters(lab: &mut Lab<'_>) -> Result<(), Stop> {
    const BALL: usize = 2;
    for (impacts, by_place, by_speed) in [
        (1.0, 3.0, 4.0),
        (2.0, 17.0, 24.0),
        (5.0, 3_363.0, 4_756.0),
        (10.0, 22_619_537.0, 31_988_856.0),
    ] {
        let run = lab.run(&recommended(between_discs()), 2.0 * impacts)?;
        let located = lab.run(&resolved(between_discs(), DT), 2.0 * impacts)?;
        let off = run.worst(|s| s.q[BALL].y.abs());
        lab.near(format!("(a) distance from the axis, n={impacts}"), off, 0.0, 1e-9);
        let speed = run.worst(|s| (s.v[BALL].x.abs() - 1.0).abs());
        lab.near(format!("(a) speed, n={impacts}"), 1.0 + speed, 1.0, 1e-12);
        for (what, param, exact) in
            [("y0", Param::Position as fn(_, _) -> _, by_place), ("vy0", Param::Velocity, by_speed)]
        {
            let slope = across(lab, &run, BALL, param)?;
            lab.relative(format!("(a) dy/d{what}, n={impacts}, at 1 ms"), slope, exact, 2e-2);
            let slope = across(lab, &located, BALL, param)?;
            lab.impact(format!("(a) dy/d{what}, n={impacts}"), slope, exact, 1e-6 * exact);
        }
    }
    Ok(())
}

/// V10: a disc in a box of 2 × 1, without loss.
fn billiard() -> SceneDef {
    let walls = [
        plane("floor", [0.0, 1.0], 0.0),
        plane("ceiling", [0.0, -1.0], -1.0),
        plane("left", [1.0, 0.0], 0.0),
        plane("right", [-1.0, 0.0], -2.0),
    ];
    let ball = BodyDef { velocity: [1.7, 1.1], ..disc("ball", 0.05, [0.3, 0.4]) };
    material(unit_scene("billiard", walls.into_iter().chain([ball]).collect()), 0.0, 1.0)
}

fn runs_straight(lab: &mut Lab<'_>) -> Result<(), Stop> {
    // 9 and 12 impacts.
    grows_linearly(lab, 10.0, [-1.0, 1.0])
}

fn runs_straight_for_long(lab: &mut Lab<'_>) -> Result<(), Stop> {
    // 89 and 122 impacts.
    grows_linearly(lab, 100.0, [-1.0, 1.0])
}

/// d/d(start) is ±1, d/d(velocity) ± the time.
fn grows_linearly(lab: &mut Lab<'_>, time: f64, signs: [f64; 2]) -> Result<(), Stop> {
    const BALL: usize = 4;
    let run = lab.run(&resolved(billiard(), DT), time)?;
    for (axis, (name, sign)) in ["x", "y"].iter().zip(signs).enumerate() {
        let seed = run.pick(|s| s.q[BALL][axis] = 1.0);
        let by_place = lab.slope(&run, &seed, &[(Param::Position(BALL, axis), 1.0)])?;
        lab.impact(format!("(b) d{name}({time})/d{name}0"), by_place, sign, 1e-6);
        let by_speed = lab.slope(&run, &seed, &[(Param::Velocity(BALL, axis), 1.0)])?;
        let exact = sign * time;
        lab.impact(format!("(b) d{name}({time})/dv{name}0"), by_speed, exact, 1e-6 * time);
    }
    Ok(())
}

/// The start turns about the hinge, above which the centre is: it moves by (−1/2, 0).
fn balances(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let turn = [(Param::Position(0, 2), 1.0), (Param::Position(0, 0), -0.5)];
    for (time, exact) in [(1.0, 23.180_975_940_156_936), (2.0, 1_073.715_291_076_269_5)] {
        let plain = lab.run(&SceneDef { dt: 1e-3, ..pendulum(PI) }, time)?;
        let start = plain.tape.initial.q[0].z;
        let tipped = plain.worst(|s| (s.q[0].z - start).abs());
        lab.near(format!("(c) tips by itself within {time} s"), tipped, 0.0, 1e-9);
        let seed = plain.pick(|s| s.q[0].z = 1.0);
        let slope = lab.slope(&plain, &seed, &turn)?;
        lab.relative(format!("(c) d angle({time})/d angle0 at 1 ms"), slope, exact, 2e-2);
        let fine = lab.run(&resolved(pendulum(PI), 1e-3), time)?;
        let slope = lab.slope(&fine, &seed, &turn)?;
        lab.fine_slope(format!("(c) d angle({time})/d angle0"), slope, exact, 1e-3);
    }
    Ok(())
}
