//! Complementarity problems w = M z + q, 0 ≤ z ⟂ w ≥ 0, that are small and solved exactly.

use nalgebra::{DMatrix, DVector};
use tangency_lcp::{LcpError, RawLcp, RawSolution};

use crate::{Case, Lab, Part, Stop};

use super::mixed;

pub(crate) const CASES: &[Case] = &[Case {
    id: "V31",
    title: "Small problems with exact answers",
    parts: &[
        Part::new("regular", regular),
        Part::new("weakly active and degenerate", degenerate),
        Part::new("several solutions", several),
        Part::new("no solution", none),
        Part::new("mixed, as a raw problem", mixed::raw),
        Part::new("mixed, as a time step", mixed::step),
        Part::new("mixed, equality entered twice", mixed::twice),
        Part::new("mixed, contradicting equalities", mixed::contradiction),
    ],
}];

pub(super) fn problem(rows: &[&[f64]], q: &[f64]) -> RawLcp {
    let matrix = DMatrix::from_fn(q.len(), q.len(), |i, j| rows[i][j]);
    RawLcp { free: 0, matrix, q: DVector::from_column_slice(q) }
}

/// The solution, with its figures of residual and iterations. `None`, with a figure that says so,
/// where there is none.
pub(super) fn solved(lab: &mut Lab<'_>, what: &str, problem: &RawLcp) -> Option<RawSolution> {
    match lab.raw().solve_raw(problem) {
        Ok(solution) => {
            let residual = solution.residual.max(problem.residual(&solution.z));
            lab.near(format!("{what}: residual"), residual, 0.0, 1e-10);
            Some(solution)
        }
        Err(error @ LcpError::OutsideClass { .. }) => {
            lab.refused(what, &error);
            None
        }
        Err(error) => {
            lab.stopped(what, &error.into());
            None
        }
    }
}

/// Every entry, to 1e-8.
pub(super) fn entries(lab: &mut Lab<'_>, what: &str, found: &[f64], exact: &[f64]) {
    for (i, (found, exact)) in found.iter().zip(exact).enumerate() {
        lab.near(format!("{what}[{}]", i + 1), *found, *exact, 1e-8);
    }
    lab.holds(format!("{what}: number of entries"), found.len() == exact.len());
}

/// A block of dz/dq, column by column.
pub(super) fn slopes(
    lab: &mut Lab<'_>,
    what: &str,
    (problem, solution): (&RawLcp, &RawSolution),
    size: usize,
    exact: &[f64],
) -> Result<(), Stop> {
    let derivative = problem.derivative(solution)?;
    let block = derivative.view((0, 0), (size, size)).clone_owned();
    entries(lab, &format!("{what}: dz/dq"), block.as_slice(), exact);
    lab.holds(format!("{what}: flagged as regular"), solution.is_regular());
    Ok(())
}

/// The second row of the table: not symmetric.
pub(super) fn non_symmetric() -> RawLcp {
    problem(&[&[2.0, -1.0, 0.0], &[3.0, 1.0, -1.0], &[0.0, 2.0, 1.0]], &[-1.0, -4.0, 2.0])
}

fn regular(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let symmetric = problem(&[&[2.0, 1.0], &[1.0, 2.0]], &[-5.0, -6.0]);
    if let Some(found) = solved(lab, "symmetric", &symmetric) {
        entries(lab, "symmetric: z", found.z.as_slice(), &[4.0 / 3.0, 7.0 / 3.0]);
        let exact = [-2.0, 1.0, 1.0, -2.0].map(|x| x / 3.0);
        slopes(lab, "symmetric", (&symmetric, &found), 2, &exact)?;
    }
    let other = non_symmetric();
    if let Some(found) = solved(lab, "not symmetric", &other) {
        entries(lab, "not symmetric: z", found.z.as_slice(), &[1.0, 1.0, 0.0]);
        lab.near("not symmetric: w3", found.w[2], 4.0, 1e-8);
        slopes(lab, "not symmetric", (&other, &found), 2, &[-0.2, 0.6, -0.2, -0.4])?;
    }
    bimatrix_game(lab)
}

/// All of w is zero, so that dz/dq = −M⁻¹ = [0, −B⁻¹; −A⁻¹, 0] with M = [0, A; B, 0].
fn bimatrix_game(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let rows: [&[f64]; 4] = [
        &[0.0, 0.0, -1.0, -3.0],
        &[0.0, 0.0, -2.0, -1.0],
        &[1.0, 2.0, 0.0, 0.0],
        &[3.0, 1.0, 0.0, 0.0],
    ];
    let game = problem(&rows, &[3.0, 2.0, -4.0, -6.0]);
    let Some(found) = solved(lab, "bimatrix game", &game) else { return Ok(()) };
    entries(lab, "bimatrix game: z", found.z.as_slice(), &[1.6, 1.2, 0.6, 0.8]);
    entries(lab, "bimatrix game: w", found.w.as_slice(), &[0.0; 4]);
    let exact =
        [0.0, 0.0, -0.2, 0.4, 0.0, 0.0, 0.6, -0.2, 0.2, -0.6, 0.0, 0.0, -0.4, 0.2, 0.0, 0.0];
    slopes(lab, "bimatrix game", (&game, &found), 4, &exact)
}

