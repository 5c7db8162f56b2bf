//! Where the laws of rigid impact have several answers, or create energy.

use nalgebra::Vector3;
use tangency_bench::scenes::corner_landing;
use tangency_core::lcp::{Law, Lcp, LcpSolution, NO_BODY, Row, Scratch, solve_checked};

use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V25",
    title: "Where rigid-body laws strain",
    parts: &[
        Part::new("sticks at once", sticks),
        Part::new("one of three", one_of_three),
        Part::new("energy rises", energy_rises),
    ],
}];

const TOLERANCE: f64 = 1e-10;

/// Slender rod, half-length 1 and 1 kg; its end (3/5, −4/5) from the centre slides at 1 m/s, μ = 2,
/// with this normal velocity before the solve.
fn sliding_end(normal: f64) -> Lcp {
    let row = |jacobian, law| Row {
        bodies: [NO_BODY, 0],
        jacobian: [Vector3::zeros(), jacobian],
        rhs: 0.0,
        compliance: 0.0,
        law,
    };
    Lcp {
        mass: vec![Vector3::new(1.0, 1.0, 1.0 / 3.0)],
        momentum: vec![Vector3::new(1.0, normal, 0.0)],
        rows: vec![
            row(Vector3::new(0.0, 1.0, 0.6), Law::Unilateral),
            row(Vector3::new(1.0, 0.0, 0.8), Law::Friction { normal: 0, mu: 2.0 }),
        ],
    }
}

/// Solution, and its residual.
fn solve(lab: &Lab<'_>, normal: f64) -> Result<(LcpSolution, f64), Stop> {
    let problem = sliding_end(normal);
    let scratch = &mut Scratch::default();
    let (solution, residual) = solve_checked(lab.solver(), &problem, None, scratch, TOLERANCE)?;
    Ok((solution, residual.max()))
}

fn sticks(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let (solution, residual) = solve(lab, -0.1)?;
    lab.near("(a) closing, normal", solution.impulses[0], 0.433, 1e-10);
    lab.near("(a) closing, tangential", solution.impulses[1], -0.556, 1e-10);
    lab.near("(a) closing, slip", solution.slacks[1], 0.0, 1e-10);
    lab.near("(a) closing, residual", residual, 0.0, TOLERANCE);
    Ok(())
}

fn one_of_three(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let (solution, residual) = solve(lab, 0.1)?;
    let away = |[n, t]: [f64; 2]| (solution.impulses[0] - n).hypot(solution.impulses[1] - t);
    let nearest = [[0.0, 0.0], [0.287, -0.484], [0.125, -0.25]].map(away);
    let nearest = nearest.into_iter().fold(f64::INFINITY, f64::min);
    lab.near("(a) parting, distance from a solution", nearest, 0.0, 1e-10);
    lab.near("(a) parting, residual", residual, 0.0, TOLERANCE);
    let mut same = true;
    for _ in 0..10 {
        same &= solve(lab, 0.1)?.0 == solution;
    }
    lab.holds("(a) parting, same one each time", same);
    Ok(())
}

/// Newton's law with friction; without gravity.
fn energy_rises(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let run = lab.run_steps(&corner_landing(), 1)?;
    let impulses = run.end().contact_impulses();
    let (normal, tangent) = super::contact_sums(run.end());
    lab.near("(b) contacts", impulses.len() as f64, 1.0, 0.0);
    lab.near("(b) normal", normal, 6.170_596_405_687_934_5, 1e-9);
    // The floor is body a: the tangent ⊥n points to −x.
    lab.near("(b) tangential", -tangent, 2.386_914_918_631_761_8, 1e-9);
    let v = run.last().v[1];
    lab.near("(b) vx", v.x, 1.986_914_918_631_761_8, 1e-9);
    lab.near("(b) vy", v.y, 3.870_596_405_687_934_7, 1e-9);
    lab.near("(b) w", v.z, -5.523_872_296_304_452, 1e-9);
    let [before, after] = [&run.tape.initial, run.last()].map(|state| run.scene.energy(state));
    lab.near("(b) energy before", before, 6.933_33, 5e-6);
    lab.near("(b) energy after", after, 10.748_77, 5e-6);
    Ok(())
}
