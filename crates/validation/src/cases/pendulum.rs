//! A slender rod that swings from a pin.

use std::f64::consts::FRAC_PI_2;

use tangency_bench::scenes::{pendulum, slender_inertia};
use tangency_core::{Param, SceneDef, State};

use super::held_impulse;
use crate::lab::recommended;
use crate::run::{Run, Slope};
use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V02",
    title: "Large pendulum",
    parts: &[
        Part::new("motion", motion),
        Part::new("energy and hinge", energy_and_hinge),
        Part::new("derivatives", derivatives),
    ],
}];

const START: f64 = 2.5;
const PERIOD: f64 = 2.691_117_410_249_848_3;
/// Time, angle from hanging, rate.
const SWING: [(f64, f64, f64); 4] = [
    (1.0, -1.915_848_786_415_194_1, -3.690_945_067_870_187_3),
    (2.0, -0.133_402_730_266_384_21, 7.262_656_012_358_544_1),
    (5.0, 1.771_025_040_151_516_5, 4.210_014_428_916_753_4),
    (10.0, -0.654_178_341_806_721_17, 6.850_677_307_621_257_3),
];

/// J, zero at the pivot.
const ENERGY: f64 = 3.929_609_434_257_709_9;
/// Hinge force when passing the bottom, N.
const FORCE: f64 = 36.313_828_302_773_13;

fn swing(dt: f64) -> SceneDef {
    SceneDef { dt, ..pendulum(START) }
}

/// Angle of a rod from hanging; its own is zero along +x.
pub(super) fn angle(state: &State, rod: usize) -> f64 {
    state.q[rod].z + FRAC_PI_2
}

/// Time from rest to rest on the same side: the rate changes sign half-way and then again.
pub(super) fn period(run: &Run) -> f64 {
    run.crossings(|s| s.v[0].z).get(1).copied().unwrap_or(f64::NAN)
}

fn motion(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for dt in [4e-3, 1e-3] {
        let run = lab.run(&swing(dt), 10.0)?;
        for (t, exact, rate) in SWING {
            let tolerance = 2.5 * t * dt; // 5 dt at t = 2; the phase error grows with time
            lab.near(format!("angle({t}) at dt={dt}"), angle(run.at(t), 0), exact, tolerance);
            lab.near(format!("rate({t}) at dt={dt}"), run.at(t).v[0].z, rate, tolerance);
        }
        lab.near(format!("period at dt={dt}"), period(&run), PERIOD, 5.0 * dt);
    }
    lab.order("angle(2)", 0.9, |lab, dt| {
        Ok(angle(lab.run(&swing(dt), 2.0)?.last(), 0) - SWING[1].1)
    })?;
    let fine = lab.run(&recommended(pendulum(START)), 10.0)?;
    for (t, exact, rate) in SWING {
        lab.fine(format!("angle({t})"), angle(fine.at(t), 0), exact, 3e-5);
        lab.fine(format!("rate({t})"), fine.at(t).v[0].z, rate, 3e-4);
    }
    lab.fine("period", period(&fine), PERIOD, 3e-5);
    Ok(())
}

fn energy_and_hinge(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for dt in [4e-3, 1e-3] {
        let run = lab.run(&swing(dt), 10.0)?;
        lab.near(
            format!("energy at the start, dt={dt}"),
            run.scene.energy(&run.tape.initial),
            ENERGY,
            1e-12,
        );
        let [energy, drift] = defects(&run);
        lab.at_most(format!("energy error over 10 s at dt={dt}"), energy, 30.0 * dt);
        lab.at_most(format!("hinge gap at dt={dt}"), drift, 100.0 * dt * dt);
    }
    let force = hinge_force(&lab.run(&swing(1e-3), 1.0)?);
    lab.near("hinge force at the bottom", force, FORCE, 0.1);
    let fine = lab.run(&recommended(pendulum(START)), 10.0)?;
    let [energy, drift] = defects(&fine);
    lab.fine("energy error over 10 s", energy, 0.0, 1e-5);
    lab.fine("hinge gap", drift, 0.0, 1e-9);
    lab.fine("hinge force at the bottom, exact", hinge_force(&fine), FORCE, 1e-3);
    Ok(())
}

/// The worst errors of energy and hinge over a run.
fn defects(run: &Run) -> [f64; 2] {
    let energy = run.worst(|s| (run.scene.energy(s) - ENERGY).abs());
    [energy, run.worst(|s| run.scene.joint_drift(s))]
}

/// The hinge's greatest force, which is that at the bottom.
fn hinge_force(run: &Run) -> f64 {
    let force = |r| held_impulse(r, 0, 0).hypot(held_impulse(r, 0, 1)) / run.scene.dt();
    run.tape.records.iter().map(force).fold(0.0, f64::max)
}

fn derivatives(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let (sin, cos) = START.sin_cos();
    let start = [
        (Param::Position(0, 0), 0.5 * cos),
        (Param::Position(0, 1), 0.5 * sin),
        (Param::Position(0, 2), 1.0),
    ];
    // A longer rod: its end stays at the pivot and its inertia grows, at the same mass.
    let length = [
        (Param::Position(0, 0), 0.5 * sin),
        (Param::Position(0, 1), -0.5 * cos),
        (Param::AnchorB(0, 0), -0.5),
        (Param::Inertia(0), 2.0 * slender_inertia(1.0, 1.0)),
    ];
    let mass = [(Param::Mass(0), 1.0), (Param::Inertia(0), slender_inertia(1.0, 1.0))];
    let entries: [Slope<'_>; 4] = [
        ("(start angle)", &start, -8.067_354_362_055_703_3),
        ("L", &length, -7.262_656_012_358_544_1),
        ("g", &[(Param::Gravity(1), -1.0)], 0.740_331_907_477_935_18),
        ("m", &mass, 0.0),
    ];
    lab.slopes("angle(2)", (&pendulum(START), 2.0), |s| s.q[0].z = 1.0, &entries, 1e-3)
}
