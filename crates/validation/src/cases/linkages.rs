//! A parallelogram of many cranks: more hinges than it needs.

use nalgebra::DMatrix;
use tangency_bench::scenes::parallelogram;
use tangency_core::lcp::{Lcp, NO_BODY};
use tangency_core::{Param, SceneDef, State};

use super::pendulum::{angle, period};
use crate::lab::recommended;
use crate::run::Slope;
use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V12",
    title: "Parallelogram with n cranks",
    parts: &[
        Part::new("rows", rows),
        Part::new("motion", motion),
        Part::new("derivatives", derivatives),
    ],
}];

const START: f64 = 1.2;
const T: f64 = 3.0;

/// What n cranks do.
struct Cranks {
    n: usize,
    /// Angle from hanging and rate at T.
    state: [f64; 2],
    period: f64,
    /// d angle(T)/d(start).
    by_start: f64,
}

const CRANKS: [Cranks; 3] = [
    Cranks {
        n: 2,
        state: [-1.198_471_068_689_249_5, -0.183_141_405_264_788_92],
        period: 2.011_130_048_803_699_9,
        by_start: -0.909_438_091_648_851_21,
    },
    Cranks {
        n: 3,
        state: [-1.188_816_387_291_319_7, 0.505_051_320_546_056_0],
        period: 1.970_496_970_379_078_1,
        by_start: -1.238_721_895_752_345_6,
    },
    Cranks {
        n: 10,
        state: [-0.971_480_744_352_383_41, 2.340_929_034_461_865_0],
        period: 1.872_260_184_048_774_1,
        by_start: -1.973_172_767_755_530_8,
    },
];

fn scene(n: usize, dt: f64) -> SceneDef {
    SceneDef { dt, ..parallelogram(n, START) }
}

/// 4n rows, 3n + 2 of them independent: three for every crank and the coupler but for one.
fn rows(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for Cranks { n, .. } in CRANKS {
        let record = lab.first_step(&scene(n, 1e-3))?;
        let problem = &record.islands[0].problem;
        let (rows, rank) = (problem.rows.len(), jacobian(problem).rank(1e-9));
        lab.near(format!("hinge rows, n={n}"), rows as f64, 4.0 * n as f64, 0.0);
        lab.near(format!("rank of them, n={n}"), rank as f64, 3.0 * n as f64 + 2.0, 0.0);
    }
    Ok(())
}

/// All rows × 3 columns per body.
fn jacobian(problem: &Lcp) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(problem.rows.len(), 3 * problem.mass.len());
    for (i, row) in problem.rows.iter().enumerate() {
        for (body, block) in row.bodies.iter().zip(&row.jacobian).filter(|(b, _)| **b != NO_BODY) {
            let at = (i, 3 * *body as usize);
            matrix.fixed_view_mut::<1, 3>(at.0, at.1).copy_from(&block.transpose());
        }
    }
    matrix
}

/// The greatest difference between the angles of two cranks.
fn spread(state: &State, n: usize) -> f64 {
    (1..n).map(|i| (angle(state, i) - angle(state, 0)).abs()).fold(0.0, f64::max)
}

fn motion(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for Cranks { n, state: [exact, rate], period: lasts, .. } in CRANKS {
        for dt in [4e-3, 1e-3] {
            let run = lab.run(&scene(n, dt), T)?;
            lab.near(format!("angle(3), n={n}, dt={dt}"), angle(run.last(), 0), exact, 3.0 * dt);
            lab.near(format!("period, n={n}, dt={dt}"), period(&run), lasts, 3.0 * dt);
            let apart = run.worst(|s| spread(s, n));
            lab.near(format!("spread of the cranks, n={n}, dt={dt}"), apart, 0.0, 1e-9);
        }
        // The angle alone stands near its turning point, where the first order is nearly lost.
        lab.order(&format!("angle and rate, n={n}"), 0.9, |lab, dt| {
            let run = lab.run(&scene(n, dt), T)?;
            Ok((angle(run.last(), 0) - exact).hypot(run.last().v[0].z - rate))
        })?;
        let fine = lab.run(&recommended(scene(n, 1e-3)), T)?;
        lab.fine(format!("angle(3), n={n}"), angle(fine.last(), 0), exact, 1e-5);
        lab.fine(format!("period, n={n}"), period(&fine), lasts, 1e-5);
        lab.fine(format!("spread of the cranks, n={n}"), fine.worst(|s| spread(s, n)), 0.0, 1e-9);
    }
    Ok(())
}

/// All cranks turn about their pins; the coupler goes along.
fn by_start(n: usize) -> Vec<(Param, f64)> {
    let (sin, cos) = START.sin_cos();
    let moved = |body: usize, arm: f64| {
        [(Param::Position(body, 0), arm * cos), (Param::Position(body, 1), arm * sin)]
    };
    let turned = |i: usize| moved(i, 0.5).into_iter().chain([(Param::Position(i, 2), 1.0)]);
    (0..n).flat_map(turned).chain(moved(n, 1.0)).collect()
}

fn derivatives(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for Cranks { n, by_start: exact, .. } in CRANKS {
        let start = by_start(n);
        let entries: [Slope<'_>; 1] = [("(start)", &start, exact)];
        let what = format!("angle(3), n={n}");
        lab.slopes(&what, (&scene(n, 1e-3), T), |s| s.q[0].z = 1.0, &entries, 1e-3)?;
    }
    Ok(())
}
