//! Small problems with known answers.

use nalgebra::Vector3;
use tangency_lcp::{Law, Lcp, LcpSolution, Metric, NO_BODY, Polish, Row, Scratch};

pub(crate) type V = Vector3<f64>;

/// A row of body 0 against the world.
pub(crate) fn row(jacobian: [f64; 3], rhs: f64, law: Law) -> Row {
    between([NO_BODY, 0], [[0.0; 3], jacobian], rhs, law)
}

pub(crate) fn between(bodies: [u32; 2], jacobian: [[f64; 3]; 2], rhs: f64, law: Law) -> Row {
    Row { bodies, jacobian: jacobian.map(V::from), rhs, compliance: 0.0, law }
}

pub(crate) fn body(mass: [f64; 3], momentum: [f64; 3], rows: Vec<Row>) -> Lcp {
    Lcp { mass: vec![V::from(mass)], momentum: vec![V::from(momentum)], rows }
}

/// Disc with contact matrix diag(1, 3), normal velocity −1/10 (V33).
pub(crate) fn disc(speed: f64) -> Lcp {
    let rows = vec![
        row([0.0, 1.0, 0.0], 0.0, Law::Unilateral),
        row([1.0, 0.0, 1.0], 0.0, Law::Friction { normal: 0, mu: 0.5 }),
    ];
    body([1.0, 1.0, 0.5], [speed, -0.1, 0.0], rows)
}

/// Unit box on evenly spaced supports.
pub(crate) fn supported(supports: u32, speed: f64, mu: f64) -> Lcp {
    let rows = (0..supports).flat_map(|k| {
        let x = f64::from(k) / f64::from(supports - 1) - 0.5;
        let friction = Law::Friction { normal: 2 * k, mu };
        [row([0.0, 1.0, x], 0.0, Law::Unilateral), row([1.0, 0.0, 0.5], 0.0, friction)]
    });
    body([1.0, 1.0, 1.0 / 6.0], [speed, -0.1, 0.0], rows.collect())
}

/// A stack of unit boxes with the given masses, dt g = 1/10.
pub(crate) fn stack(masses: &[f64]) -> Lcp {
    let mut problem = Lcp::default();
    for (k, &mass) in masses.iter().enumerate() {
        problem.mass.push(V::new(mass, mass, mass / 6.0));
        problem.momentum.push(V::new(0.0, -0.1 * mass, 0.0));
        for x in [-0.5, 0.5] {
            let (upper, lower) = (index(k), if k == 0 { NO_BODY } else { index(k - 1) });
            let below = |block: [f64; 3]| if k == 0 { [0.0; 3] } else { block };
            let normal = index(problem.rows.len());
            let blocks = [below([0.0, -1.0, -x]), [0.0, 1.0, x]];
            problem.rows.push(between([lower, upper], blocks, 0.0, Law::Unilateral));
            let blocks = [below([-1.0, 0.0, 0.5]), [1.0, 0.0, 0.5]];
            let law = Law::Friction { normal, mu: 0.5 };
            problem.rows.push(between([lower, upper], blocks, 0.0, law));
        }
    }
    problem
}

/// A hanging chain of links of length 1, its first end fixed and its last pulled sideways.
pub(crate) fn chain(links: usize, copies: usize) -> Lcp {
    let mut problem = Lcp::default();
    for k in 0..links {
        problem.mass.push(V::new(1.0, 1.0, 1.0 / 12.0));
        problem.momentum.push(V::new(0.3 * k as f64, -0.1, 0.05));
        let (link, before) = (index(k), if k == 0 { NO_BODY } else { index(k - 1) });
        for _ in 0..copies {
            for (x, y) in [(1.0, 0.0), (0.0, 1.0)] {
                let first = if k == 0 { [0.0; 3] } else { [-x, -y, -0.5 * x] };
                let blocks = [first, [x, y, -0.5 * x]];
                problem.rows.push(between([before, link], blocks, 0.0, Law::Equality));
            }
        }
    }
    problem
}

pub(crate) fn index(value: usize) -> u32 {
    u32::try_from(value).expect("few bodies")
}

/// The active-set loop from a cold start.
#[track_caller]
pub(crate) fn solve(problem: &Lcp) -> LcpSolution {
    problem.validate().expect("valid");
    let metric = Metric::new(problem);
    let polish = Polish::new(problem, &metric, 1e-12, 60);
    let candidates = [false, true]
        .map(|slide| polish.modes(&polish.cold_modes(slide), None, &mut Scratch::default()));
    let found = candidates.into_iter().find(|found| polish.reached(found));
    found.expect("the active-set loop solves it").solution
}

#[track_caller]
pub(crate) fn near(found: &[f64], wanted: &[f64], tolerance: f64) {
    assert_eq!(found.len(), wanted.len());
    for (found, wanted) in found.iter().zip(wanted) {
        assert!((found - wanted).abs() <= tolerance, "{found:e} is not {wanted:e}");
    }
}
