//! Reduced systems: against dense algebra, with dependent rows, under large mass ratios.

use nalgebra::{DMatrix, DVector};
use tangency_lcp::{ActiveSystem, Law, Lcp, LcpError, Metric, Mode, solve_linear};

use crate::problems::{V, body, chain, near, row, solve, stack, supported};

/// J, m × 3n.
fn jacobian(problem: &Lcp) -> DMatrix<f64> {
    let mut J = DMatrix::zeros(problem.rows.len(), 3 * problem.mass.len());
    for (i, row) in problem.rows.iter().enumerate() {
        for (body, block) in row.blocks() {
            for k in 0..3 {
                J[(i, 3 * body + k)] += block[k];
            }
        }
    }
    J
}

fn flat(blocks: &[V]) -> DVector<f64> {
    DVector::from_iterator(3 * blocks.len(), blocks.iter().flat_map(|block| block.iter().copied()))
}

#[test]
fn delassus_is_the_dense_product() {
    let mut problem = stack(&[1.0, 2.0, 3.0]);
    problem.rows[3].compliance = 0.25;
    let (W, q) = problem.delassus();
    let J = jacobian(&problem);
    let M = DMatrix::from_diagonal(&flat(&problem.mass));
    let mut wanted = &J * M.try_inverse().expect("masses") * J.transpose();
    wanted[(3, 3)] += 0.25;
    near(W.as_slice(), wanted.as_slice(), 1e-13);
    near(q.as_slice(), (J * flat(&problem.free_velocities())).as_slice(), 1e-14);
}

#[test]
fn chain_against_a_dense_saddle_system() {
    let problem = chain(10, 1);
    let solution = solve_linear(&problem).expect("regular");
    let (J, n) = (jacobian(&problem), 30);
    let mut K = DMatrix::zeros(50, 50);
    K.view_mut((0, 0), (n, n)).set_diagonal(&flat(&problem.mass));
    K.view_mut((0, n), (n, 20)).copy_from(&-J.transpose());
    K.view_mut((n, 0), (20, n)).copy_from(&J);
    let mut right = DVector::zeros(50);
    right.rows_mut(0, n).copy_from(&flat(&problem.momentum));
    let wanted = K.lu().solve(&right).expect("regular");
    near(flat(&solution.velocities).as_slice(), &wanted.as_slice()[..n], 1e-12);
    near(&solution.impulses, &wanted.as_slice()[n..], 1e-12);
    assert!(problem.residual(&solution).max() < 1e-14);
}

#[test]
fn joints_entered_several_times_move_alike() {
    let once = solve_linear(&chain(10, 1)).expect("regular");
    for copies in [2, 5] {
        let problem = chain(10, copies);
        let solution = solve_linear(&problem).expect("consistent");
        near(flat(&solution.velocities).as_slice(), flat(&once.velocities).as_slice(), 1e-13);
        let system = solution.system.expect("kept");
        assert_eq!(system.rank_defect() as usize, 20 * (copies - 1));
        let joint: f64 = (0..copies).map(|copy| solution.impulses[2 * copy + 1]).sum();
        near(&[joint], &[once.impulses[1]], 1e-12);
    }
}

#[test]
fn contradicting_equations_are_infeasible() {
    let mut problem = chain(3, 2);
    problem.rows[2].rhs = 0.1;
    let error = solve_linear(&problem).expect_err("the first joint contradicts its copy");
    assert!(matches!(error, LcpError::Infeasible { residual } if residual > 1e-3), "{error}");
}

#[test]
fn without_rows_the_momentum_decides() {
    let mut problem = chain(2, 1);
    problem.rows.clear();
    let solution = solve_linear(&problem).expect("free");
    assert_eq!(solution.velocities, problem.free_velocities());
    assert_eq!(problem.residual(&solution).max(), 0.0);
}

