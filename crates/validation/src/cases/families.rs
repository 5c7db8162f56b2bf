//! Families of complementarity problems on which methods stumble.

#![expect(non_snake_case, reason = "matrices carry their names from the literature")]

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};
use tangency_lcp::{RawLcp, RawSolution};

use crate::{Case, Lab, Part, Stop};

use super::raw::{non_symmetric, problem, solved};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V32",
    title: "Families of problems",
    parts: &[
        Part::new("Murty and Fathi", murty_and_fathi),
        Part::new("circulant", circulant),
        Part::new("Hilbert", hilbert),
        Part::new("scaled rows and columns", scaled),
        Part::new("diagonal", diagonal),
        Part::new("tridiagonal", tridiagonal),
    ],
}];

/// Size of the large problems.
const LARGE: usize = 1000;

/// Solves within 60 iterations.
fn quickly(lab: &mut Lab<'_>, what: &str, problem: &RawLcp) -> Option<RawSolution> {
    let found = solved(lab, what, problem)?;
    lab.at_most(format!("{what}: iterations"), f64::from(found.iterations), 60.0);
    Some(found)
}

/// The greatest distance of an entry from its exact value.
fn all(lab: &mut Lab<'_>, what: String, found: &DVector<f64>, exact: &DVector<f64>, most: f64) {
    lab.near(what, (found - exact).amax(), 0.0, most);
}

/// Ones on the diagonal, twos above it.
fn upper(n: usize) -> DMatrix<f64> {
    DMatrix::from_fn(n, n, |i, j| if i == j { 1.0 } else { f64::from(u8::from(i < j)) * 2.0 })
}

fn unit(n: usize, place: usize) -> DVector<f64> {
    DVector::from_fn(n, |i, _| f64::from(u8::from(i == place)))
}

fn murty_and_fathi(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for n in [8, 16, 32, 64, 128] {
        let (U, q) = (upper(n), DVector::from_element(n, -1.0));
        let murty = RawLcp { free: 0, matrix: U.clone(), q: q.clone() };
        let fathi = RawLcp { free: 0, matrix: U.tr_mul(&U), q };
        for (name, problem, place) in [("Murty", murty, n - 1), ("Fathi", fathi, 0)] {
            let what = format!("{name} {n}");
            let Some(found) = quickly(lab, &what, &problem) else { continue };
            all(lab, format!("{what}: z"), &found.z, &unit(n, place), 1e-8);
            let w = unit(n, place).map(|z| 1.0 - z);
            all(lab, format!("{what}: w"), &found.w, &w, 1e-8);
        }
    }
    Ok(())
}

/// A P-matrix on which corrections of whole blocks cycle (Ben Gharbia & Gilbert 2012).
fn circulant(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let rows: [&[f64]; 3] = [&[1.0, 0.0, 2.0], &[2.0, 1.0, 0.0], &[0.0, 2.0, 1.0]];
    if let Some(found) = quickly(lab, "circulant", &problem(&rows, &[-1.0; 3])) {
        let exact = DVector::from_element(3, 1.0 / 3.0);
        all(lab, "circulant: z".into(), &found.z, &exact, 1e-8);
    }
    Ok(())
}

fn hilbert(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let q = [
        -287.0 / 120.0,
        -11.0 / 18.0,
        -53.0 / 42.0,
        -145.0 / 264.0,
        -379.0 / 420.0,
        941.0 / 780.0,
        403.0 / 1386.0,
        -77.0 / 120.0,
    ];
    let matrix = DMatrix::from_fn(8, 8, |i, j| 1.0 / (i + j + 1) as f64);
    let problem = RawLcp { free: 0, matrix, q: DVector::from_column_slice(&q) };
    if let Some(found) = quickly(lab, "Hilbert", &problem) {
        lab.near("Hilbert: residual to 1e-12", problem.residual(&found.z), 0.0, 1e-12);
        let z = DVector::from_column_slice(&[1.0, 0.0, 2.0, 0.0, 3.0, 0.0, 0.0, 1.0]);
        all(lab, "Hilbert: z".into(), &found.z, &z, 1e-6);
        let w = DVector::from_column_slice(&[0.0, 1.0, 0.0, 0.5, 0.0, 2.0, 1.0, 0.0]);
        all(lab, "Hilbert: w".into(), &found.w, &w, 1e-6);
    }
    Ok(())
}

/// D M D and D q in place of M and q: D z is what z was.
fn scaled(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let RawLcp { free, matrix, q } = non_symmetric();
    let D = DMatrix::from_diagonal(&DVector::from_vec(vec![1e6, 1.0, 1e-6]));
    let problem = RawLcp { free, matrix: &D * matrix * &D, q: &D * q };
    if let Some(found) = quickly(lab, "scaled", &problem) {
        let exact = DVector::from_column_slice(&[1.0, 1.0, 0.0]);
        all(lab, "scaled: D z".into(), &(D * found.z), &exact, 1e-8);
    }
    Ok(())
}

/// zᵢ = n/i, to 1e-8 of itself.
fn diagonal(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let diagonal = DVector::from_fn(LARGE, |i, _| (i + 1) as f64 / LARGE as f64);
    let (matrix, q) = (DMatrix::from_diagonal(&diagonal), DVector::from_element(LARGE, -1.0));
    if let Some(found) = quickly(lab, "diagonal", &RawLcp { free: 0, matrix, q }) {
        let ones = DVector::from_element(LARGE, 1.0);
        all(lab, "diagonal: z i/n".into(), &found.z.component_mul(&diagonal), &ones, 1e-8);
    }
    Ok(())
}

fn tridiagonal(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let matrix = DMatrix::from_fn(LARGE, LARGE, |i, j| match i.abs_diff(j) {
        0 => 2.0,
        1 => -1.0,
        _ => 0.0,
    });
    let wave = DVector::from_fn(LARGE, |i, _| (6.0 * PI * (i + 1) as f64 / LARGE as f64).sin());
    let (z, w) = (wave.map(|s| s.max(0.0)), wave.map(|s| (-s).max(0.0)));
    let q = &w - &matrix * &z;
    if let Some(found) = quickly(lab, "tridiagonal", &RawLcp { free: 0, matrix, q }) {
        all(lab, "tridiagonal: z".into(), &found.z, &z, 1e-8);
        all(lab, "tridiagonal: w".into(), &found.w, &w, 1e-8);
    }
    Ok(())
}