fn degenerate(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let touching = problem(&[&[2.0, 1.0], &[1.0, 2.0]], &[-2.0, -1.0]);
    if let Some(found) = solved(lab, "weakly active", &touching) {
        entries(lab, "weakly active: z", found.z.as_slice(), &[1.0, 0.0]);
        entries(lab, "weakly active: w", found.w.as_slice(), &[0.0, 0.0]);
        lab.holds("weakly active: flagged", found.weak == [1]);
        let by = touching.derivative(&found)?[(1, 1)];
        lab.at_least("weakly active: dz2/dq2", by, -2.0 / 3.0);
        lab.at_most("weakly active: dz2/dq2", by, 0.0);
    }
    let segment = problem(&[&[1.0, 1.0], &[1.0, 1.0]], &[-1.0, -1.0]);
    if let Some(found) = solved(lab, "segment", &segment) {
        lab.near("segment: z1 + z2", found.z.sum(), 1.0, 1e-8);
        lab.at_least("segment: least z", found.z.min(), -1e-10);
        entries(lab, "segment: w", found.w.as_slice(), &[0.0, 0.0]);
        lab.holds("segment: flagged", !found.is_regular());
    }
    Ok(())
}

fn several(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let crossed = problem(&[&[1.0, 2.0], &[2.0, 1.0]], &[-1.0, -1.0]);
    one_of(lab, "three points", &crossed, &[&[0.0, 1.0], &[1.0, 0.0], &[1.0 / 3.0; 2]]);

    let rows: [&[f64]; 3] = [&[0.0, 1.0, 0.0], &[0.0, 0.0, 1.0], &[0.0, -1.0, 1.0]];
    let ray = problem(&rows, &[0.0, 0.0, 1.0]);
    if let Some(found) = solved(lab, "point and ray", &ray) {
        // (0, 1, 0), or any (s, 0, 0).
        let s = if found.z[1] > 0.5 { [0.0, 1.0, 0.0] } else { [found.z[0].max(0.0), 0.0, 0.0] };
        entries(lab, "point and ray: z", found.z.as_slice(), &s);
    }

    let rows: [&[f64]; 4] = [
        &[6.0, 2.0, 1.0, 3.0],
        &[5.0, 0.0, 10.0, 2.0],
        &[6.0, 1.0, 2.0, 9.0],
        &[2.0, 0.0, 2.0, 3.0],
    ];
    let four = problem(&rows, &[-9.0, -4.0, -12.0, -4.0]);
    let answers: [&[f64]; 3] = [
        &[1.0, 0.0, 3.0, 0.0],
        &[1.25, 0.0, 0.0, 0.5],
        &[4.0 / 11.0, 39.0 / 22.0, 0.0, 12.0 / 11.0],
    ];
    one_of(lab, "three points in four", &four, &answers);
    Ok(())
}

/// The solution is one of the answers.
fn one_of(lab: &mut Lab<'_>, what: &str, problem: &RawLcp, answers: &[&[f64]]) {
    let Some(found) = solved(lab, what, problem) else { return };
    let away = |answer: &&[f64]| (&found.z - DVector::from_column_slice(answer)).amax();
    let nearest = answers.iter().map(away).fold(f64::INFINITY, f64::min);
    lab.near(format!("{what}: distance from the nearest answer"), nearest, 0.0, 1e-8);
}

fn none(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let infeasible = problem(&[&[0.0, -1.0], &[1.0, 0.0]], &[-1.0, 0.0]);
    let unsolvable = problem(&[&[-2.0, 1.0], &[-2.0, 1.0]], &[-2.0, -1.0]);
    for (what, problem, empty) in
        [("infeasible", infeasible, true), ("feasible without solution", unsolvable, false)]
    {
        match lab.raw().solve_raw(&problem) {
            Ok(_) => lab.holds(format!("{what}: not solved"), false),
            Err(error @ LcpError::OutsideClass { .. }) => lab.refused(what, &error),
            Err(error) => {
                let told = matches!(error, LcpError::Infeasible { .. });
                lab.holds(format!("{what}: not solved, told so"), told == empty);
                let residual = error.residual().unwrap_or(f64::NAN);
                lab.at_least(format!("{what}: residual"), residual, 1e-6);
            }
        }
    }
    Ok(())
}
