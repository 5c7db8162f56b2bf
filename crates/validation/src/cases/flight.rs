//! Bodies that touch nothing.

use nalgebra::Vector3;
use tangency_bench::scenes::free_flight;
use tangency_core::{Param, SceneDef};

use crate::lab::recommended;
use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V01",
    title: "Free flight with spin",
    parts: &[Part::new("motion", motion), Part::new("derivatives", derivatives)],
}];

const T: f64 = 1.5;
/// What semi-implicit steps add: g T dt/2 in y at 1 ms.
const LAG: f64 = 7.357_5e-3;

fn flight() -> SceneDef {
    SceneDef { dt: 1e-3, ..free_flight() }
}

fn motion(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let run = lab.run(&flight(), T)?;
    let (q, v) = (run.last().q[0], run.last().v[0]);
    lab.near("x", q.x, 4.5, 1e-12);
    lab.near("y, less g T dt/2", q.y + LAG, -4.036_25, 1e-12);
    lab.near("angle", q.z, -10.3, 1e-12);
    lab.near("vy", v.y, -10.715, 1e-12);
    let solved = run.tape.records.iter().map(|record| record.islands.len()).sum::<usize>();
    lab.near("problems solved", solved as f64, 0.0, 0.0);
    let fine = lab.run(&recommended(free_flight()), T)?;
    lab.fine("y", fine.last().q[0].y, -4.036_25, 1e-12);
    Ok(())
}

fn derivatives(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let run = lab.run(&flight(), T)?;
    let by = |lab: &mut Lab<'_>, axis: usize, param| {
        let seed = run.pick(|s| s.q[0][axis] = 1.0);
        lab.slope(&run, &seed, &[(param, 1.0)])
    };
    let (x, y) = (by(lab, 0, Param::Velocity(0, 0))?, by(lab, 1, Param::Velocity(0, 1))?);
    lab.near("dx/dvx", x, 1.5, 1e-12);
    lab.near("dy/dvy", y, 1.5, 1e-12);
    let by_gravity = -by(lab, 1, Param::Gravity(1))?;
    lab.near("dy/dg, less T dt/2", by_gravity + 7.5e-4, -1.125, 1e-12);
    let fine = lab.run(&recommended(free_flight()), T)?;
    let seed = fine.pick(|s| s.q[0].y = 1.0);
    let by_gravity = lab.slope(&fine, &seed, &[(Param::Gravity(1), -1.0)])?;
    lab.fine_slope("dy/dg", by_gravity, -1.125, 1e-6);
    let mut worst = 0.0_f64;
    for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
        let seed = run.pick(|s| (s.q[0], s.v[0]) = (axis, axis));
        worst = worst.max(lab.slope(&run, &seed, &[(Param::Mass(0), 1.0)])?.abs());
    }
    lab.near("greatest d/dm", worst, 0.0, 0.0);
    Ok(())
}
