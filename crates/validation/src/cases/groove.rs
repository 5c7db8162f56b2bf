//! A spinning disc in a groove.

use tangency_bench::scenes::groove;
use tangency_core::{Param, SceneDef};

use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V18",
    title: "Disc in a groove",
    parts: &[
        Part::new("spins down", spins_down),
        Part::new("comes to rest", comes_to_rest),
        Part::new("climbs", climbs),
        Part::new("derivative", derivative),
    ],
}];

const DISC: usize = 2;

fn scene(friction: f64, dt: f64) -> SceneDef {
    SceneDef { dt, ..groove(friction) }
}

fn spins_down(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for dt in [1e-2, 1e-3, 1e-4] {
        let run = lab.run(&scene(0.3, dt), 0.3)?;
        let first = &run.tape.records[0];
        let slowing = (20.0 - first.after.v[DISC].z) / dt;
        lab.near(format!("deceleration at dt={dt}"), slowing, 38.183_766_184_073_566, 1e-9);
        let mut forces: Vec<f64> = first.contact_impulses().iter().map(|i| i.normal / dt).collect();
        forces.sort_by(|a, b| b.total_cmp(a));
        forces.resize(2, f64::NAN);
        lab.near(format!("greater force at dt={dt}"), forces[0], 8.273_149_339_882_605, 1e-9);
        lab.near(format!("lesser force at dt={dt}"), forces[1], 4.454_772_721_475_249, 1e-9);
        lab.near(format!("w(0.3) at dt={dt}"), run.last().v[DISC].z, 8.544_870_144_777_93, 1e-9);
    }
    Ok(())
}

fn comes_to_rest(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for dt in [1e-2, 1e-3] {
        let run = lab.run(&scene(0.3, dt), 0.6)?;
        let first = run.first(|s| s.v[DISC].norm() <= 1e-9).unwrap_or(usize::MAX);
        let time = first as f64 * dt;
        lab.near(format!("at rest after, at dt={dt}"), time, 0.523_782_800_878_924_09, dt);
        let start = run.tape.initial.q[DISC].xy();
        let moved = run.worst(|s| (s.q[DISC].xy() - start).norm());
        lab.near(format!("centre moved at dt={dt}"), moved, 0.0, 1e-9);
    }
    Ok(())
}

/// With μ > 1 the groove can also wedge the disc: f₁ + f₂ = I ω/R and |N₁ − N₂| = f₁ + f₂ balance it
/// on a whole ray of impulses, at any dt. Either solution is right, and always the same one.
fn climbs(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for dt in [1e-2, 1e-3, 1e-4] {
        let record = lab.first_step(&scene(1.2, dt))?;
        let normals: Vec<f64> = record.contact_impulses().iter().map(|i| i.normal).collect();
        let pressed = normals.iter().filter(|normal| **normal > 1e-9 * dt).count();
        let (v, r) = (record.after.v[DISC], 0.2);
        if pressed == 2 {
            let spin = 20.0 * 0.5 * r; // I ω/R of 1 kg
            let apart = (normals[0] - normals[1]).abs();
            lab.near(format!("wedged at dt={dt}: speed"), v.norm(), 0.0, 1e-9);
            lab.near(format!("wedged at dt={dt}: |N1 - N2|"), apart, spin, 1e-9);
        } else {
            let acceleration = v.xy().norm() / dt;
            lab.near(format!("climbs at dt={dt}"), acceleration, 1.387_343_504_688_006_3, 1e-9);
            lab.at_least(format!("upwards at dt={dt}"), v.y, 0.0);
        }
        let again = lab.first_step(&scene(1.2, dt))?;
        lab.holds(format!("the same answer again at dt={dt}"), again == record);
    }
    Ok(())
}

fn derivative(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let run = lab.run(&scene(0.3, 1e-3), 0.3)?;
    let seed = run.pick(|s| s.v[DISC].z = 1.0);
    let friction = [0, 1, DISC].map(|body| (Param::Friction(body), 1.0));
    let found = lab.slope(&run, &seed, &friction)?;
    lab.relative("dw(0.3)/dmu", found, -31.878_190_116_978_8, 2e-2);
    lab.fine_slope("dw(0.3)/dmu, exact", found, -31.878_190_116_978_8, 1e-6);
    Ok(())
}
