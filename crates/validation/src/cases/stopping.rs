//! Bodies that friction stops, and the derivatives of where.

use nalgebra::Vector3;
use tangency_bench::scenes::sliding_box;
use tangency_core::{ForceDef, Param, SceneDef};
use tangency_diff::lcp::lcp_vjp;
use tangency_diff::{DiffError, GradientMode};
use tangency_lcp::{Law, Lcp, NO_BODY, Row, Scratch, solve_checked};

use crate::lab::recommended;
use crate::run::{Direction, by_friction};
use crate::{Case, Grade, Lab, Part, Relation, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V35",
    title: "Friction, landing, sticking",
    parts: &[
        Part::new("(a) sums of semi-implicit steps", sums),
        Part::new("(a) stop", stops),
        Part::new("(b) pushed at its centre", pushed),
        Part::new("(c) slope at the angle of friction", on_the_verge),
        Part::new("(d) central path", central_path),
    ],
}];

const BLOCK: usize = 1;
const STOP: f64 = 1.529_051_987_767_584_1;
const BY_SPEED: f64 = 1.019_367_991_845_056_1;
const BY_FRICTION: f64 = -5.096_839_959_225_280_3;

fn slide(dt: f64) -> SceneDef {
    SceneDef { dt, ..sliding_box(1.5, 0.3, 3.0) }
}

