//! Mixed problems: exact answers, guesses, determinism, refusals, infeasibility.

use nalgebra::Vector3;
use tangency_lcp::{
    Guess, Law, Lcp, LcpError, LcpSolver, Method, Mode, NO_BODY, Row, Scratch, solve_checked,
};
use tangency_lcp_ipm::InteriorPoint;

use tangency_bench::problems::{CLASSES, Random, stack};

type V = Vector3<f64>;

fn row(jacobian: [f64; 3], rhs: f64, law: Law) -> Row {
    let jacobian = [V::zeros(), V::from(jacobian)];
    Row { bodies: [NO_BODY, 0], jacobian, rhs, compliance: 0.0, law }
}

fn body(mass: [f64; 3], momentum: [f64; 3], rows: Vec<Row>) -> Lcp {
    Lcp { mass: vec![V::from(mass)], momentum: vec![V::from(momentum)], rows }
}

fn solve(problem: &Lcp) -> Result<tangency_lcp::LcpSolution, LcpError> {
    let solver = InteriorPoint::default();
    solve_checked(&solver, problem, None, &mut Scratch::default(), 1e-10).map(|(found, _)| found)
}

/// V31's mixed problem.
fn mixed() -> Lcp {
    let rows = vec![
        row([1.0, 0.0, 1.0], 0.0, Law::Equality),
        row([0.0, 1.0, -1.0], 0.0, Law::Unilateral),
        row([0.0, 1.0, 1.0], -4.0, Law::Unilateral),
    ];
    body([2.0, 2.0, 1.0], [4.0, -4.0, 1.0], rows)
}

#[test]
fn mixed_problem() {
    let mut problem = mixed();
    for _ in 0..2 {
        let found = solve(&problem).expect("solved");
        assert!((found.velocities[0] - V::new(1.4, -1.4, -1.4)).amax() < 1e-13);
        assert!((found.impulses[1] - 1.2).abs() < 1e-13 && found.impulses[2] == 0.0);
        problem.rows.push(row([1.0, 0.0, 1.0], 0.0, Law::Equality));
    }
}

#[test]
fn contradicting_equalities_are_infeasible() {
    let mut problem = mixed();
    problem.rows.push(row([1.0, 0.0, 1.0], 0.1, Law::Equality));
    let error = solve(&problem).expect_err("infeasible");
    assert!(matches!(error, LcpError::Infeasible { residual } if residual > 1e-3), "{error}");
}

#[test]
fn a_piston_against_a_wall_is_infeasible() {
    let rows = vec![
        row([-1.0, 0.0, 0.0], 0.0, Law::Unilateral),
        row([1.0, 0.0, 0.0], 1.0, Law::Unilateral),
        row([0.0, 1.0, 0.0], 0.0, Law::Friction { normal: 0, mu: 0.5 }),
    ];
    let error = solve(&body([1.0; 3], [0.0, 0.3, 0.0], rows)).expect_err("infeasible");
    assert!(matches!(error, LcpError::Infeasible { .. }), "{error}");
}

#[test]
fn painleve_rods() {
    let rows = vec![
        row([0.0, 1.0, 0.6], 0.0, Law::Unilateral),
        row([1.0, 0.0, 0.8], 0.0, Law::Friction { normal: 0, mu: 2.0 }),
    ];
    let mut problem = body([1.0, 1.0, 1.0 / 3.0], [1.0, -0.1, 0.0], rows);
    let found = solve(&problem).expect("solved").impulses;
    assert!((found[0] - 0.433).abs() < 1e-13 && (found[1] + 0.556).abs() < 1e-13);
    problem.momentum[0].y = 0.1;
    assert_eq!(solve(&problem).expect("solved"), solve(&problem).expect("solved"));
}

#[test]
fn a_good_guess_costs_one_factorisation_and_a_bad_one_no_accuracy() {
    let solver = InteriorPoint::default();
    for seed in 0..20 {
        let problem = stack(&mut Random(seed), 1.0);
        let cold = solve(&problem).expect("solved");
        let guess = Guess { modes: cold.modes.clone(), impulses: cold.impulses.clone() };
        let scratch = &mut Scratch::default();
        let warm = solver.solve(&problem, Some(&guess), scratch).expect("solved");
        assert_eq!(warm.stats.iterations, 0);
        let wrong = Guess { modes: vec![Mode::Open; problem.rows.len()], impulses: vec![f64::NAN] };
        let other = solver.solve(&problem, Some(&wrong), scratch).expect("solved");
        for (a, b) in cold.velocities.iter().zip(&other.velocities) {
            assert!((a - b).amax() < 1e-9, "{a} {b}");
        }
        let short = Guess { modes: vec![Mode::Open], impulses: Vec::new() };
        assert_eq!(solver.solve(&problem, Some(&short), scratch).expect("solved"), cold);
    }
}

#[test]
fn same_problem_same_bits() {
    for (_, class) in CLASSES {
        let problem = class(&mut Random(17));
        let (a, b) = (solve(&problem), solve(&problem));
        assert_eq!(a.ok(), b.ok());
    }
}

#[test]
fn memory_that_was_used_gives_the_same_bits() {
    let alone = InteriorPoint { cold_modes: false, ..InteriorPoint::default() };
    let mut used = Scratch::default();
    for (_, class) in CLASSES {
        for seed in 0..5 {
            let problem = class(&mut Random(seed));
            for solver in [alone, InteriorPoint::default()] {
                let again = solver.solve(&problem, None, &mut used).expect("solved");
                let fresh = solver.solve(&problem, None, &mut Scratch::default());
                assert_eq!(again, fresh.expect("solved"));
                used.recycle(again);
            }
        }
    }
}

/// Without modes read at the free velocities: the same velocities, and few iterations.
#[test]
fn the_interior_point_alone() {
    let alone = InteriorPoint { cold_modes: false, ..InteriorPoint::default() };
    for seed in 0..100 {
        let problem = stack(&mut Random(seed), 1.0);
        let found = alone.solve(&problem, None, &mut Scratch::default()).expect("solved");
        assert!(problem.residual(&found).max() <= 1e-10, "seed {seed}");
        assert_eq!(found.stats.method, Method::InteriorPoint);
        assert!(found.stats.iterations <= 12, "seed {seed}: {}", found.stats.iterations);
    }
}

#[test]
fn broken_problems_are_refused() {
    let mut problem = mixed();
    problem.momentum[0].x = f64::NAN;
    let refused = InteriorPoint::default().solve(&problem, None, &mut Scratch::default());
    assert!(matches!(refused, Err(LcpError::NotFinite { what: "momentum", index: 0 })));
}
