//! Structures that stand or fall by a little friction.

use tangency_bench::scenes::{arch, gable};
use tangency_core::SceneDef;

use super::moved;
use super::standing::on_floor;
use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V21",
    title: "Sharp friction thresholds",
    parts: &[
        Part::new("gable stands", gable_stands),
        Part::new("gable opens", gable_opens),
        Part::new("gable begins to open", gable_begins_to_open),
        Part::new("arch stands", |lab| arch_stands(lab, 0.2, 0.35)),
        Part::new("arch's weight", arch_weighs),
        Part::new("arch falls", |lab| arch_falls(lab, 0.2, 0.25)),
        Part::new("thin arch stands", |lab| arch_stands(lab, 0.1, 1.0)),
        Part::new("thinner arch falls", |lab| arch_falls(lab, 0.09, 1.0)),
    ],
}];

/// The threshold is μ = 0.25992346256775801.
fn gable_stands(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for friction in [0.27, 0.259_924] {
        let run = lab.run(&SceneDef { dt: 0.01, ..gable(friction) }, 5.0)?;
        lab.near(format!("(a) moved in 5 s at mu={friction}"), moved(&run), 0.0, 1e-9);
    }
    Ok(())
}

fn gable_opens(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for dt in [1e-2, 1e-3] {
        let run = lab.run(&SceneDef { dt, ..gable(0.25) }, 0.05)?;
        for (name, leg, side) in [("left", 1, -1.0), ("right", 2, 1.0)] {
            let opened = side * (run.last().q[leg].z - run.tape.initial.q[leg].z);
            lab.at_least(format!("(a) {name} opens at mu=0.25, dt={dt}"), opened, 1e-4);
        }
    }
    Ok(())
}

fn gable_begins_to_open(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let dt = 1e-5;
    let record = lab.first_step(&SceneDef { dt, ..gable(0.2) })?;
    for (name, leg, side) in [("left", 1, -1.0), ("right", 2, 1.0)] {
        let rate = side * record.after.v[leg].z / dt;
        lab.near(format!("(a) {name} opens, mu=0.2"), rate, 1.824_471_967_912_395_9, 1e-4);
    }
    let record = lab.first_step(&SceneDef { dt, ..gable(0.259_923) })?;
    lab.at_least("(a) opens at mu=0.259923", record.after.v[2].z / dt, 1e-6);
    Ok(())
}

/// The threshold is μ = 0.29982669 at t = 0.2, and t = 0.09570345 at μ = 1.
fn arch_stands(lab: &mut Lab<'_>, thickness: f64, friction: f64) -> Result<(), Stop> {
    let run = lab.run(&SceneDef { dt: 0.01, ..arch(thickness, friction) }, 2.0)?;
    let name = format!("(b) moved in 2 s at t={thickness}, mu={friction}");
    lab.near(name, moved(&run), 0.0, 1e-9);
    Ok(())
}

fn arch_weighs(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let def = SceneDef { dt: 0.01, ..arch(0.2, 0.35) };
    let floor = on_floor(&lab.first_step(&def)?) / def.dt;
    lab.relative("(b) floor sum at t=0.2", floor, 5.958_959_273_040_5, 1e-9);
    Ok(())
}

fn arch_falls(lab: &mut Lab<'_>, thickness: f64, friction: f64) -> Result<(), Stop> {
    let run = lab.run(&SceneDef { dt: 0.01, ..arch(thickness, friction) }, 2.0)?;
    lab.at_least(format!("(b) falls at t={thickness}, mu={friction}"), moved(&run), 1e-2);
    Ok(())
}
