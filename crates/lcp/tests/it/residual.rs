//! The natural residual: zero at solutions, free of units, blind to slacks and modes.

use tangency_lcp::{Law, Lcp, LcpSolution, Mode};

use crate::problems::{V, body, disc, row, solve, stack, supported};

#[test]
fn parts_of_a_candidate_by_hand() {
    // W = 1 and 3, s* = 1: |p| = 1 over √M = 1.
    let problem = disc(1.0);
    let at_rest = LcpSolution {
        velocities: vec![V::zeros()],
        impulses: vec![0.0; 2],
        slacks: vec![9.0; 2],
        modes: vec![Mode::Upper; 2],
        ..LcpSolution::default()
    };
    let residual = problem.residual(&at_rest);
    assert_eq!((residual.momentum, residual.unilateral, residual.friction), (1.0, 0.0, 0.0));
    let free = LcpSolution { velocities: problem.free_velocities(), ..at_rest };
    let residual = problem.residual(&free);
    assert_eq!((residual.momentum, residual.unilateral, residual.friction), (0.0, 0.1, 0.0));
    assert_eq!(residual.max(), 0.1);
}

#[test]
fn zero_over_zero_is_zero_and_nan_is_infinite() {
    let rows = vec![row([0.0, 1.0, 0.0], 0.0, Law::Unilateral)];
    let problem = body([1.0; 3], [0.0; 3], rows);
    let mut solution = solve(&problem);
    assert_eq!(problem.residual(&solution).max(), 0.0);
    solution.velocities[0].y = f64::NAN;
    assert_eq!(problem.residual(&solution).max(), f64::INFINITY);
    solution.velocities[0].y = -1.0;
    assert_eq!(problem.residual(&solution).max(), f64::INFINITY);
}

/// The problem in units of length 2^l, mass 2^m and time 2^t; all rows are in m/s.
fn in_units(problem: &Lcp, [l, m, t]: [i32; 3]) -> Lcp {
    let (length, mass, time) = (2_f64.powi(l), 2_f64.powi(m), 2_f64.powi(t));
    let inertia = V::new(mass, mass, mass * length * length);
    let momentum = inertia.component_mul(&V::new(length, length, 1.0)) / time;
    let mut scaled = problem.clone();
    for (M, p) in scaled.mass.iter_mut().zip(&mut scaled.momentum) {
        *M = M.component_mul(&inertia);
        *p = p.component_mul(&momentum);
    }
    for row in &mut scaled.rows {
        for block in &mut row.jacobian {
            block.z *= length;
        }
        row.rhs *= length / time;
        row.compliance /= mass;
    }
    scaled
}

fn solution_in_units(solution: &LcpSolution, [l, m, t]: [i32; 3]) -> LcpSolution {
    let (length, mass, time) = (2_f64.powi(l), 2_f64.powi(m), 2_f64.powi(t));
    let mut scaled = solution.clone();
    for v in &mut scaled.velocities {
        *v = v.component_mul(&V::new(length, length, 1.0)) / time;
    }
    scaled.impulses.iter_mut().for_each(|impulse| *impulse *= mass * length / time);
    scaled
}

#[test]
fn units_change_neither_residual_nor_modes() {
    let problems = [disc(1.0), supported(3, 0.3, 0.5), stack(&[1.0, 10.0, 0.1])];
    for problem in problems {
        let mut solution = solve(&problem);
        let reference = solution.clone();
        solution.velocities[0] += V::new(1e-3, -2e-3, 3e-3);
        solution.impulses[0] *= 1.01;
        let residual = problem.residual(&solution);
        assert!(residual.max() > 1e-4);
        let alone = [[20, 0, 0], [-20, 0, 0], [0, 20, 0], [0, -20, 0], [0, 0, 10]];
        let odd = [[0, 1, 0], [0, -19, 0], [7, -9, 11]];
        for units in alone.into_iter().chain(odd).chain([[6, -8, -10]]) {
            let scaled = in_units(&problem, units);
            assert_eq!(
                scaled.residual(&solution_in_units(&solution, units)),
                residual,
                "{units:?}"
            );
            let again = solve(&scaled);
            let wanted = solution_in_units(&reference, units);
            assert_eq!((again.velocities, again.impulses), (wanted.velocities, wanted.impulses));
            assert_eq!(again.modes, wanted.modes);
        }
    }
}
