//! Raw problems with known answers: V31 and V32.

use nalgebra::{DMatrix, DVector};
use tangency_lcp::LcpError;
use tangency_lcp_ipm::{InteriorPoint, RawLcp, RawSolution, solve_raw};

fn raw(rows: &[&[f64]], q: &[f64]) -> RawLcp {
    let n = q.len();
    let matrix = DMatrix::from_fn(n, n, |i, j| rows[i][j]);
    RawLcp { free: 0, matrix, q: DVector::from_column_slice(q) }
}

#[track_caller]
fn solved(problem: &RawLcp) -> RawSolution {
    let solution = solve_raw(problem, &InteriorPoint::default()).expect("solved");
    assert!(solution.residual <= 1e-10, "{:e}", solution.residual);
    assert!(solution.residual >= problem.residual(&solution.z));
    assert!(solution.iterations <= 60, "{} iterations", solution.iterations);
    solution
}

#[track_caller]
fn near(found: &[f64], wanted: &[f64], tolerance: f64) {
    assert_eq!(found.len(), wanted.len());
    for (found, wanted) in found.iter().zip(wanted) {
        assert!((found - wanted).abs() <= tolerance, "{found} is not {wanted}");
    }
}

#[test]
fn regular_problems_and_their_derivatives() {
    let problem = raw(&[&[2.0, 1.0], &[1.0, 2.0]], &[-5.0, -6.0]);
    let solution = solved(&problem);
    near(solution.z.as_slice(), &[4.0 / 3.0, 7.0 / 3.0], 1e-12);
    assert!(solution.is_regular());
    let derivative = problem.derivative(&solution).expect("regular");
    near(derivative.as_slice(), &[-2.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0, -2.0 / 3.0], 1e-12);

    let problem = non_symmetric();
    let solution = solved(&problem);
    near(solution.z.as_slice(), &[1.0, 1.0, 0.0], 1e-12);
    near(&[solution.w[2]], &[4.0], 1e-12);
    let derivative = problem.derivative(&solution).expect("regular");
    let block = derivative.view((0, 0), (2, 2)).clone_owned();
    near(block.as_slice(), &[-0.2, 0.6, -0.2, -0.4], 1e-12);
}

fn non_symmetric() -> RawLcp {
    raw(&[&[2.0, -1.0, 0.0], &[3.0, 1.0, -1.0], &[0.0, 2.0, 1.0]], &[-1.0, -4.0, 2.0])
}

#[test]
fn weakly_active_and_degenerate_problems() {
    let weak = solved(&raw(&[&[2.0, 1.0], &[1.0, 2.0]], &[-2.0, -1.0]));
    near(weak.z.as_slice(), &[1.0, 0.0], 1e-10);
    near(weak.w.as_slice(), &[0.0, 0.0], 1e-10);
    assert_eq!(weak.weak, [1]);

    let segment = solved(&raw(&[&[1.0, 1.0], &[1.0, 1.0]], &[-1.0, -1.0]));
    near(&[segment.z.sum()], &[1.0], 1e-10);
    near(segment.w.as_slice(), &[0.0, 0.0], 1e-10);
    assert!(!segment.is_regular());
}

#[test]
fn one_of_several_solutions() {
    let z = solved(&raw(&[&[1.0, 2.0], &[2.0, 1.0]], &[-1.0, -1.0])).z;
    let answers = [[0.0, 1.0], [1.0, 0.0], [1.0 / 3.0, 1.0 / 3.0]];
    assert!(
        answers
            .iter()
            .any(|answer| (z[0] - answer[0]).abs() < 1e-8 && (z[1] - answer[1]).abs() < 1e-8),
        "{z}"
    );

    let rows: [&[f64]; 3] = [&[0.0, 1.0, 0.0], &[0.0, 0.0, 1.0], &[0.0, -1.0, 1.0]];
    let z = solved(&raw(&rows, &[0.0, 0.0, 1.0])).z;
    let alone = (z[1] - 1.0).abs() < 1e-8 && z[0].abs() < 1e-8;
    assert!(z[2].abs() < 1e-8 && (alone || (z[1].abs() < 1e-8 && z[0] >= -1e-8)), "{z}");

    let rows: [&[f64]; 4] = [
        &[6.0, 2.0, 1.0, 3.0],
        &[5.0, 0.0, 10.0, 2.0],
        &[6.0, 1.0, 2.0, 9.0],
        &[2.0, 0.0, 2.0, 3.0],
    ];
    let z = solved(&raw(&rows, &[-9.0, -4.0, -12.0, -4.0])).z;
    let answers =
        [[1.0, 0.0, 3.0, 0.0], [1.25, 0.0, 0.0, 0.5], [4.0 / 11.0, 39.0 / 22.0, 0.0, 12.0 / 11.0]];
    assert!(
        answers.iter().any(|answer| z.iter().zip(answer).all(|(z, a)| (z - a).abs() < 1e-8)),
        "{z}"
    );
}

#[test]
fn bimatrix_game() {
    let rows: [&[f64]; 4] = [
        &[0.0, 0.0, -1.0, -3.0],
        &[0.0, 0.0, -2.0, -1.0],
        &[1.0, 2.0, 0.0, 0.0],
        &[3.0, 1.0, 0.0, 0.0],
    ];
    let solution = solved(&raw(&rows, &[3.0, 2.0, -4.0, -6.0]));
    near(solution.z.as_slice(), &[1.6, 1.2, 0.6, 0.8], 1e-10);
}

