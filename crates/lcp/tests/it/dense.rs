//! The paper's matrices, and solutions converted both ways.

use tangency_lcp::{Law, Lcp, LcpError, Mode};

use crate::problems::{V, between, disc, near, row, solve, stack, supported};

#[test]
fn matrices_of_one_contact() {
    let mut problem = disc(1.0);
    problem.rows[0].rhs = -0.25;
    problem.rows[1].rhs = 0.5;
    problem.rows.push(row([0.0, 0.0, 1.0], 2.0, Law::Equality));
    let form = problem.to_dense().expect("in the paper's form");
    near(form.M.diagonal().as_slice(), &[1.0, 1.0, 0.5], 0.0);
    near(form.A.as_slice(), &[0.0, 0.0, 1.0], 0.0);
    let G = form.G.transpose();
    let tangents = [1.0, 0.0, 1.0, -1.0, 0.0, -1.0];
    near(&G.as_slice()[..9], &[&[0.0, 1.0, 0.0][..], &tangents].concat(), 0.0);
    near(&G.as_slice()[9..], &[0.0; 3], 0.0);
    let F = form.F.transpose();
    let rows = [[0.0; 4], [0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0], [0.5, -1.0, -1.0, 0.0]];
    near(F.as_slice(), &rows.concat(), 0.0);
    near(form.q.as_slice(), &[1.0, -0.1, 0.0], 0.0);
    near(form.m.as_slice(), &[0.25, -0.5, 0.5, 0.0], 0.0);
    near(form.d.as_slice(), &[-2.0], 0.0);
}

fn hinged_stack() -> Lcp {
    let mut problem = stack(&[1.0, 3.0, 0.5]);
    problem.momentum[2] = V::new(0.7, -0.05, 0.2);
    let blocks = [[-1.0, 0.0, 1.0], [1.0, 0.0, 0.3]];
    problem.rows.push(between([0, 1], blocks, 0.0, Law::Equality));
    problem.rows.push(row([1.0, 0.0, 0.0], -0.2, Law::Unilateral));
    problem
}

#[test]
fn solutions_satisfy_the_papers_system() {
    let problems =
        [disc(0.1), disc(1.0), supported(3, 1.0, 0.5), supported(2, 0.02, 0.5), hinged_stack()];
    for problem in problems {
        let solution = solve(&problem);
        let form = problem.to_dense().expect("in the paper's form");
        let paper = form.from_mixed(&solution);
        assert!(form.residual(&paper) <= 1e-12, "{:e}", form.residual(&paper));
        let back = form.to_mixed(&problem, &paper);
        assert!(problem.residual(&back).max() <= 1e-12);
        near(&back.impulses, &solution.impulses, 0.0);
        assert_eq!(back.velocities, solution.velocities);
        let same = |(a, b): (&Mode, &Mode)| a == b;
        assert!(
            back.modes.iter().zip(&solution.modes).all(same)
                || !problem.weak_rows(&solution, 1e-7).is_empty()
        );
    }
}

#[test]
fn a_wrong_solution_does_not() {
    let problem = disc(1.0);
    let mut solution = solve(&problem);
    solution.impulses[1] = -solution.impulses[1];
    let form = problem.to_dense().expect("in the paper's form");
    assert!(form.residual(&form.from_mixed(&solution)) > 0.01);
}

#[test]
fn rows_without_counterpart_are_refused() {
    let mut problem = disc(1.0);
    problem.rows[0].compliance = 0.1;
    let refused =
        |problem: &Lcp| matches!(problem.to_dense(), Err(LcpError::NotInPaperForm { row: 0, .. }));
    assert!(refused(&problem));
    problem.rows = vec![row([0.0, 0.0, 1.0], 0.0, Law::Bounded { max: 1.0 })];
    assert!(refused(&problem));
}
