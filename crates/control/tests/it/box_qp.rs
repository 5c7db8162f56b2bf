//! Quadratics within a box, against all their active sets tried one by one.

use nalgebra::{DMatrix, DVector};
use tangency_control::{BoxQp, ControlLimits};

/// Where a number of the minimum lies.
#[derive(Clone, Copy, PartialEq)]
enum At {
    Lower,
    Free,
    Upper,
}

/// The minimum of ½ dᵀ H d + gᵀ d in a box: of the 3ᵐ ways to clamp, the one whose free part is
/// stationary and whose slopes at the limits point outwards.
pub(crate) fn by_enumeration(
    h: &DMatrix<f64>,
    g: &DVector<f64>,
    lower: f64,
    upper: f64,
) -> DVector<f64> {
    let m = g.len();
    for code in 0..3_usize.pow(u32::try_from(m).expect("few")) {
        let at = |i: usize| match code / 3_usize.pow(u32::try_from(i).expect("few")) % 3 {
            0 => At::Lower,
            1 => At::Free,
            _ => At::Upper,
        };
        let mut d = DVector::from_fn(m, |i, _| match at(i) {
            At::Lower => lower,
            At::Free => 0.0,
            At::Upper => upper,
        });
        let free: Vec<usize> = (0..m).filter(|i| at(*i) == At::Free).collect();
        if !free.is_empty() {
            let rest = (g + h * &d).select_rows(&free);
            let inner = h.select_rows(&free).select_columns(&free);
            let moved = inner.lu().solve(&-rest).expect("positive definite");
            free.iter().zip(&moved).for_each(|(i, x)| d[*i] = *x);
        }
        let slope = g + h * &d;
        let good = (0..m).all(|i| match at(i) {
            At::Lower => slope[i] >= 0.0,
            At::Free => (lower..=upper).contains(&d[i]),
            At::Upper => slope[i] <= 0.0,
        });
        if good {
            return d;
        }
    }
    unreachable!("a strictly convex problem has a minimum")
}

/// A positive definite matrix and a gradient that look random.
fn problem(m: usize, seed: usize) -> (DMatrix<f64>, DVector<f64>) {
    let wave = |i: usize, j: usize| (1.3 * (i * i) as f64 + 2.7 * j as f64 + seed as f64).sin();
    let root = DMatrix::from_fn(m, m, wave);
    let h = root.tr_mul(&root) + DMatrix::identity(m, m) * 0.05;
    (h, DVector::from_fn(m, |i, _| 2.0 * wave(i + 5, 3)))
}

#[test]
fn minimum_and_what_is_free() {
    let mut clamped = 0;
    for (m, seed) in (1..=5).flat_map(|m| (0..40).map(move |seed| (m, seed))) {
        let (h, g) = problem(m, seed);
        let limits = ControlLimits::new(vec![-0.6; m], vec![0.4; m]).expect("limits");
        let exact = by_enumeration(&h, &g, -0.6, 0.4);
        for start in [-1.0, 0.0, 0.3] {
            let start = DVector::from_element(m, start);
            let found = BoxQp { hessian: &h, gradient: &g, limits: &limits }.solve(&start);
            let found = found.expect("positive definite");
            let off = (&found.minimum - &exact).amax();
            assert!(off <= 1e-12, "m = {m}, seed {seed}: off by {off:e}");
            clamped += m - found.free.len();
        }
    }
    assert!(clamped > 300, "only {clamped} limits were met");
}

/// A gradient G x moves the free part of the minimum by −H_ff⁻¹ G_f x.
#[test]
fn sensitivity() {
    let (h, g) = problem(4, 2);
    let limits = ControlLimits::new(vec![-0.6; 4], vec![0.4; 4]).expect("limits");
    let solve = |g: &DVector<f64>| {
        let problem = BoxQp { hessian: &h, gradient: g, limits: &limits };
        problem.solve(&DVector::zeros(4)).expect("positive definite")
    };
    let by = DMatrix::from_fn(4, 1, |i, _| 1.0 - 0.4 * i as f64);
    let found = solve(&g);
    assert!((1..4).contains(&found.free.len()), "{:?} are free", found.free);
    let moved = solve(&(&g + by.column(0) * 1e-4)).minimum - &found.minimum;
    let off = (found.sensitivity(&by).column(0) * 1e-4 - moved).amax();
    assert!(off <= 1e-15, "off by {off:e}");
}

#[test]
fn not_positive_definite() {
    let h = DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 1.0]);
    let g = DVector::from_vec(vec![1.0, -1.0]);
    let limits = ControlLimits::none(2);
    let problem = BoxQp { hessian: &h, gradient: &g, limits: &limits };
    assert!(problem.solve(&DVector::zeros(2)).is_none());
    let nan = DMatrix::from_element(2, 2, f64::NAN);
    let problem = BoxQp { hessian: &nan, gradient: &g, limits: &limits };
    assert!(problem.solve(&DVector::zeros(2)).is_none());
}

#[test]
fn a_start_that_is_all_but_at_a_limit() {
    let (h, g) = (DMatrix::from_element(1, 1, 0.9), DVector::from_element(1, 0.003));
    let limits = ControlLimits::new(vec![0.0], vec![1.0]).expect("limits");
    let start = DVector::from_element(1, 6e-17);
    let found = BoxQp { hessian: &h, gradient: &g, limits: &limits }.solve(&start);
    let found = found.expect("positive definite");
    assert_eq!((found.minimum[0], found.free.len()), (0.0, 0));
}