#[test]
fn infeasible_is_told_from_unsolvable() {
    let infeasible = raw(&[&[0.0, -1.0], &[1.0, 0.0]], &[-1.0, 0.0]);
    let error = solve_raw(&infeasible, &InteriorPoint::default()).expect_err("infeasible");
    assert!(matches!(error, LcpError::Infeasible { .. }), "{error}");

    let unsolvable = raw(&[&[-2.0, 1.0], &[-2.0, 1.0]], &[-2.0, -1.0]);
    let error = solve_raw(&unsolvable, &InteriorPoint::default()).expect_err("no solution");
    assert!(matches!(error, LcpError::NotConverged { .. }), "{error}");
}

#[test]
fn scaled_rows_and_columns() {
    let mut problem = non_symmetric();
    let D = DMatrix::from_diagonal(&DVector::from_vec(vec![1e6, 1.0, 1e-6]));
    problem.matrix = &D * &problem.matrix * &D;
    problem.q = &D * &problem.q;
    let z = solved(&problem).z;
    near((D * z).as_slice(), &[1.0, 1.0, 0.0], 1e-8);
}

fn unit_upper(n: usize) -> DMatrix<f64> {
    DMatrix::from_fn(n, n, |i, j| match i.cmp(&j) {
        std::cmp::Ordering::Equal => 1.0,
        std::cmp::Ordering::Less => 2.0,
        std::cmp::Ordering::Greater => 0.0,
    })
}

#[test]
fn murty_and_fathi() {
    for n in [8, 16, 32, 64, 128] {
        let q = DVector::from_element(n, -1.0);
        let murty = solved(&RawLcp { free: 0, matrix: unit_upper(n), q: q.clone() });
        near(&[murty.z[n - 1], murty.z.sum()], &[1.0, 1.0], 1e-8);

        let U = unit_upper(n);
        let fathi = solved(&RawLcp { free: 0, matrix: U.tr_mul(&U), q });
        near(&[fathi.z[0], fathi.z.sum()], &[1.0, 1.0], 1e-8);
    }
}

#[test]
fn circulant_p_matrix_on_which_block_corrections_cycle() {
    // Ben Gharbia & Gilbert 2012.
    let rows: [&[f64]; 3] = [&[1.0, 0.0, 2.0], &[2.0, 1.0, 0.0], &[0.0, 2.0, 1.0]];
    let z = solved(&raw(&rows, &[-1.0, -1.0, -1.0])).z;
    near(z.as_slice(), &[1.0 / 3.0; 3], 1e-12);
}

#[test]
fn diagonal_tridiagonal_and_hilbert() {
    let n = 1000;
    let diagonal = DVector::from_fn(n, |i, _| (i + 1) as f64 / n as f64);
    let matrix = DMatrix::from_diagonal(&diagonal);
    let z = solved(&RawLcp { free: 0, matrix, q: DVector::from_element(n, -1.0) }).z;
    near((z.component_mul(&diagonal)).as_slice(), &vec![1.0; n], 1e-10);

    let tridiagonal = DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 => 2.0,
        1 => -1.0,
        _ => 0.0,
    });
    let wave =
        DVector::from_fn(n, |i, _| (6.0 * std::f64::consts::PI * (i + 1) as f64 / n as f64).sin());
    let (z, w) = (wave.map(|s| s.max(0.0)), wave.map(|s| (-s).max(0.0)));
    let q = w - &tridiagonal * &z;
    let found = solved(&RawLcp { free: 0, matrix: tridiagonal, q }).z;
    near(found.as_slice(), z.as_slice(), 1e-8);

    let hilbert = DMatrix::from_fn(8, 8, |i, j| 1.0 / (i + j + 1) as f64);
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
    let solution = solved(&RawLcp { free: 0, matrix: hilbert, q: DVector::from_column_slice(&q) });
    assert!(solution.residual <= 1e-12);
    near(solution.z.as_slice(), &[1.0, 0.0, 2.0, 0.0, 3.0, 0.0, 0.0, 1.0], 1e-6);
}

#[test]
fn free_unknowns_are_equations() {
    // M v = f + Jᵀ z with v free: V31's mixed problem as one raw matrix.
    let rows: [&[f64]; 6] = [
        &[2.0, 0.0, 0.0, -1.0, 0.0, 0.0],
        &[0.0, 2.0, 0.0, 0.0, -1.0, -1.0],
        &[0.0, 0.0, 1.0, -1.0, 1.0, -1.0],
        &[1.0, 0.0, 1.0, 0.0, 0.0, 0.0],
        &[0.0, 1.0, -1.0, 0.0, 0.0, 0.0],
        &[0.0, 1.0, 1.0, 0.0, 0.0, 0.0],
    ];
    let mut problem = raw(&rows, &[-4.0, 4.0, -1.0, 0.0, 0.0, 4.0]);
    problem.free = 4;
    let solution = solved(&problem);
    near(solution.z.as_slice(), &[1.4, -1.4, -1.4, -1.2, 1.2, 0.0], 1e-12);
}
