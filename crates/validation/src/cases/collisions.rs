//! Two bodies that collide once.

use nalgebra::Vector3;
use tangency_bench::scenes::{head_on, line_collision, oblique_collision, rod_hit, spinning_disc};
use tangency_core::{Param, SceneDef, State};

use crate::lab::recommended;
use crate::run::{Run, Slope, by_restitution};
use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V09",
    title: "Exact collisions",
    parts: &[
        Part::new("(a) on a line", line),
        Part::new("(b) oblique", oblique),
        Part::new("(b) derivatives", oblique_derivatives),
        Part::new("(c) spinning disc on a floor", spinning),
        Part::new("(d) rod struck by a disc", rod),
        Part::new("(e) head-on with spin", spinning_head_on),
    ],
}];

/// Velocities after one step of a scene that begins in contact, at several time steps.
fn check(lab: &mut Lab<'_>, what: &str, def: &SceneDef, expected: &[[f64; 3]]) -> Result<(), Stop> {
    for dt in [1e-4, 1e-2, 0.1] {
        let run = lab.run_steps(&SceneDef { dt, ..def.clone() }, 1)?;
        let moving = (0..run.scene.bodies().len()).filter(|i| run.scene.is_dynamic(*i));
        for (body, exact) in moving.zip(expected) {
            let name = &run.scene.bodies()[body].name;
            for (axis, (axis_name, exact)) in ["vx", "vy", "w"].iter().zip(exact).enumerate() {
                let found = run.last().v[body][axis];
                lab.near(format!("{what} {name} {axis_name}, dt={dt}"), found, *exact, 1e-10);
            }
        }
    }
    Ok(())
}

fn line(lab: &mut Lab<'_>) -> Result<(), Stop> {
    check(lab, "(a)", &line_collision(), &[[-0.5, 0.0, 0.0], [2.0, 0.0, 0.0]])?;
    let run = lab.run_steps(&line_collision(), 1)?;
    let seed = run.pick(|s| s.v[0].x = 1.0);
    let entries: [Slope<'_>; 5] = [
        ("m1", &[(Param::Mass(0), 1.0)], 0.9),
        ("m2", &[(Param::Mass(1), 1.0)], -0.6),
        ("e", &by_restitution(0, 1), -3.0),
        ("v1", &[(Param::Velocity(0, 0), 1.0)], 0.1),
        ("v2", &[(Param::Velocity(1, 0), 1.0)], 0.9),
    ];
    for (by, direction, exact) in entries {
        let found = lab.slope(&run, &seed, direction)?;
        lab.near(format!("(a) d(first)/d{by}"), found, exact, 1e-10);
    }
    Ok(())
}

const SIN_60: f64 = 0.866_025_403_784_438_65;
const IMPACT: f64 = 0.413_397_459_621_556_14;
/// The other disc at T = 1.
const OTHER: [f64; 2] = [1.879_903_810_567_665_8, 0.608_012_701_892_219_32];
/// The first disc at T = 1: it goes on from (2 IMPACT, 0).
const FIRST: [f64; 2] = [2.0 * IMPACT + 0.5 * (1.0 - IMPACT), -SIN_60 * (1.0 - IMPACT)];

fn apart() -> SceneDef {
    oblique_collision(0.0, [1.0, 0.1])
}

/// Distance of a disc from where it should be.
fn miss(state: &State, disc: usize, [x, y]: [f64; 2]) -> f64 {
    (state.q[disc].x - x).hypot(state.q[disc].y - y)
}

/// End of the first step in which a contact acts.
fn first_impact(run: &Run) -> f64 {
    let acts = run.parts().find(|part| super::contact_sums(part).0 > 0.0);
    acts.map_or(f64::NAN, |record| record.after.time)
}

