//! Nearly parallel rows, and steps of every size.

use nalgebra::Vector3;
use tangency_bench::scenes::{clamped_rod, incline_block, shallow_hollow, sliding_box, stack};
use tangency_core::SceneDef;

use super::moved;
use crate::run::Run;
use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V26",
    title: "Nearly parallel rows, extreme steps",
    parts: &[
        Part::new("shallow hollow", hollow),
        Part::new("clamped rod", clamped),
        Part::new("at rest, any step", rests),
        Part::new("a step of 2 s", long_step),
    ],
}];

const G: f64 = 9.81;

/// Greatest speed of any body at any time.
fn speed(run: &Run) -> f64 {
    run.worst(|s| s.v.iter().map(Vector3::norm).fold(0.0, f64::max))
}

/// A rounding δ of a row moves the difference of the two forces by δ/slope², so that their sum is
/// asked to the last digits and each of them is not.
fn hollow(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for slope in [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10_f64] {
        let run = lab.run(&shallow_hollow(slope), 1.0)?;
        rests_in_hollow(lab, slope, &run);
    }
    Ok(())
}

fn rests_in_hollow(lab: &mut Lab<'_>, slope: f64, run: &Run) {
    let exact = G / (2.0 * slope.cos());
    let impulses = run.end().contact_impulses();
    let mut forces: Vec<f64> = impulses.iter().map(|i| i.normal / run.scene.dt()).collect();
    forces.resize(2, f64::NAN);
    for (name, force) in ["left", "right"].iter().zip(&forces) {
        lab.relative(format!("{name} force at slope {slope:e}"), *force, exact, 1e-6);
    }
    let sum = forces[0] + forces[1];
    lab.relative(format!("sum of forces at slope {slope:e}"), sum, 2.0 * exact, 1e-9);
    lab.near(format!("speed at slope {slope:e}"), speed(run), 0.0, 1e-9);
}

fn clamped(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let run = lab.run(&clamped_rod(1e-8), 1.0)?;
    lab.near("clamped rod, speed", speed(&run), 0.0, 1e-9);
    lab.near("clamped rod, moved", moved(&run), 0.0, 1e-9);
    Ok(())
}

fn rests(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for dt in [1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0] {
        for (name, def) in [
            ("stack of five", stack(&[1.0; 5])),
            ("block on a slope", incline_block(30.0_f64.to_radians(), 0.7, 0.0)),
        ] {
            let run = lab.run_steps(&SceneDef { dt, ..def }, 100)?;
            lab.near(format!("{name} moved at dt={dt:e}"), moved(&run), 0.0, 1e-9);
            lab.near(format!("{name}, speed at dt={dt:e}"), speed(&run), 0.0, 1e-9);
        }
    }
    Ok(())
}

fn long_step(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let run = lab.run_steps(&SceneDef { dt: 2.0, ..sliding_box(1.0, 0.3, 3.0) }, 1)?;
    let after = run.last();
    lab.near("speed after a step of 2 s", after.v[1].norm(), 0.0, 1e-12);
    lab.at_least("not reversed", after.v[1].x, -1e-12);
    lab.at_least("not moved back", after.q[1].x, -1e-12);
    Ok(())
}
