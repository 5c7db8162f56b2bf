//! Minimisers on functions whose least values are known.

use nalgebra::{DMatrix, DVector};
use tangency_control::{
    Bounds, GaussNewton, GradientDescent, Lbfgs, LeastSquares, Objective, Residuals, Slope,
};

use crate::linear::Never;

/// Rosenbrock (1960): r = (10 (y − x²), 1 − x), least at (1, 1).
struct Valley;

impl LeastSquares for Valley {
    type Error = Never;

    fn linearise(&mut self, point: &[f64]) -> Result<Residuals, Never> {
        let [x, y] = [point[0], point[1]];
        let values = DVector::from_column_slice(&[10.0 * (y - x * x), 1.0 - x]);
        let jacobian = DMatrix::from_row_slice(2, 2, &[-20.0 * x, 10.0, -1.0, 0.0]);
        Ok(Residuals { values, jacobian })
    }
}

impl Objective for Valley {
    type Error = Never;

    fn evaluate(&mut self, point: &[f64]) -> Result<Slope, Never> {
        let here = self.linearise(point)?;
        let gradient = 2.0 * here.jacobian.tr_mul(&here.values);
        Ok(Slope { loss: here.loss(), gradient: gradient.as_slice().to_vec() })
    }
}

const START: [f64; 2] = [-1.2, 1.0];

#[track_caller]
fn check(found: &[f64], exact: [f64; 2], tolerance: f64) {
    for (found, exact) in found.iter().zip(exact) {
        assert!((found - exact).abs() <= tolerance, "{found} is not {exact}");
    }
}

#[test]
fn finds_the_bottom_of_the_valley() {
    let found = Lbfgs::unbounded(2).minimise(&mut Valley, &START, &mut |_| ()).expect("a search");
    check(&found[found.len() - 1].point, [1.0; 2], 1e-8);
    assert!(found.windows(2).all(|pair| pair[1].loss <= pair[0].loss));
    let search = GaussNewton::unbounded(2);
    let found = search.minimise(&mut Valley, &START, &mut |_| ()).expect("a search");
    check(&found[found.len() - 1].point, [1.0; 2], 1e-12);
}

/// With x ≤ ½ the least value is at (½, ¼), at 1/4; with y ≤ ½ where d/dx (100 (½ − x²)² + (1 − x)²) = 0.
#[test]
fn stays_within_bounds() {
    let half = Bounds { lower: f64::NEG_INFINITY, upper: 0.5 };
    let search = Lbfgs { bounds: vec![half, Bounds::FREE], memory: 10, iterations: 2000 };
    let found = search.minimise(&mut Valley, &START, &mut |_| ()).expect("a search");
    let last = &found[found.len() - 1];
    assert!(last.point[0] <= 0.5);
    check(&last.point, [0.5, 0.25], 1e-4);
    let both = Bounds { lower: -2.0, upper: 0.5 };
    let search = GaussNewton { bounds: vec![both, Bounds::POSITIVE], iterations: 200 };
    let found = search.minimise(&mut Valley, &[0.0, 0.5], &mut |_| ()).expect("a search");
    let last = &found[found.len() - 1];
    check(&last.point, [0.5, 0.25], 1e-4);
    assert!(found.iter().all(|iterate| iterate.point[0] <= 0.5 && iterate.point[1] > 0.0));
}

/// L = ½ Σ aᵢ pᵢ².
struct Bowl([f64; 2]);

impl Objective for Bowl {
    type Error = Never;

    fn evaluate(&mut self, point: &[f64]) -> Result<Slope, Never> {
        let terms = self.0.iter().zip(point);
        let loss = terms.clone().map(|(a, p)| 0.5 * a * p * p).sum();
        Ok(Slope { loss, gradient: terms.map(|(a, p)| a * p).collect() })
    }
}

/// pᵢ (1 − rate aᵢ)ᵏ after k updates; the first two of the second number are clipped to rate · clip.
#[test]
fn descends_geometrically() {
    let descent = GradientDescent { rate: 0.1, clip: 2.0, iterations: 9 };
    let found =
        descent.minimise(&mut Bowl([1.0, 3.0]), &[1.0, 1.0], &mut |_| ()).expect("a search");
    assert_eq!(found.len(), 10);
    check(&found[9].point, [0.9_f64.powi(9), 0.6 * 0.7_f64.powi(7)], 1e-15);
}

/// Nothing to do: the search ends where it begins.
#[test]
fn stops_where_nothing_slopes() {
    let found = Lbfgs::unbounded(2).minimise(&mut Bowl([1.0; 2]), &[0.0; 2], &mut |_| ());
    assert_eq!(found.expect("a search").len(), 1);
}
