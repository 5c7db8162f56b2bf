//! Contacts that just touch, deflect by little or much, or just stop.

use tangency_bench::scenes::{grazing_disc, oblique_collision, unit_slider};
use tangency_core::Param;

use crate::lab::recommended;
use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V24",
    title: "Grazing and weakly active",
    parts: &[
        Part::new("passes the floor", passes),
        Part::new("deflection", deflection),
        Part::new("deflection after flight", deflection_after_flight),
        Part::new("just stops", just_stops),
    ],
}];

fn passes(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for gap in [0.0, 1e-12, -1e-12] {
        let run = lab.run_steps(&grazing_disc(gap), 20)?;
        let impulses =
            run.tape.records.iter().flat_map(tangency_core::StepRecord::contact_impulses);
        let worst = impulses.map(|i| i.normal).fold(0.0, f64::max);
        lab.near(format!("impulse at gap {gap:e}"), worst, 0.0, 1e-9);
    }
    Ok(())
}

/// q, the impact parameter b over 2 r, and dv₁y/db = −10 (1 − 2q²)/√(1 − q²).
const DEFLECTIONS: [(f64, f64); 3] = [
    (0.5, -5.773_502_691_896_257_6),
    (0.9, 14.223_775_499_974_829),
    (0.99, 68.066_773_304_900_413),
];

/// The discs touch at the start and are kept in touch as b changes.
fn deflection(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for (q, exact) in DEFLECTIONS {
        let depth = (1.0 - q * q).sqrt();
        let run = lab.run_steps(&oblique_collision(0.0, [0.2 * depth, 0.2 * q]), 1)?;
        let seed = run.pick(|s| s.v[0].y = 1.0);
        let direction = [(Param::Position(1, 0), -q / depth), (Param::Position(1, 1), 1.0)];
        let found = lab.slope(&run, &seed, &direction)?;
        lab.relative(format!("dv1y/db at q={q}"), found, exact, 1e-9);
    }
    Ok(())
}

/// The first disc flies to the other, so that the time of impact changes with b.
fn deflection_after_flight(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for (q, exact) in DEFLECTIONS {
        let run = lab.run(&recommended(oblique_collision(0.0, [1.0, 0.2 * q])), 1.0)?;
        let seed = run.pick(|s| s.v[0].y = 1.0);
        let found = lab.slope(&run, &seed, &[(Param::Position(1, 1), 1.0)])?;
        lab.impact(format!("dv1y/db at q={q}, after flight"), found, exact, 1e-6 * exact.abs());
    }
    Ok(())
}

/// Friction takes exactly the speed that is there.
fn just_stops(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let run = lab.run_steps(&unit_slider(0.05), 1)?;
    lab.near("speed of the box that just stops", run.last().v[1].norm(), 0.0, 1e-12);
    let seed = run.pick(|s| s.v[1].x = 1.0);
    let by_speed = lab.slope(&run, &seed, &[(Param::Velocity(1, 0), 1.0)])?;
    lab.at_least("d(speed)/d(speed before)", by_speed, 0.0);
    lab.at_most("d(speed)/d(speed before), at most", by_speed, 1.0);
    let report = run.gradient(&seed)?.report;
    lab.holds("the report names the switch", !report.one_sided.is_empty());
    Ok(())
}