#[test]
fn transposed_solve_is_the_transpose() {
    // Two sliding supports of a tilted box: S is not symmetric.
    let mut problem = supported(2, 3.0, 0.4);
    problem.rows[1].jacobian[1].z = 0.9;
    problem.rows[2].compliance = 0.3;
    let modes = [Mode::Active, Mode::Lower, Mode::Active, Mode::Lower];
    let system = ActiveSystem::new(&problem, &Metric::new(&problem), &modes);
    let (a_v, a_y) = (V::new(0.3, -0.7, 0.2), [0.5, -0.1]);
    let (b_v, b_y) = (V::new(-0.2, 0.9, 0.4), [0.8, 0.6]);
    let forward = system.solve_with(&problem, &[a_v], &a_y);
    let backward = system.solve_transpose(&problem, &[b_v], &b_y);
    let dot = |v: &V, y: &[f64], w: &V, z: &[f64]| v.dot(w) + y[0] * z[0] + y[1] * z[1];
    let left = dot(&forward.velocities[0], &forward.impulses, &b_v, &b_y);
    let right = dot(&backward.velocities[0], &backward.impulses, &a_v, &a_y);
    near(&[left], &[right], 1e-13);
    let wrong = system.solve_with(&problem, &[b_v], &b_y.map(|y| -y));
    assert!((wrong.velocities[0] - backward.velocities[0]).norm() > 1e-2);
}

#[test]
fn heavy_on_light() {
    for exponent in [3, 6, 8] {
        let ratio = 10_f64.powi(exponent);
        let problem = stack(&[1.0, ratio]);
        let solution = solve(&problem);
        for v in &solution.velocities {
            near(v.as_slice(), &[0.0; 3], 1e-12);
        }
        let floor = solution.impulses[0] + solution.impulses[2];
        let between = solution.impulses[4] + solution.impulses[6];
        near(&[floor / (0.1 * (1.0 + ratio)), between / (0.1 * ratio)], &[1.0; 2], 1e-10);
    }
}

#[test]
fn scrambled_rows_are_reordered_to_a_band() {
    let problem = chain(40, 1);
    let mut scrambled = problem.clone();
    scrambled.rows = (0..80).map(|k| problem.rows[(k * 37 + 11) % 80].clone()).collect();
    let (a, b) = (solve_linear(&problem), solve_linear(&scrambled));
    let (a, b) = (a.expect("regular"), b.expect("regular"));
    near(flat(&a.velocities).as_slice(), flat(&b.velocities).as_slice(), 1e-11);
}

#[test]
fn a_row_without_influence_is_harmless_or_infeasible() {
    let mut problem = chain(2, 1);
    problem.rows.push(row([0.0; 3], 0.0, Law::Equality));
    solve_linear(&problem).expect("0 = 0");
    problem.rows[4].rhs = 1.0;
    solve_linear(&problem).expect_err("0 = 1");
}

#[test]
fn nearly_coincident_pins_hold_a_rod() {
    // A rod of length 1 pinned at x = 0 and x = 1e-8: its weight needs a couple of 10⁷.
    let pin = |x: f64| {
        [row([1.0, 0.0, 0.0], 0.0, Law::Equality), row([0.0, 1.0, x - 0.5], 0.0, Law::Equality)]
    };
    let rows = [pin(0.0), pin(1e-8)].concat();
    let problem = body([1.0, 1.0, 1.0 / 12.0], [0.0, -0.1, 0.0], rows);
    let solution = solve_linear(&problem).expect("held");
    near(solution.velocities[0].as_slice(), &[0.0; 3], 1e-8);
    assert!(problem.residual(&solution).max() <= 1e-10);
}

#[test]
fn nearly_parallel_slopes_share_the_weight() {
    for exponent in 2..=10 {
        let slope = 10_f64.powi(-exponent);
        let normal = |side: f64| row([-side * slope.sin(), slope.cos(), 0.0], 0.0, Law::Unilateral);
        let problem = body([1.0; 3], [0.0, -0.1, 0.0], vec![normal(-1.0), normal(1.0)]);
        let solution = solve(&problem);
        near(solution.velocities[0].as_slice(), &[0.0; 3], 1e-12);
        near(&solution.impulses, &[0.05 / slope.cos(); 2], 1e-7);
    }
}