/// Name, direction and exact derivative.
type Entry = (&'static str, Vec<(Param, f64)>, f64);

/// What the block's x is differentiated by.
fn directions() -> [Entry; 3] {
    [
        ("v0", vec![(Param::Velocity(BLOCK, 0), 1.0)], BY_SPEED),
        ("mu", by_friction(0, BLOCK).to_vec(), BY_FRICTION),
        ("m", vec![(Param::Mass(BLOCK), 1.0)], 0.0),
    ]
}

/// x after a duration and its derivative along a direction.
fn way(
    lab: &mut Lab<'_>,
    def: &SceneDef,
    duration: f64,
    direction: Direction<'_>,
) -> Result<[f64; 2], Stop> {
    let run = lab.run(def, duration)?;
    let slope = lab.slope(&run, &run.pick(|s| s.q[BLOCK].x = 1.0), direction)?;
    Ok([run.last().q[BLOCK].x, slope])
}

/// The sums that steps of 0.01 s make, exactly: a wrong adjoint shows at once.
fn sums(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let exact = [1.01, -5.053_131, 0.0];
    for ((what, direction, _), exact) in directions().iter().zip(exact) {
        let [x, slope] = way(lab, &slide(0.01), 1.2, direction)?;
        lab.near("(a) stop at dt=0.01", x, 1.514_060_7, 1e-10);
        lab.near(format!("(a) dx/d{what} at dt=0.01"), slope, exact, 1e-10);
    }
    Ok(())
}

fn stops(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for (what, direction, exact) in &directions() {
        let [_, slope] = way(lab, &slide(1e-3), 1.2, direction)?;
        let tolerance = 2e-2 * exact.abs();
        lab.near(format!("(a) dx/d{what} at dt=0.001"), slope, *exact, tolerance.max(1e-12));
        let [x, slope] = way(lab, &recommended(slide(1e-3)), 1.2, direction)?;
        lab.fine(format!("(a) stop, with d/d{what}"), x, STOP, 1e-5);
        lab.fine_slope(format!("(a) dx/d{what}"), slope, *exact, 1e-6);
    }
    lab.order("(a) stop", 0.9, |lab, dt| Ok(lab.run(&slide(dt), 1.2)?.last().q[BLOCK].x - STOP))?;
    // The stop falls between two steps: the exact sum −g dt² K(K+1)/2 is off by a saw-tooth,
    // g T dt (θ − 1/2) with θ the part of a step that is left over.
    lab.order("(a) dx/dmu", 0.7, |lab, dt| {
        Ok(way(lab, &slide(dt), 1.2, &by_friction(0, BLOCK))?[1] - BY_FRICTION)
    })
}

fn push(force: f64, dt: f64) -> SceneDef {
    let push = ForceDef { body: "block".into(), force: [force, 0.0], ..ForceDef::default() };
    SceneDef { dt, forces: vec![push], ..sliding_box(1.5, 0.5, 0.0) }
}

fn pushed(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let by = |param| vec![(param, 1.0)];
    let held = [
        ("F", by(Param::Force(0, 0))),
        ("mu", by_friction(0, BLOCK).to_vec()),
        ("m", by(Param::Mass(BLOCK))),
        ("gy", by(Param::Gravity(1))),
        ("v0", by(Param::Velocity(BLOCK, 0))),
    ];
    for (what, direction) in held {
        let [x, slope] = way(lab, &push(4.0, 1e-2), 0.8, &direction)?;
        lab.near(format!("(b) 4 N, x, with d/d{what}"), x, 0.0, 1e-12);
        lab.near(format!("(b) 4 N, dx/d{what}"), slope, 0.0, 1e-12);
    }
    let moved = [
        ("F", by(Param::Force(0, 0)), 0.213_333_333_333_333_33),
        ("mu", by_friction(0, BLOCK).to_vec(), -3.139_2),
        ("m", by(Param::Mass(BLOCK)), -1.706_666_666_666_666_7),
    ];
    for (what, direction, exact) in moved {
        let [x, slope] = way(lab, &push(12.0, 1e-3), 0.8, &direction)?;
        lab.near(format!("(b) 12 N, x, with d/d{what}"), x, 0.990_4, 2e-3);
        lab.relative(format!("(b) 12 N, dx/d{what} at dt=0.001"), slope, exact, 2e-2);
        let [x, slope] = way(lab, &recommended(push(12.0, 1e-3)), 0.8, &direction)?;
        lab.fine(format!("(b) 12 N, x, with d/d{what}"), x, 0.990_4, 1e-9);
        lab.fine_slope(format!("(b) 12 N, dx/d{what}"), slope, exact, 1e-6);
    }
    Ok(())
}

/// The floor stays level and gravity leans by the angle of friction; a change of the angle turns it:
/// (sin, −cos)' = (cos, sin). One way the block stays, the other it slides at g (cos + mu sin) dθ.
fn on_the_verge(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let (sin, cos) = 20.0_f64.to_radians().sin_cos();
    let (mu, g) = (sin / cos, 9.81);
    let gravity = [g * sin, -g * cos];
    let def = SceneDef { dt: 1e-3, gravity, ..sliding_box(1.0, mu, 0.0) };
    let run = lab.run(&def, 1.0)?;
    lab.near("(c) x", run.last().q[BLOCK].x, 0.0, 1e-12);
    let seed = run.pick(|s| s.q[BLOCK].x = 1.0);
    let angle = [(Param::Gravity(0), g * cos), (Param::Gravity(1), g * sin)];
    let slope = lab.slope(&run, &seed, &angle)?;
    let most = 0.5 * g * (cos + mu * sin);
    lab.at_least("(c) dx/d angle", slope, 0.0);
    let bound = [slope, most, 2e-2 * most];
    lab.figure("(c) dx/d angle", Grade::Step, Relation::AtMost, bound);
    let flagged = run.gradient(&seed)?.report.one_sided;
    lab.holds("(c) flagged as one-sided", flagged.iter().any(|row| row.step == 0));
    Ok(())
}

fn central_path(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for q in [-2.0, -0.1, 0.1, 2.0] {
        for tau in [1e-6_f64, 1e-3, 0.2] {
            let exact = -0.5 * (1.0 - q / f64::sqrt(q * q + 4.0 * tau));
            let title = format!("(d) q = {q}, tau = {tau:e}: dz/dq");
            lab.near(title, softened(lab, q, tau)?, exact, 1e-10);
        }
    }
    Ok(())
}

/// dz/dq of w = z + q, w z = τ: a body of 1 kg at the speed q before a wall, z its impulse. The problem's own
/// energy is q².
fn softened(lab: &Lab<'_>, q: f64, tau: f64) -> Result<f64, Stop> {
    let along = Vector3::new(1.0, 0.0, 0.0);
    let row = Row {
        bodies: [NO_BODY, 0],
        jacobian: [Vector3::zeros(), along],
        rhs: 0.0,
        compliance: 0.0,
        law: Law::Unilateral,
    };
    let (mass, momentum) = (vec![Vector3::repeat(1.0)], vec![q * along]);
    let problem = Lcp { mass, momentum, rows: vec![row] };
    let (mut solution, _) =
        solve_checked(lab.solver(), &problem, None, &mut Scratch::default(), 1e-10)?;
    let mode = GradientMode::Smoothed { kappa: tau / (q * q) };
    mode.prepare_solution(&problem, &mut solution).map_err(DiffError::from)?;
    let (bar, _) =
        lcp_vjp(&problem, &solution, &[Vector3::zeros()], Some(&[1.0])).map_err(DiffError::from)?;
    Ok(bar.momentum[0].x)
}
