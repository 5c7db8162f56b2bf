//! Smoothed derivatives: a closed form (V35), the two modes against each other and against differences.

use std::sync::Arc;

use tangency_lcp::CentralPoint;

use super::*;

fn central(problem: &Lcp, near: &LcpSolution, energy: f64) -> CentralPoint {
    CentralPoint::new(problem, near, energy, &mut Scratch::default()).expect("a point")
}

/// The solution with its point of energy ε.
fn softened(problem: &Lcp, solution: &LcpSolution, energy: f64) -> LcpSolution {
    let central = Some(Arc::new(central(problem, solution, energy)));
    LcpSolution { central, ..solution.clone() }
}

/// V35 (d): of z (z + q) = τ, dz/dq = −(1 − q/√(q² + 4τ))/2.
#[test]
fn one_softened_row_has_a_closed_form() {
    for q in [-2.0, -0.1, 0.0, 0.1, 2.0] {
        for tau in [1e-6_f64, 1e-3, 0.2] {
            let rows = vec![row([1.0, 0.0, 0.0], 0.0, Law::Unilateral)];
            let problem = body([1.0; 3], [q, 0.0, 0.0], rows);
            let solution = softened(&problem, &solve(&problem), tau);
            let exact = -(1.0 - q / (q * q + 4.0 * tau).sqrt()) / 2.0;
            let (bar, report) =
                lcp_vjp(&problem, &solution, &[V::zeros()], Some(&[1.0])).expect("vjp");
            near(&[bar.momentum[0].x], &[exact], 1e-10);
            assert_eq!(report.weak, []);
            let mut tangent = LcpVector::zeros(&problem);
            tangent.momentum[0].x = 1.0;
            let (_, d_impulses) = lcp_jvp(&problem, &solution, &tangent).expect("jvp");
            near(&d_impulses, &[exact], 1e-10);
        }
    }
}

fn flat(vectors: &[V]) -> impl Iterator<Item = f64> {
    vectors.iter().flat_map(|v| [v.x, v.y, v.z])
}

/// (8 (f(h) − f(−h)) − (f(2h) − f(−2h)))/12h.
fn fourth_order(h: f64, f: impl Fn(f64) -> Vec<f64>) -> Vec<f64> {
    let [one, back, two, back_two] = [h, -h, 2.0 * h, -2.0 * h].map(f);
    let difference = |i: usize| (8.0 * (one[i] - back[i]) - (two[i] - back_two[i])) / (12.0 * h);
    (0..one.len()).map(difference).collect()
}

/// Of the softened laws, every one by everything: both modes, and fourth-order differences.
#[test]
fn softened_random_problems_in_both_modes_and_against_differences() {
    let mut checked = 0;
    for seed in 0..100 {
        let problem = random_problem(seed);
        let Some(solution) = try_solve(&problem) else { continue };
        let mut random = Random(seed);
        let velocity_bar: Vec<V> = (0..3).map(|_| random.vector(1.0)).collect();
        let impulse_bar: Vec<f64> =
            problem.rows.iter().map(|_| random.between(-1.0, 1.0)).collect();
        let tangent = random_tangent(&problem, seed);
        for kappa in [1e-4_f64, 1e-2, 0.3] {
            let energy = CentralPoint::energy(&problem, kappa);
            let soft = softened(&problem, &solution, energy);
            let (bar, _) =
                lcp_vjp(&problem, &soft, &velocity_bar, Some(&impulse_bar)).expect("vjp");
            let (dv, d_impulses) = lcp_jvp(&problem, &soft, &tangent).expect("jvp");
            let forward = along(&velocity_bar, &dv)
                + impulse_bar.iter().zip(&d_impulses).map(|(a, b)| a * b).sum::<f64>();
            let scale = (1.0 + forward.abs()) * (1.0 + size(&dv));
            near(&[bar.dot(&tangent)], &[forward], 1e-12 * scale);

            let exact: Vec<f64> = flat(&dv).chain(d_impulses).collect();
            let off = [1e-3, 2e-4, 4e-5].map(|share| {
                let h = share * kappa.sqrt();
                let found = fourth_order(h, |h| {
                    let point = central(&moved(&problem, &tangent, h), &solution, energy).solution;
                    flat(&point.velocities).chain(point.impulses).collect()
                });
                let apart = |(a, b): (&f64, &f64)| (a - b).abs();
                exact.iter().zip(&found).map(apart).fold(0.0, f64::max)
            });
            let size = exact.iter().fold(1.0, |size: f64, x| size.max(x.abs()));
            let least = off.into_iter().fold(f64::INFINITY, f64::min);
            assert!(least <= 1e-7 * size, "{seed}, kappa {kappa}: off by {off:?} of {size}");
            checked += 1;
        }
    }
    assert!(checked > 200, "{checked}");
}

/// Away from switches the smoothed derivative is off by O(κ).
#[test]
fn smoothing_fades_with_kappa() {
    let mut checked = 0;
    for seed in 0..100 {
        let problem = random_problem(seed);
        let Some(solution) = try_solve(&problem) else { continue };
        let margin = problem.margins(&solution).into_iter().fold(f64::INFINITY, f64::min);
        if margin < 0.05 {
            continue;
        }
        let tangent = random_tangent(&problem, seed);
        let (exact, _) = lcp_jvp(&problem, &solution, &tangent).expect("jvp");
        let off = |kappa: f64| {
            let mut soft = solution.clone();
            GradientMode::Smoothed { kappa }
                .prepare_solution(&problem, &mut soft)
                .expect("a point");
            let (dv, _) = lcp_jvp(&problem, &soft, &tangent).expect("jvp");
            dv.iter().zip(&exact).fold(0.0, |off: f64, (a, b)| off.max((a - b).amax()))
        };
        let [far, near] = [1e-7, 1e-8].map(off);
        assert!(near <= 1e-4 * (1.0 + size(&exact)), "{seed}: off by {near:e}");
        assert!((near / far - 0.1).abs() < 0.02, "{seed}: off by {far:e} and {near:e}");
        checked += 1;
    }
    assert!(checked > 20, "{checked}");
}

#[test]
fn smoothing_is_taken_back() {
    let problem = supported(1.0);
    let exact = solve(&problem);
    let mut solution = exact.clone();
    let gradient = |at: &LcpSolution| lcp_vjp(&problem, at, &[V::x()], None).expect("vjp");
    GradientMode::Smoothed { kappa: 1e-2 }.prepare_solution(&problem, &mut solution).expect("ok");
    assert_ne!(gradient(&solution), gradient(&exact));
    assert_eq!(solution, exact);
    GradientMode::Exact.prepare_solution(&problem, &mut solution).expect("ok");
    assert_eq!(gradient(&solution), gradient(&exact));
}

#[test]
fn wrong_kappas_are_refused() {
    let problem = disc(1.0);
    let mut solution = solve(&problem);
    for kappa in [0.0, -1.0, f64::INFINITY] {
        let mode = GradientMode::Smoothed { kappa };
        let refused = mode.prepare_solution(&problem, &mut solution).expect_err("refused");
        assert_eq!(refused, LcpDiffError::Kappa { kappa });
    }
}
