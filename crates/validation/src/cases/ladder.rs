//! A ladder that slides down until it leaves the wall.

use tangency_bench::scenes::ladder;
use tangency_core::{Param, SceneDef, State, StepRecord};

use crate::lab::recommended;
use crate::run::Run;
use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V11",
    title: "Sliding ladder",
    parts: &[Part::new("motion", motion), Part::new("derivative", derivative)],
}];

const WALL: u32 = 1;
const LADDER: usize = 2;
/// It has left the wall and not landed yet.
const T: f64 = 0.75;

const LEAVES: f64 = 0.597_527_806_071_165_34;
const ANGLE: f64 = 0.677_005_474_853_489_02;
const RATE: f64 = 2.146_902_956_576_025_7;
const SPEED: f64 = 1.344_952_577_225_293_9;

fn scene() -> SceneDef {
    SceneDef { dt: 1e-3, ..ladder(70.0_f64.to_radians()) }
}

fn wall_force(record: &StepRecord) -> f64 {
    let by_wall = |contact: usize| record.contacts[contact].feature.id.bodies.contains(&WALL);
    let impulses = record.contact_impulses();
    impulses.iter().filter(|i| by_wall(i.contact)).map(|i| i.normal).sum()
}

/// The state after the last step, or part of one, in which the wall pushes.
fn leaves(run: &Run) -> &State {
    let pushed = run.parts().rfind(|part| wall_force(part) > 0.0);
    pushed.map_or(&run.tape.initial, |part| &part.after)
}

fn motion(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let run = lab.run(&scene(), T)?;
    let State { time, q, v } = leaves(&run);
    // Angle and rate as well as the time tells them; the rate grows by (3 g/4) cos(angle).
    let growth = 0.75 * 9.81 * ANGLE.cos();
    lab.near("leaves the wall at", *time, LEAVES, 2e-2);
    lab.near("angle when it leaves", -q[LADDER].z, ANGLE, RATE * 2e-2);
    lab.near("rate when it leaves", v[LADDER].z, RATE, growth * 2e-2);
    lab.near("vx afterwards", run.last().v[LADDER].x, SPEED, 1e-3);
    lab.near("change of vx afterwards", run.last().v[LADDER].x, v[LADDER].x, 1e-12);

    let fine = lab.run(&recommended(scene()), T)?;
    let State { time, q, v } = leaves(&fine);
    lab.fine("leaves the wall at, exact", *time, LEAVES, 1e-5);
    lab.fine("angle when it leaves, exact", -q[LADDER].z, ANGLE, RATE * 1e-5);
    lab.fine("rate when it leaves, exact", v[LADDER].z, RATE, growth * 1e-5);
    lab.fine("vx afterwards, exact", fine.last().v[LADDER].x, SPEED, 1e-6);
    Ok(())
}

fn derivative(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let (sin, cos) = 70.0_f64.to_radians().sin_cos();
    let angle = [
        (Param::Position(LADDER, 0), -sin),
        (Param::Position(LADDER, 1), cos),
        (Param::Position(LADDER, 2), -1.0),
    ];
    // Plain stepping leaves the wall after whole steps, each of which adds 29 dt to this.
    let by_angle = |lab: &mut Lab<'_>, def: &SceneDef| {
        let run = lab.run(def, T)?;
        lab.slope(&run, &run.pick(|s| s.v[LADDER].x = 1.0), &angle)
    };
    let exact = 0.734_284_056_914_434_28;
    let found = by_angle(lab, &SceneDef { dt: 1e-4, ..scene() })?;
    lab.relative("dvx/d(angle) at dt=0.0001", found, exact, 2e-2);
    let found = by_angle(lab, &recommended(scene()))?;
    lab.fine_slope("dvx/d(angle)", found, exact, 1e-6);
    Ok(())
}
