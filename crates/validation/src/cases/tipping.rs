//! Blocks that tip, slide and rock, and a disc that climbs a step.

use tangency_bench::scenes::{curb, rocking_box, tipping_box};
use tangency_core::{SceneDef, State, StepRecord};

use super::contact_sums;
use crate::lab::recommended;
use crate::run::Run;
use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[
    Case {
        id: "V14",
        title: "Tip or slide",
        parts: &[Part::new("tips", tips), Part::new("slides", slides), Part::new("rests", rests)],
    },
    Case {
        id: "V17",
        title: "Rocking block and step",
        parts: &[Part::new("rocking block", rocks), Part::new("step", climbs)],
    },
];

const DT: f64 = 1e-6;
const BOX: usize = 1;

fn first_move(lab: &mut Lab<'_>, degrees: f64, friction: f64) -> Result<StepRecord, Stop> {
    lab.first_step(&SceneDef { dt: DT, ..tipping_box(degrees, friction) })
}

fn tips(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let record = first_move(lab, 25.0, 0.8)?;
    lab.near("tips, acceleration", -record.after.v[BOX].z / DT, 1.524_655_322_442_535_4, 1e-6);
    let (normal, friction) = contact_sums(&record);
    lab.near("tips, normal force", normal / DT, 9.043_344_923_073_789_7, 1e-6);
    lab.near("tips, friction", friction.abs() / DT, 3.764_721_317_065_627_6, 1e-6);
    let impulses = record.contact_impulses();
    let upper = impulses.iter().filter(|i| i.point.x < 0.0).map(|i| i.normal).sum::<f64>();
    lab.near("tips, force on the upper corner", upper / DT, 0.0, 1e-6);
    Ok(())
}

fn slides(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let after = first_move(lab, 25.0, 0.3)?.after;
    let (sin, cos) = 25.0_f64.to_radians().sin_cos();
    lab.near("slides, turning", after.v[BOX].z / DT, 0.0, 1e-6);
    lab.near("slides, acceleration", after.v[BOX].x / DT, 9.81 * (sin - 0.3 * cos), 1e-6);
    Ok(())
}

fn rests(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let after = first_move(lab, 20.0, 0.8)?.after;
    lab.near("rests, acceleration", after.v[BOX].norm() / DT, 0.0, 1e-6);
    Ok(())
}

const TILT: f64 = 0.160_875_277_198_321_07;
const IMPACTS: [f64; 3] =
    [0.273_858_974_782_351_64, 0.666_850_965_033_691_34, 0.973_757_194_456_258_35];
const SWINGS: [f64; 2] = [0.104_205_747_660_337_25, 0.071_016_325_324_556_807];
/// Of the box about a corner, m (w² + h²)/3.
const ABOUT_CORNER: f64 = 0.4 / 3.0;

fn rocking(lab: &mut Lab<'_>, def: &SceneDef) -> Result<Rocking, Stop> {
    Ok(Rocking::of(&lab.run(def, 1.1)?))
}

fn rocks(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for dt in [4e-3, 1e-3] {
        let found = rocking(lab, &SceneDef { dt, ..rocking_box(TILT) })?;
        for (name, got, exact) in found.figures() {
            lab.near(format!("(a) {name} at dt={dt}"), got, exact, 20.0 * dt);
        }
    }
    lab.order("(a) swing 1", 0.7, |lab, dt| {
        Ok(rocking(lab, &SceneDef { dt, ..rocking_box(TILT) })?.swings[0] - SWINGS[0])
    })?;
    let found = rocking(lab, &recommended(rocking_box(TILT)))?;
    for (name, got, exact) in found.figures() {
        lab.fine(format!("(a) {name}"), got, exact, 1e-4);
    }
    Ok(())
}

/// What a rocking block did; NaN for impacts that did not come.
struct Rocking {
    times: [f64; 3],
    ratios: [f64; 3],
    swings: [f64; 2],
}

impl Rocking {
    fn of(run: &Run) -> Self {
        let mut found = Self { times: [f64::NAN; 3], ratios: [f64::NAN; 3], swings: [f64::NAN; 2] };
        let (mut side, mut last) = (1.0, 0);
        for k in 0..3 {
            let crossed = |i: &usize| run.tape.state(*i).q[BOX].z * side < -1e-9;
            let end = run.tape.records.len() - 3;
            let Some(crossing) = (last..end).find(crossed) else { break };
            // States clear of the impact, which may take two steps.
            let [before, after] = [crossing - 3, crossing + 2].map(|i| run.tape.state(i));
            let v = before.v[BOX].z.abs();
            found.times[k] = before.time + before.q[BOX].z.abs() / v;
            found.ratios[k] = rate_at_impact(after) / rate_at_impact(before);
            if k > 0 {
                let tilts = (last..crossing).map(|i| run.tape.state(i).q[BOX].z.abs());
                found.swings[k - 1] = tilts.fold(0.0, f64::max);
            }
            (side, last) = (-side, crossing);
        }
        found
    }

    fn figures(&self) -> Vec<(String, f64, f64)> {
        let times = self.times.iter().zip(IMPACTS).enumerate();
        let mut all: Vec<_> =
            times.map(|(i, (t, exact))| (format!("impact {}", i + 1), *t, exact)).collect();
        let ratios = self.ratios.iter().enumerate();
        all.extend(ratios.map(|(i, r)| (format!("rate ratio {}", i + 1), *r, 0.85)));
        let swings = self.swings.iter().zip(SWINGS).enumerate();
        all.extend(swings.map(|(i, (s, exact))| (format!("swing {}", i + 1), *s, exact)));
        all
    }
}

/// Rate with which a box that pivots on a corner passes, or has passed, the upright pose:
/// ½ I ω² + m g (y − h/2) is constant.
fn rate_at_impact(state: &State) -> f64 {
    let raised = state.q[BOX].y - 0.3;
    (state.v[BOX].z.powi(2) + 2.0 * 9.81 * raised / ABOUT_CORNER).max(0.0).sqrt()
}

const DISC: usize = 2;

/// The disc strikes the step's corner after 0.2 s. It turns too fast for its weight to hold it there,
/// m ω² R > m g cos: for 11 ms it flies, and its rate is that after the impact.
const FLIES: f64 = 0.21;

fn climbs(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for dt in [1e-2, 1e-3] {
        let run = lab.run(&SceneDef { dt, ..curb() }, 0.7)?;
        let rolling = -run.at(0.15).v[DISC].z;
        lab.near(format!("(b) rate before the step at dt={dt}"), rolling, 7.5, 20.0 * dt);
        let turning = -run.at(FLIES).v[DISC].z;
        // The impact takes two plain steps, in each of which gravity turns the disc by 21.6 dt.
        let name = format!("(b) rate after the step at dt={dt}");
        lab.near(format!("{name}, C=50"), turning, 6.25, 50.0 * dt);
        let fine = lab.run(&SceneDef { dt, ..recommended(curb()) }, FLIES)?;
        lab.fine(format!("{name}, C=20"), -fine.last().v[DISC].z, 6.25, 20.0 * dt);
        let end = run.last().q[DISC];
        lab.holds(format!("(b) climbs at dt={dt}"), end.x > 0.0 && end.y > 0.25 - dt);
    }
    lab.order("(b) rate after the step", 0.7, |lab, dt| {
        Ok(lab.run(&SceneDef { dt, ..curb() }, FLIES)?.last().v[DISC].z + 6.25)
    })?;
    let run = lab.run(&recommended(curb()), FLIES)?;
    lab.fine("(b) rate after the step", -run.last().v[DISC].z, 6.25, 1e-4);
    Ok(())
}
