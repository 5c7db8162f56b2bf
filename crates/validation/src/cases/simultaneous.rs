//! Many impacts in one step.

use nalgebra::Vector3;
use tangency_bench::scenes::falling_discs;

use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V23",
    title: "Many impacts at once",
    parts: &[
        Part::new("row of touching discs", row),
        Part::new("column of touching discs", column),
        Part::new("separate discs", separate),
    ],
}];

fn row(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let record =
        lab.first_step(&falling_discs((0..100).map(|i| [f64::from(i) * 0.5, 0.25]), 0.5))?;
    let up = Vector3::new(0.0, 0.5, 0.0);
    let off = record.after.v[1..].iter().map(|v| (v - up).norm()).fold(0.0, f64::max);
    lab.near("row, worst velocity", off, 0.0, 1e-9);
    let impulses = record.contact_impulses();
    let sideways = impulses.iter().filter(|i| i.direction.y.abs() < 0.5).map(|i| i.normal);
    lab.near("row, greatest side impulse", sideways.fold(0.0, f64::max), 0.0, 1e-9);
    Ok(())
}

fn column(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let places = (0..50).map(|i| [0.0, 0.25 + f64::from(i) * 0.5]);
    let record = lab.first_step(&falling_discs(places, 1.0))?;
    let up = Vector3::new(0.0, 1.0, 0.0);
    let off = record.after.v[1..].iter().map(|v| (v - up).norm()).fold(0.0, f64::max);
    lab.near("column, worst velocity", off, 0.0, 1e-9);
    let impulses = record.contact_impulses();
    lab.near("column, contacts with an impulse", impulses.len() as f64, 50.0, 0.0);
    let floor = impulses.first().map_or(f64::NAN, |i| i.normal);
    lab.near("column, impulse at the floor", floor, 100.0, 1e-9);
    let wrong = |(k, i): (usize, &tangency_core::ContactImpulse)| {
        (i.normal - (100.0 - 2.0 * k as f64)).abs()
    };
    let worst = impulses.iter().enumerate().map(wrong).fold(0.0, f64::max);
    lab.near("column, worst impulse", worst, 0.0, 1e-9);
    Ok(())
}

fn separate(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for e in [0.0, 0.5, 1.0] {
        let def = falling_discs((0..1000).map(|i| [f64::from(i), 0.25]), e);
        let record = lab.first_step(&def)?;
        lab.near(format!("problems at e={e}"), record.islands.len() as f64, 1000.0, 0.0);
        let alone = Vector3::new(0.0, e, 0.0);
        let off = record.after.v[1..].iter().map(|v| (v - alone).norm()).fold(0.0, f64::max);
        lab.near(format!("separate at e={e}, worst velocity"), off, 0.0, 1e-9);
    }
    Ok(())
}
