//! Newton's equations by bodies, against the rows' own matrix.

use nalgebra::{DMatrix, DVector};
use tangency_lcp::{Added, BodySystem, BoxForm, BoxLaw, Lcp, Metric, Scratch};

use crate::problems::{chain, near, stack};

/// Ŵ and D in the order of the problem's rows.
fn dense(problem: &Lcp, metric: &Metric, added: Added) -> (DMatrix<f64>, DMatrix<f64>) {
    let form = BoxForm::of_rows(problem, metric);
    let n = form.len();
    let (mut W, mut D) = (DMatrix::zeros(n, n), DMatrix::zeros(n, n));
    for i in 0..n {
        let row = form.rows[i] as usize;
        for j in 0..n {
            W[(row, form.rows[j] as usize)] = form.entry(i, j);
        }
        D[(row, row)] = added.d[row];
        if let BoxLaw::Friction { normal, .. } = form.laws[i] {
            D[(row, form.rows[normal] as usize)] = added.e[row];
        }
    }
    (W, D)
}

fn wave(n: usize, phase: f64) -> Vec<f64> {
    (0..n).map(|i| (1.7 * i as f64 + phase).sin()).collect()
}

fn check(problem: &Lcp, scratch: &mut Scratch) {
    let metric = Metric::new(problem);
    let mut system = BodySystem::new(problem, &metric, scratch).expect("bodies of its own");
    let n = problem.rows.len();
    let free = |i: usize| system.laws[i] == BoxLaw::Free;
    let sliding = |i: usize| matches!(system.laws[i], BoxLaw::Friction { .. });
    let d: Vec<f64> = (0..n).map(|i| if free(i) { 0.0 } else { 0.3 + 0.1 * i as f64 }).collect();
    let e: Vec<f64> = (0..n).map(|i| if sliding(i) { 0.2 } else { 0.0 }).collect();
    let added = Added { d: &d, e: &e };
    let (W, D) = dense(problem, &metric, added);
    let (y, mut product) = (wave(n, 0.3), vec![0.0; n]);
    system.times(&y, &mut product);
    near(&product, (&W * DVector::from_column_slice(&y)).as_slice(), 1e-13);
    system.factor(added, scratch);
    let (rhs, mut found) = (wave(n, 0.9), vec![0.0; n]);
    assert!(system.solve(added, &rhs, &mut found));
    let back = (W + D) * DVector::from_column_slice(&found);
    near(back.as_slice(), &rhs, 1e-6);
    system.give(scratch);
}

#[test]
fn products_and_solutions_are_those_of_the_rows() {
    let mut scratch = Scratch::default();
    let mut soft = stack(&[1.0, 2.0, 3.0]);
    soft.rows[3].compliance = 0.25;
    for problem in [stack(&[1.0, 2.0, 3.0]), soft, chain(10, 1), stack(&[1.0, 1e4])] {
        check(&problem, &mut scratch);
    }
}
