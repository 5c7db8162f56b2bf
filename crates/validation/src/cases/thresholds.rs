//! Structures that stand or fall by a little friction.

use nalgebra::Vector3;
use tangency_bench::scenes::{arch, gable};
use tangency_core::{SceneDef, State};

use super::standing::on_floor;
use crate::run::Run;
use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V21",
    title: "Sharp friction thresholds",
    parts: &[
        Part::new("gable stands", gable_stands),
        Part::new("gable opens", gable_opens),
        Part::new("arch stands", arch_stands),
        Part::new("arch falls", arch_falls),
    ],
}];

/// Greatest change of a pose.
fn moved(run: &Run) -> f64 {
    let start = &run.tape.initial.q;
    run.worst(|s: &State| {
        s.q.iter().zip(start).map(|(a, b): (&Vector3<f64>, _)| (a - b).norm()).fold(0.0, f64::max)
    })
}

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

fn arch_stands(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for (thickness, friction) in [(0.2, 0.35), (0.1, 1.0)] {
        let name = format!("t={thickness}, mu={friction}");
        let run = match lab.run(&SceneDef { dt: 0.01, ..arch(thickness, friction) }, 2.0) {
            Ok(run) => run,
            Err(stop) => {
                lab.stopped(&format!("(b) stands at {name}"), &stop);
                continue;
            }
        };
        lab.near(format!("(b) moved in 2 s at {name}"), moved(&run), 0.0, 1e-9);
        if friction < 1.0 {
            let floor = on_floor(run.end()) / run.scene.dt();
            lab.relative("(b) floor sum", floor, 5.958_959_273_040_5, 1e-9);
        }
    }
    Ok(())
}

fn arch_falls(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for (thickness, friction) in [(0.2, 0.25), (0.09, 1.0)] {
        let name = format!("(b) falls at t={thickness}, mu={friction}");
        match lab.run(&SceneDef { dt: 0.01, ..arch(thickness, friction) }, 2.0) {
            Ok(run) => lab.at_least(name, moved(&run), 1e-2),
            Err(stop) => lab.stopped(&name, &stop),
        }
    }
    Ok(())
}
