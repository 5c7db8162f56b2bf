//! The active-set loop on problems with known answers.

use tangency_lcp::{Law, LcpSolution, Metric, Mode, Polish, Scratch, WeakKind};

use crate::problems::{V, body, disc, near, row, solve, supported};

#[test]
fn disc_sticks_or_slips() {
    let solution = solve(&disc(0.1));
    near(&solution.impulses, &[0.1, -1.0 / 30.0], 1e-15);
    assert_eq!(solution.modes, [Mode::Active; 2]);
    let solution = solve(&disc(1.0));
    near(&solution.impulses, &[0.1, -0.05], 1e-15);
    near(&solution.slacks, &[0.0, 0.85], 1e-15);
    assert_eq!(solution.modes, [Mode::Active, Mode::Lower]);
}

#[test]
fn box_on_two_supports() {
    let solution = solve(&supported(2, 1.0, 0.5));
    near(solution.velocities[0].as_slice(), &[0.95, 0.0, 0.0], 1e-15);
    near(&solution.impulses, &[1.0 / 40.0, -1.0 / 80.0, 3.0 / 40.0, -3.0 / 80.0], 1e-15);
    let solution = solve(&supported(2, 0.02, 0.5));
    near(solution.velocities[0].as_slice(), &[0.0; 3], 1e-15);
    near(&[solution.impulses[0], solution.impulses[2]], &[0.04, 0.06], 1e-12);
    near(&[solution.impulses[1] + solution.impulses[3]], &[-0.02], 1e-15);
    let problem = supported(2, 0.05, 0.5);
    let solution = solve(&problem);
    near(solution.velocities[0].as_slice(), &[0.0; 3], 1e-15);
    assert!(problem.weak_rows(&solution, 1e-7).iter().any(|row| row.kind == WeakKind::Slipping));
}

#[test]
fn resting_on_many_supports_takes_impulses_of_one_sign() {
    for supports in [2, 3, 10, 100] {
        for speed in [0.0, 0.01, 3.0] {
            let problem = supported(supports, speed, 0.3);
            let solution = solve(&problem);
            assert!(problem.residual(&solution).max() <= 1e-13);
            let normals: Vec<f64> = solution.impulses.iter().step_by(2).copied().collect();
            assert!(normals.iter().all(|&normal| normal >= 0.0), "{normals:?}");
            near(&[normals.iter().sum()], &[0.1], 1e-13);
            let speed = (speed - 0.03_f64).max(0.0);
            near(solution.velocities[0].as_slice(), &[speed, 0.0, 0.0], 1e-13);
        }
    }
}

#[test]
fn weak_rows_are_released_from_either_side() {
    // A disc that grazes: no impulse, no normal velocity.
    let mut problem = disc(1.0);
    problem.momentum[0].y = 0.0;
    let metric = Metric::new(&problem);
    let polish = Polish::new(&problem, &metric, 1e-12, 8);
    for modes in [[Mode::Active; 2], [Mode::Active, Mode::Lower], [Mode::Open; 2]] {
        let found = polish.modes(&modes, None, &mut Scratch::default());
        assert_eq!(found.solution.modes, [Mode::Open; 2]);
        assert_eq!(found.max(), 0.0);
    }
}

#[test]
fn painleve_rod() {
    let rows = vec![
        row([0.0, 1.0, 0.6], 0.0, Law::Unilateral),
        row([1.0, 0.0, 0.8], 0.0, Law::Friction { normal: 0, mu: 2.0 }),
    ];
    let mut problem = body([1.0, 1.0, 1.0 / 3.0], [1.0, -0.1, 0.0], rows);
    near(&solve(&problem).impulses, &[0.433, -0.556], 1e-14);
    // Lifting off: three solutions, always the same one returned.
    problem.momentum[0].y = 0.1;
    let solution = solve(&problem);
    let answers = [[0.0, 0.0], [0.287, -0.484], [0.125, -0.25]];
    let close = |answer: &[f64; 2]| {
        answer.iter().zip(&solution.impulses).all(|(a, b)| (a - b).abs() < 1e-10)
    };
    assert!(answers.iter().any(close), "{:?}", solution.impulses);
    assert_eq!(solution, solve(&problem));
}

#[test]
fn motor_holds_or_saturates() {
    let motor = |speed| vec![row([0.0, 0.0, 1.0], speed, Law::Bounded { max: 0.2 })];
    let holding = solve(&body([1.0, 1.0, 0.5], [0.0; 3], motor(0.3)));
    near(&holding.impulses, &[0.15], 1e-16);
    let problem = body([1.0, 1.0, 0.5], [0.0; 3], motor(-3.0));
    let saturated = solve(&problem);
    near(saturated.velocities[0].as_slice(), &[0.0, 0.0, -0.4], 1e-16);
    assert_eq!(saturated.modes, [Mode::Lower]);
    assert_eq!(problem.residual(&saturated).max(), 0.0);
}

#[test]
fn approximate_solutions_become_exact() {
    let problem = supported(3, 1.0, 0.5);
    let exact = solve(&problem);
    let mut rough = LcpSolution { system: None, ..exact.clone() };
    rough.velocities[0] += V::new(1e-3, 1e-3, -1e-3);
    rough.impulses.iter_mut().for_each(|impulse| *impulse *= 1.02);
    let metric = Metric::new(&problem);
    let polish = Polish::new(&problem, &metric, 1e-12, 8);
    let found = polish.approximate(&rough, &mut Scratch::default()).expect("the residual drops");
    assert!(found.max() <= 1e-14);
    near(found.solution.velocities[0].as_slice(), exact.velocities[0].as_slice(), 1e-14);
    assert!(
        polish
            .approximate(&exact, &mut Scratch::default())
            .is_none_or(|again| again.max() <= 1e-14)
    );
}