fn oblique(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let (sin, cos) = 30.0_f64.to_radians().sin_cos();
    let touching = oblique_collision(1.0 - 0.2 * cos, [1.0, 0.2 * sin]);
    check(lab, "(b)", &touching, &[[0.5, -SIN_60, 0.0], [1.5, SIN_60, 0.0]])?;
    for dt in [1e-2, 1e-3] {
        let run = lab.run(&SceneDef { dt, ..apart() }, 1.0)?;
        for (disc, exact) in [FIRST, OTHER].into_iter().enumerate() {
            let found = miss(run.last(), disc, exact);
            lab.near(format!("(b) miss of disc {disc} at T=1, dt={dt}"), found, 0.0, 5.0 * dt);
        }
        let time = first_impact(&run);
        lab.near(format!("(b) time of impact, dt={dt}"), time, IMPACT, 5.0 * dt);
    }
    lab.order("(b) other at T=1", 0.7, |lab, dt| {
        Ok(miss(lab.run(&SceneDef { dt, ..apart() }, 1.0)?.last(), 1, OTHER))
    })?;
    let fine = lab.run(&recommended(apart()), 1.0)?;
    lab.fine("(b) time of impact", first_impact(&fine), IMPACT, 1e-9);
    for (disc, q, v) in [(0, FIRST, [0.5, -SIN_60]), (1, OTHER, [1.5, SIN_60])] {
        for (axis, name) in ["x", "y"].iter().enumerate() {
            let State { q: at, v: moves, .. } = fine.last();
            lab.fine(format!("(b) {name} of disc {disc} at T=1"), at[disc][axis], q[axis], 1e-9);
            lab.fine(format!("(b) v{name} of disc {disc}"), moves[disc][axis], v[axis], 1e-9);
        }
    }
    Ok(())
}

/// The other disc at T = 1. Restitution and mass leave the time of impact alone, so that plain
/// stepping has their derivatives; impact parameter and speed do not.
fn oblique_derivatives(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let fine = lab.run(&recommended(apart()), 1.0)?;
    let (offset, speed) = ([(Param::Position(1, 1), 1.0)], [(Param::Velocity(0, 0), 1.0)]);
    for (by, direction, exact) in [
        ("b", &offset, [-6.299_038_105_676_658, 4.136_751_345_948_128_8]),
        ("v", &speed, [0.75, 0.433_012_701_892_219_32]),
    ] {
        for (axis, name) in ["x", "y"].iter().enumerate() {
            let seed = fine.pick(|s| s.q[1][axis] = 1.0);
            let found = lab.slope(&fine, &seed, direction)?;
            lab.impact(
                format!("d/d{by} of {name} of disc 1 at T=1 in (b)"),
                found,
                exact[axis],
                1e-6 * exact[axis].abs(),
            );
        }
    }
    let after = [0.439_951_905_283_832_90, 0.254_006_350_946_109_66];
    let (e, mass) = (by_restitution(0, 1), [(Param::Mass(1), 1.0)]);
    for (axis, name) in ["x", "y"].iter().enumerate() {
        let entries: [Slope<'_>; 2] = [("e", &e, after[axis]), ("m", &mass, -after[axis])];
        let what = format!("{name} of disc 1 at T=1 in (b)");
        lab.slopes(&what, (&apart(), 1.0), |s| s.q[1][axis] = 1.0, &entries, 1e-6)?;
    }
    Ok(())
}

fn spinning(lab: &mut Lab<'_>) -> Result<(), Stop> {
    check(lab, "(c) mu=0.1", &spinning_disc(0.1), &[[2.36, 2.4, -2.8]])?;
    check(lab, "(c) mu=0.5", &spinning_disc(0.5), &[[5.0 / 3.0, 2.4, -50.0 / 3.0]])
}

fn rod(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let rod = [0.0, -0.736_994_219_653_179_19, -3.537_572_254_335_260_1];
    check(lab, "(d)", &rod_hit(), &[rod, [0.0, -0.052_023_121_387_283_237, 0.0]])?;
    let impulse = super::contact_sums(&lab.first_step(&rod_hit())?).0;
    lab.near("(d) impulse", impulse, 1.473_988_439_306_358_4, 1e-10);
    Ok(())
}

fn spinning_head_on(lab: &mut Lab<'_>) -> Result<(), Stop> {
    check(lab, "(e)", &head_on(0.3), &[[0.0, -0.6, 18.0], [1.0, 0.3, -4.0]])?;
    let sticks = slip(&lab.first_step(&head_on(0.333_334))?.after.v);
    lab.near("(e) slip at mu=0.333334", sticks, 0.0, 1e-10);
    // The slip is 3 − 9 mu up to mu = 1/3.
    let slides = slip(&lab.first_step(&head_on(0.333_333))?.after.v);
    lab.near("(e) slip at mu=0.333333", slides, 3.0 - 9.0 * 0.333_333, 1e-10);
    Ok(())
}

/// Tangential speed of the first disc's surface past the second's.
fn slip(v: &[Vector3<f64>]) -> f64 {
    v[0].y + 0.1 * v[0].z - v[1].y + 0.15 * v[1].z
}
