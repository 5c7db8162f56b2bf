//! Problems handed to the backends directly, past every check of a scene.

use nalgebra::{DMatrix, DVector, Vector3};
use tangency::lcp::{Law, Lcp, NO_BODY, RawFriction, RawLcp, Row, Scratch};
use tangency::{LcpSolver, all_solvers, fallback, raw_solvers};
use tangency_bench::problems::Random;

/// What multiplication and addition make of f64's ends.
const EXTREMES: [f64; 16] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    1e-9,
    1e9,
    1e-50,
    -1e50,
    1e150,
    1e-150,
    1e300,
    -1e300,
    1e-300,
    5e-324,
    f64::MAX,
];

/// A number that is extreme every other time, and not finite now and then.
fn number(random: &mut Random) -> f64 {
    match random.index(40) {
        0 => f64::NAN,
        1 => f64::INFINITY,
        2..=12 => random.pick(&EXTREMES),
        _ => random.between(-2.0, 2.0),
    }
}

fn vector(random: &mut Random) -> Vector3<f64> {
    Vector3::from_fn(|_, _| number(random))
}

/// One to three bodies and up to six rows of any law, some of them naming what is not there.
fn problem(random: &mut Random) -> Lcp {
    let bodies = 1 + random.index(3);
    let body = |random: &mut Random| match random.index(12) {
        0 => u32::try_from(bodies).expect("few bodies"),
        1..=4 => NO_BODY,
        k => u32::try_from(k % bodies).expect("few bodies"),
    };
    let row = |random: &mut Random, k: usize| {
        let bodies = [body(random), body(random)];
        let block = |side: usize, random: &mut Random| {
            if bodies[side] == NO_BODY { Vector3::zeros() } else { vector(random) }
        };
        let normal = u32::try_from(k.saturating_sub(1)).expect("few rows");
        Row {
            bodies,
            jacobian: [block(0, random), block(1, random)],
            rhs: number(random),
            compliance: if random.index(3) == 0 { number(random).abs() } else { 0.0 },
            law: match random.index(5) {
                0 => Law::Equality,
                1 => Law::Bounded { max: number(random).abs() },
                2 => Law::Friction { normal, mu: number(random).abs() },
                _ => Law::Unilateral,
            },
        }
    };
    Lcp {
        mass: (0..bodies).map(|_| vector(random).abs()).collect(),
        momentum: (0..bodies).map(|_| vector(random)).collect(),
        rows: (0..random.index(7)).map(|k| row(random, k)).collect(),
    }
}

/// A solution is finite and has the residual that its backend promises; all else is an error.
#[test]
fn mechanical() {
    let (mut random, mut solved) = (Random(3), 0);
    for _ in 0..6000 {
        let problem = problem(&mut random);
        for solver in all_solvers() {
            let Ok(solution) = solver.solve(&problem, None, &mut Scratch::default()) else {
                continue;
            };
            solved += 1;
            let (name, residual) = (solver.name(), problem.residual(&solution).max());
            assert!(residual <= 1e-9, "{name}: residual {residual:e}, {problem:?}");
            let numbers = solution.velocities.iter().flatten().chain(&solution.impulses);
            assert!(numbers.into_iter().all(|x| x.is_finite()), "{name}: {problem:?}");
        }
        let _ = fallback().solve(&problem, None, &mut Scratch::default());
    }
    let least = 200 * all_solvers().len();
    assert!(solved > least, "only {solved} were solved");
}

/// The same for raw problems.
#[test]
fn raw() {
    let (mut random, mut solved) = (Random(4), 0);
    for _ in 0..4000 {
        let n = random.index(5);
        let mut matrix = DMatrix::from_fn(n, n, |_, _| number(&mut random));
        if random.index(2) == 0 {
            matrix = &matrix * matrix.transpose();
        }
        let q = DVector::from_fn(n, |_, _| number(&mut random));
        let free = random.index(n + 2);
        let problem = RawLcp { free, matrix, q };
        for solver in raw_solvers() {
            let Ok(solution) = solver.solve_raw(&problem) else { continue };
            solved += 1;
            let residual = problem.residual(&solution.z);
            assert!(residual <= 1e-10, "{}: {residual:e}, {problem:?}", solver.name());
            let _ = problem.derivative(&solution);
        }
    }
    assert!(solved > 500, "only {solved} were solved");
}

/// The same for planar friction, whose own residual judges.
#[test]
fn friction() {
    let (mut random, mut solved) = (Random(5), 0);
    for _ in 0..3000 {
        let contacts = random.index(3);
        let n = 2 * contacts;
        let mut matrix = DMatrix::from_fn(n, n, |_, _| number(&mut random));
        if random.index(4) > 0 {
            matrix = &matrix * matrix.transpose();
        }
        let q = DVector::from_fn(n, |_, _| number(&mut random));
        let mu = (0..contacts).map(|_| number(&mut random)).collect();
        let problem = RawFriction { matrix, q, mu };
        for solver in raw_solvers() {
            let found = solver.solve_friction(&problem);
            let judged = |solution| problem.judged(solver.name(), solution);
            let Ok(solution) = found.and_then(judged) else { continue };
            solved += 1;
            let (r, w) = (problem.reactions(&solution.z), &solution.w);
            assert!(r.iter().chain(w).all(|x| x.is_finite()), "{}: {problem:?}", solver.name());
            let _ = problem.derivative(&solution);
        }
    }
    assert!(solved > 200, "only {solved} were solved");
}
