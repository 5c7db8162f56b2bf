//! The mixed problem of V31: three velocities, one equality, two inequalities.
//!
//! ```text
//!  M v = f + Jeᵀ y + Jcᵀ z      Je v = be      0 ≤ z ⟂ Jc v − bc ≥ 0
//! ```

use nalgebra::Vector3;
use tangency_diff::lcp::{LcpVector, lcp_jvp, lcp_vjp};
use tangency_lcp::{Law, Lcp, LcpError, LcpSolution, NO_BODY, RawLcp, Row, Scratch, solve_checked};

use crate::{Lab, Stop};

use super::raw::{entries, problem, solved};

const V: [f64; 3] = [1.4, -1.4, -1.4];
/// dv/df, row by row.
const BY_FORCE: [[f64; 3]; 3] = [[0.2, -0.2, -0.2], [-0.2, 0.2, 0.2], [-0.2, 0.2, 0.2]];
const Z1_BY_FORCE: [f64; 3] = [-0.4, -0.6, 0.4];

/// As one matrix in (v, y, z); the first four unknowns are free, and q holds −f, −be and −bc.
fn one_matrix() -> RawLcp {
    let rows: [&[f64]; 6] = [
        &[2.0, 0.0, 0.0, -1.0, 0.0, 0.0],
        &[0.0, 2.0, 0.0, 0.0, -1.0, -1.0],
        &[0.0, 0.0, 1.0, -1.0, 1.0, -1.0],
        &[1.0, 0.0, 1.0, 0.0, 0.0, 0.0],
        &[0.0, 1.0, -1.0, 0.0, 0.0, 0.0],
        &[0.0, 1.0, 1.0, 0.0, 0.0, 0.0],
    ];
    RawLcp { free: 4, ..problem(&rows, &[-4.0, 4.0, -1.0, 0.0, 0.0, 4.0]) }
}

pub(super) fn raw(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let problem = one_matrix();
    let Some(found) = solved(lab, "mixed, raw", &problem) else { return Ok(()) };
    entries(lab, "mixed, raw: v, y, z", found.z.as_slice(), &[1.4, -1.4, -1.4, -1.2, 1.2, 0.0]);
    entries(lab, "mixed, raw: w", &found.w.as_slice()[4..], &[0.0, 1.2]);
    let by = problem.derivative(&found)?;
    for (i, exact) in BY_FORCE.iter().enumerate() {
        let row: Vec<f64> = (0..3).map(|j| -by[(i, j)]).collect();
        entries(lab, &format!("mixed, raw: dv{}/df", i + 1), &row, exact);
    }
    let row: Vec<f64> = (0..3).map(|j| -by[(4, j)]).collect();
    entries(lab, "mixed, raw: dz1/df", &row, &Z1_BY_FORCE);
    lab.holds("mixed, raw: flagged as regular", found.is_regular());
    Ok(())
}

/// As the step of one body with masses (2, 2, 1). `equalities` are right-hand sides of the row
/// (1, 0, 1).
fn one_body(equalities: &[f64]) -> Lcp {
    let row = |jacobian: [f64; 3], rhs, law| Row {
        bodies: [NO_BODY, 0],
        jacobian: [Vector3::zeros(), Vector3::from(jacobian)],
        rhs,
        compliance: 0.0,
        law,
    };
    let mut rows: Vec<Row> =
        equalities.iter().map(|b| row([1.0, 0.0, 1.0], *b, Law::Equality)).collect();
    rows.push(row([0.0, 1.0, -1.0], 0.0, Law::Unilateral));
    rows.push(row([0.0, 1.0, 1.0], -4.0, Law::Unilateral));
    let (mass, momentum) = (vec![Vector3::new(2.0, 2.0, 1.0)], vec![Vector3::new(4.0, -4.0, 1.0)]);
    Lcp { mass, momentum, rows }
}

fn accepted(lab: &mut Lab<'_>, what: &str, problem: &Lcp) -> Result<LcpSolution, Stop> {
    let scratch = &mut Scratch::default();
    let (solution, residual) = solve_checked(lab.solver(), problem, None, scratch, 1e-10)?;
    lab.near(format!("{what}: residual"), residual.max(), 0.0, 1e-10);
    Ok(solution)
}

/// v, y, z, w and derivatives with the equality entered any number of times.
fn figures(lab: &mut Lab<'_>, what: &str, problem: &Lcp) -> Result<(), Stop> {
    let found = accepted(lab, what, problem)?;
    let first = problem.rows.len() - 2;
    entries(lab, &format!("{what}: v"), found.velocities[0].as_slice(), &V);
    lab.near(format!("{what}: y"), found.impulses[..first].iter().sum(), -1.2, 1e-8);
    entries(lab, &format!("{what}: z"), &found.impulses[first..], &[1.2, 0.0]);
    entries(lab, &format!("{what}: w"), &found.slacks[first..], &[0.0, 1.2]);
    by_force(lab, what, problem, &found)?;
    let mut along = LcpVector::zeros(problem);
    let mut z1 = [0.0; 3];
    for (k, by) in z1.iter_mut().enumerate() {
        along.momentum[0] = Vector3::ith(k, 1.0);
        *by = lcp_jvp(problem, &found, &along).map_err(refused)?.1[first];
    }
    entries(lab, &format!("{what}: dz1/df"), &z1, &Z1_BY_FORCE);
    Ok(())
}

/// dv/df, a row by each reverse pass; no row is weakly active.
fn by_force(lab: &mut Lab<'_>, what: &str, problem: &Lcp, found: &LcpSolution) -> Result<(), Stop> {
    for (i, exact) in BY_FORCE.iter().enumerate() {
        let (bar, report) =
            lcp_vjp(problem, found, &[Vector3::ith(i, 1.0)], None).map_err(refused)?;
        entries(lab, &format!("{what}: dv{}/df", i + 1), bar.momentum[0].as_slice(), exact);
        lab.holds(format!("{what}: flagged as smooth"), report.weak.is_empty());
    }
    Ok(())
}

fn refused(error: tangency_diff::lcp::LcpDiffError) -> Stop {
    let source = Box::new(error);
    Stop::Problem(LcpError::Backend { solver: "derivative", source })
}

pub(super) fn step(lab: &mut Lab<'_>) -> Result<(), Stop> {
    figures(lab, "mixed", &one_body(&[0.0]))
}

pub(super) fn twice(lab: &mut Lab<'_>) -> Result<(), Stop> {
    figures(lab, "mixed, twice", &one_body(&[0.0, 0.0]))
}

pub(super) fn contradiction(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let problem = one_body(&[0.0, 0.1]);
    let result = solve_checked(lab.solver(), &problem, None, &mut Scratch::default(), 1e-10);
    let told = matches!(result, Err(LcpError::Infeasible { .. }));
    lab.holds("mixed, contradicting: told infeasible", told);
    let residual = result.err().and_then(|error| error.residual()).unwrap_or(f64::NAN);
    lab.at_least("mixed, contradicting: residual", residual, 1e-6);
    Ok(())
}
