//! Band factorisations against dense ones.

use nalgebra::{DMatrix, DVector};
use proptest::{prelude::*, test_runner::RngSeed};
use tangency_lcp::{BandMatrix, Cholesky, Lu};

use crate::problems::near;

/// A band matrix of small diagonal (so that rows are exchanged) and its dense copy.
fn random(n: usize, lower: usize, entries: &[f64]) -> (BandMatrix, DMatrix<f64>) {
    let (mut band, mut dense) = (BandMatrix::zeros(n, lower), DMatrix::zeros(n, n));
    for i in 0..n {
        for j in band.columns(i) {
            let size = if i == j { 0.3 } else { 1.0 };
            let value = size * entries[(i * n + j) % entries.len()];
            band.add(i, j, value);
            dense[(i, j)] = value;
        }
    }
    (band, dense)
}

proptest! {
    #![proptest_config(ProptestConfig {
        rng_seed: RngSeed::Fixed(20),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]
    #[test]
    fn lu_solves_with_matrix_and_transpose(
        n in 1_usize..24,
        lower in 0_usize..8,
        entries in prop::collection::vec(-1.0..1.0_f64, 577),
        right in prop::collection::vec(-1.0..1.0_f64, 24),
    ) {
        let (band, dense) = random(n, lower, &entries);
        let least = dense.singular_values().min();
        prop_assume!(least > 1e-3);
        let right = DVector::from_column_slice(&right[..n]);
        near(&band.times(right.as_slice()), (&dense * &right).as_slice(), 1e-13);
        let lu = Lu::new(band, 0.0);
        let (mut x, mut y) = (right.clone(), right.clone());
        lu.solve(x.as_mut_slice());
        lu.solve_transpose(y.as_mut_slice());
        near((&dense * x).as_slice(), right.as_slice(), 1e-10);
        near((dense.transpose() * y).as_slice(), right.as_slice(), 1e-10);
    }

    /// Rows without entries move down past the end that they had.
    #[test]
    fn lu_of_mostly_zeros(
        n in 1_usize..24,
        lower in 0_usize..8,
        entries in prop::collection::vec(prop_oneof![3 => Just(0.0), 1 => -1.0..1.0_f64], 577),
        right in prop::collection::vec(-1.0..1.0_f64, 24),
    ) {
        let (band, dense) = random(n, lower, &entries);
        let right = DVector::from_column_slice(&right[..n]);
        let lu = Lu::new(band, 1e-6);
        let (mut x, mut y) = (right.clone(), right.clone());
        lu.solve(x.as_mut_slice());
        lu.solve_transpose(y.as_mut_slice());
        if dense.singular_values().min() > 1e-3 {
            near((&dense * x).as_slice(), right.as_slice(), 1e-10);
            near((dense.transpose() * y).as_slice(), right.as_slice(), 1e-10);
        }
    }

    #[test]
    fn cholesky_solves_inside_the_envelope(
        n in 1_usize..24,
        lower in 0_usize..8,
        entries in prop::collection::vec(-1.0..1.0_f64, 577),
        right in prop::collection::vec(-1.0..1.0_f64, 24),
    ) {
        let (_, dense) = random(n, lower / 2, &entries);
        let A = &dense * dense.transpose() + DMatrix::identity(n, n) * 0.1;
        let mut band = BandMatrix::zeros_lower(n, lower);
        for i in 0..n {
            for j in i.saturating_sub(lower)..=i {
                band.add(i, j, A[(i, j)]);
            }
        }
        let mut x = DVector::from_column_slice(&right[..n]);
        Cholesky::new(band, 0.0).solve(x.as_mut_slice());
        near((A * x).as_slice(), &right[..n], 1e-10);
    }
}
