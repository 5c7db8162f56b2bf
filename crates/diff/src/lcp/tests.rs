//! Known derivatives (V25, V31, V33), the two modes against each other and against differences.

use nalgebra::Vector3;
use tangency_lcp::{Law, Lcp, LcpSolution, Metric, Mode, NO_BODY, Polish, Row, Scratch};

use super::{LcpAdjoint, LcpDiffError, LcpGradientReport, LcpVector, WeakKind, lcp_jvp, lcp_vjp};
use crate::GradientMode;

mod smoothed;

type V = Vector3<f64>;

fn row(jacobian: [f64; 3], rhs: f64, law: Law) -> Row {
    let jacobian = [V::zeros(), V::from(jacobian)];
    Row { bodies: [NO_BODY, 0], jacobian, rhs, compliance: 0.0, law }
}

fn body(mass: [f64; 3], momentum: [f64; 3], rows: Vec<Row>) -> Lcp {
    Lcp { mass: vec![V::from(mass)], momentum: vec![V::from(momentum)], rows }
}

fn friction(normal: u32, mu: f64) -> Law {
    Law::Friction { normal, mu }
}

fn try_solve(problem: &Lcp) -> Option<LcpSolution> {
    problem.validate().expect("valid");
    let metric = Metric::new(problem);
    let polish = Polish::new(problem, &metric, 1e-12, 60);
    let candidates = [false, true]
        .map(|slide| polish.modes(&polish.cold_modes(slide), None, &mut Scratch::default()));
    candidates.into_iter().find(|found| found.max() <= 1e-12).map(|found| found.solution)
}

#[track_caller]
fn solve(problem: &Lcp) -> LcpSolution {
    try_solve(problem).expect("the active-set loop solves it")
}

#[track_caller]
fn near(found: &[f64], wanted: &[f64], tolerance: f64) {
    assert_eq!(found.len(), wanted.len());
    for (found, wanted) in found.iter().zip(wanted) {
        assert!((found - wanted).abs() <= tolerance, "{found} is not {wanted}");
    }
}

/// `dv_k/dp` as the rows k of a matrix, by VJP; checked against the columns by JVP.
#[track_caller]
fn by_momentum(problem: &Lcp, solution: &LcpSolution) -> [V; 3] {
    let rows = [0, 1, 2].map(|k| {
        let seed = V::from_fn(|i, _| f64::from(u8::from(i == k)));
        lcp_vjp(problem, solution, &[seed], None).expect("vjp").0.momentum[0]
    });
    for j in 0..3 {
        let mut tangent = LcpVector::zeros(problem);
        tangent.momentum[0][j] = 1.0;
        let (dv, _) = lcp_jvp(problem, solution, &tangent).expect("jvp");
        near(dv[0].as_slice(), &rows.map(|row| row[j]), 1e-12);
    }
    rows
}

fn mixed(equalities: usize) -> Lcp {
    let mut rows = vec![row([1.0, 0.0, 1.0], 0.0, Law::Equality); equalities];
    rows.push(row([0.0, 1.0, -1.0], 0.0, Law::Unilateral));
    rows.push(row([0.0, 1.0, 1.0], -4.0, Law::Unilateral));
    body([2.0, 2.0, 1.0], [4.0, -4.0, 1.0], rows)
}

#[test]
fn mixed_problem_with_exact_answers() {
    for equalities in [1, 2, 5] {
        let problem = mixed(equalities);
        let solution = solve(&problem);
        near(solution.velocities[0].as_slice(), &[1.4, -1.4, -1.4], 1e-13);
        near(&solution.impulses[equalities..], &[1.2, 0.0], 1e-12);
        near(&[solution.impulses[..equalities].iter().sum()], &[-1.2], 1e-12);
        let by = by_momentum(&problem, &solution);
        near(by[0].as_slice(), &[0.2, -0.2, -0.2], 1e-12);
        near(by[1].as_slice(), &[-0.2, 0.2, 0.2], 1e-12);
        near(by[2].as_slice(), &[-0.2, 0.2, 0.2], 1e-12);
        let mut impulse_bar = vec![0.0; problem.rows.len()];
        impulse_bar[equalities] = 1.0;
        let zero = [V::zeros()];
        let (bar, report) = lcp_vjp(&problem, &solution, &zero, Some(&impulse_bar)).expect("vjp");
        near(bar.momentum[0].as_slice(), &[-0.4, -0.6, 0.4], 1e-12);
        assert_eq!(report.rank_defect as usize, equalities - 1);
    }
}

/// Disc with contact matrix diag(1, 3).
fn disc(speed: f64) -> Lcp {
    let rows = vec![
        row([0.0, 1.0, 0.0], 0.0, Law::Unilateral),
        row([1.0, 0.0, 1.0], 0.0, friction(0, 0.5)),
    ];
    body([1.0, 1.0, 0.5], [speed, -0.1, 0.0], rows)
}

#[test]
fn single_contact_sticks_or_slips() {
    let problem = disc(0.1);
    let solution = solve(&problem);
    near(&solution.impulses, &[0.1, -1.0 / 30.0], 1e-15);
    let by = by_momentum(&problem, &solution);
    near(by[1].as_slice(), &[0.0; 3], 1e-14);
    near((by[0] + by[2]).as_slice(), &[0.0; 3], 1e-14);

    let problem = disc(1.0);
    let solution = solve(&problem);
    near(&solution.impulses, &[0.1, -0.05], 1e-15);
    near(&[solution.slacks[1]], &[0.85], 1e-15);
    let (bar, report) = lcp_vjp(&problem, &solution, &[V::x()], None).expect("vjp");
    near(&[bar.rows[1].bound], &[-0.1], 1e-14);
    near(bar.momentum[0].as_slice(), &[1.0, 0.5, 0.0], 1e-14);
    assert_eq!(report, LcpGradientReport { defect: report.defect, ..Default::default() });
}

#[test]
fn adjoint_in_used_memory() {
    let mut adjoint = LcpAdjoint::default();
    for problem in [mixed(2), disc(1.0), supported(1.0), disc(0.1)] {
        let solution = solve(&problem);
        let (bar, report) = lcp_vjp(&problem, &solution, &[V::x()], None).expect("vjp");
        adjoint.solve(&problem, &solution, &[V::x()], None).expect("an adjoint");
        assert_eq!(adjoint.momentum(), bar.momentum);
        assert_eq!(adjoint.mass(&solution, 0), bar.mass[0]);
        for (row, bar) in bar.rows.iter().enumerate() {
            assert_eq!(adjoint.row(&problem, &solution, row), *bar);
        }
        assert_eq!(adjoint.report(&problem, &solution), report);
    }
}

/// Box of half size 1/2 on two supports, weight impulse 1/10.
fn supported(speed: f64) -> Lcp {
    let rows = [-0.5, 0.5].into_iter().enumerate().flat_map(|(k, x)| {
        let normal = u32::try_from(2 * k).expect("two supports");
        [row([0.0, 1.0, x], 0.0, Law::Unilateral), row([1.0, 0.0, 0.5], 0.0, friction(normal, 0.5))]
    });
    body([1.0, 1.0, 1.0 / 6.0], [speed, -0.1, 0.0], rows.collect())
}

#[test]
fn sliding_block_by_friction() {
    let problem = supported(1.0);
    let solution = solve(&problem);
    near(solution.velocities[0].as_slice(), &[0.95, 0.0, 0.0], 1e-15);
    near(&solution.impulses, &[1.0 / 40.0, -1.0 / 80.0, 3.0 / 40.0, -3.0 / 80.0], 1e-15);
    let (bar, _) = lcp_vjp(&problem, &solution, &[V::x()], None).expect("vjp");
    // dv/dμ = −g dt, shared by the two supports as they carry the weight.
    near(&[bar.rows[1].bound, bar.rows[3].bound], &[-1.0 / 40.0, -3.0 / 40.0], 1e-15);
    near(bar.momentum[0].as_slice(), &[1.0, 0.5, 0.0], 1e-14);
}

#[test]
fn sticking_block_does_not_move() {
    let problem = supported(0.02);
    let solution = solve(&problem);
    near(solution.velocities[0].as_slice(), &[0.0; 3], 1e-15);
    near(&[solution.impulses[0], solution.impulses[2]], &[1.0 / 25.0, 3.0 / 50.0], 1e-12);
    near(&[solution.impulses[1] + solution.impulses[3]], &[-0.02], 1e-15);
    for row in by_momentum(&problem, &solution) {
        near(row.as_slice(), &[0.0; 3], 1e-12);
    }
    let report = lcp_vjp(&problem, &solution, &[V::x()], None).expect("vjp").1;
    assert_eq!((report.rank_defect, report.weak.len()), (1, 0));
}

#[test]
fn friction_at_its_bound_is_reported() {
    let problem = supported(0.05);
    let solution = solve(&problem);
    near(solution.velocities[0].as_slice(), &[0.0; 3], 1e-15);
    let (bar, report) = lcp_vjp(&problem, &solution, &[V::x()], None).expect("vjp");
    assert!((0.0..=1.0).contains(&bar.momentum[0].x), "{}", bar.momentum[0].x);
    assert!(report.weak.iter().any(|weak| weak.kind == WeakKind::Slipping));
}

#[test]
fn grazing_contact_is_reported_and_released() {
    let mut problem = disc(1.0);
    problem.momentum[0].y = 0.0;
    let solution = solve(&problem);
    assert_eq!(solution.modes, [Mode::Open, Mode::Open]);
    let (bar, report) = lcp_vjp(&problem, &solution, &[V::y()], None).expect("vjp");
    near(bar.momentum[0].as_slice(), &[0.0, 1.0, 0.0], 0.0);
    assert_eq!(report.weak.len(), 1);
    assert_eq!((report.weak[0].row, report.weak[0].kind), (0, WeakKind::Touching));
}

#[test]
fn painleve_rod_sticks_at_once() {
    let rows = vec![
        row([0.0, 1.0, 0.6], 0.0, Law::Unilateral),
        row([1.0, 0.0, 0.8], 0.0, friction(0, 2.0)),
    ];
    let problem = body([1.0, 1.0, 1.0 / 3.0], [1.0, -0.1, 0.0], rows);
    let solution = solve(&problem);
    near(&solution.impulses, &[0.433, -0.556], 1e-14);
}

#[test]
fn adjoint_of_a_sliding_contact_uses_the_transpose() {
    // Two supports with different levers: S is not symmetric, and S in place of Sᵀ is wrong.
    let mut problem = supported(1.0);
    problem.rows[0].jacobian[1].z = -0.3;
    problem.rows[1].jacobian[1].z = 0.7;
    let solution = solve(&problem);
    assert!(solution.modes.contains(&Mode::Lower));
    let (bar, _) = lcp_vjp(&problem, &solution, &[V::new(1.0, 0.2, 0.3)], None).expect("vjp");
    for direction in 0..20 {
        let tangent = random_tangent(&problem, direction);
        let change = difference(&problem, &tangent, 1e-6).expect("regular");
        let wanted = change[0].dot(&V::new(1.0, 0.2, 0.3));
        near(&[bar.dot(&tangent)], &[wanted], 1e-9 * (1.0 + wanted.abs()));
    }
}

#[test]
fn saturated_motor_by_its_greatest_impulse() {
    let mut problem = disc(1.0);
    problem.rows.push(row([0.0, 0.0, 1.0], 7.0, Law::Bounded { max: 0.2 }));
    let solution = solve(&problem);
    assert_eq!(solution.modes[2], Mode::Upper);
    let (bar, _) = lcp_vjp(&problem, &solution, &[V::z()], None).expect("vjp");
    near(&[bar.rows[2].bound, bar.rows[2].rhs], &[2.0, 0.0], 1e-14);
}

// Random problems.

struct Random(u64);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        low + (high - low) * ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn vector(&mut self, size: f64) -> V {
        V::from_fn(|_, _| self.between(-size, size))
    }
}

/// Three bodies in a row, hinged and in frictional contact with the ground and each other.
fn random_problem(seed: u64) -> Lcp {
    let mut random = Random(seed);
    let mass = (0..3).map(|_| V::from_fn(|_, _| random.between(0.5, 2.0))).collect();
    let momentum = (0..3).map(|_| random.vector(1.0)).collect();
    let mut problem = Lcp { mass, momentum, rows: Vec::new() };
    for pair in [[NO_BODY, 0], [0, 1], [1, 2], [NO_BODY, 2], [0, 2]] {
        let normal = u32::try_from(problem.rows.len()).expect("few rows");
        let mu = random.between(0.1, 0.8);
        let laws = if pair == [0, 1] {
            vec![Law::Equality, Law::Bounded { max: random.between(0.05, 1.0) }]
        } else {
            vec![Law::Unilateral, friction(normal, mu)]
        };
        for law in laws {
            let first = if pair[0] == NO_BODY { V::zeros() } else { random.vector(1.0) };
            let jacobian = [first, random.vector(1.0)];
            let compliance = if law == Law::Equality { 0.1 } else { 0.0 };
            let rhs = random.between(-0.3, 0.0);
            problem.rows.push(Row { bodies: pair, jacobian, rhs, compliance, law });
        }
    }
    problem
}

fn random_tangent(problem: &Lcp, seed: u64) -> LcpVector {
    let mut random = Random(seed ^ 0x5555);
    let mut tangent = LcpVector::zeros(problem);
    for (mass, momentum) in tangent.mass.iter_mut().zip(&mut tangent.momentum) {
        (*mass, *momentum) = (random.vector(1.0), random.vector(1.0));
    }
    for (change, row) in tangent.rows.iter_mut().zip(&problem.rows) {
        for side in 0..2 {
            if row.bodies[side] != NO_BODY {
                change.jacobian[side] = random.vector(1.0);
            }
        }
        change.rhs = random.between(-1.0, 1.0);
        if row.compliance > 0.0 {
            change.compliance = random.between(-1.0, 1.0);
        }
        if matches!(row.law, Law::Bounded { .. } | Law::Friction { .. }) {
            change.bound = random.between(-1.0, 1.0);
        }
    }
    tangent
}

/// The problem moved by h along a tangent.
fn moved(problem: &Lcp, tangent: &LcpVector, h: f64) -> Lcp {
    let mut moved = problem.clone();
    for k in 0..problem.mass.len() {
        moved.mass[k] += h * tangent.mass[k];
        moved.momentum[k] += h * tangent.momentum[k];
    }
    for (row, change) in moved.rows.iter_mut().zip(&tangent.rows) {
        for side in 0..2 {
            row.jacobian[side] += h * change.jacobian[side];
        }
        row.rhs += h * change.rhs;
        row.compliance += h * change.compliance;
        match &mut row.law {
            Law::Bounded { max: bound } | Law::Friction { mu: bound, .. } => {
                *bound += h * change.bound;
            }
            Law::Equality | Law::Unilateral => {}
        }
    }
    moved
}

/// Central difference of the velocities along a tangent; `None` if the modes differ on the way.
fn difference(problem: &Lcp, tangent: &LcpVector, h: f64) -> Option<Vec<V>> {
    let there = try_solve(&moved(problem, tangent, h))?;
    let back = try_solve(&moved(problem, tangent, -h))?;
    let change = there.velocities.iter().zip(&back.velocities).map(|(a, b)| (a - b) / (2.0 * h));
    (there.modes == back.modes).then(|| change.collect())
}

#[test]
fn random_problems_in_both_modes_and_against_differences() {
    let (mut checked, mut seen) = (0, Vec::new());
    for seed in 0..300 {
        let problem = random_problem(seed);
        let Some(solution) = try_solve(&problem) else { continue };
        let margin = problem.margins(&solution).into_iter().fold(f64::INFINITY, f64::min);
        if margin < 1e-3 {
            continue;
        }
        for mode in &solution.modes {
            if !seen.contains(mode) {
                seen.push(*mode);
            }
        }
        let mut random = Random(seed);
        let velocity_bar: Vec<V> = (0..3).map(|_| random.vector(1.0)).collect();
        let impulse_bar: Vec<f64> =
            problem.rows.iter().map(|_| random.between(-1.0, 1.0)).collect();
        let bars = Some(&impulse_bar[..]);
        let (bar, report) = lcp_vjp(&problem, &solution, &velocity_bar, bars).expect("vjp");
        assert_eq!(report.weak, []);
        let tangent = random_tangent(&problem, seed);
        let (dv, d_impulses) = lcp_jvp(&problem, &solution, &tangent).expect("jvp");
        let forward = along(&velocity_bar, &dv)
            + impulse_bar.iter().zip(&d_impulses).map(|(a, b)| a * b).sum::<f64>();
        near(&[bar.dot(&tangent)], &[forward], 1e-12 * (1.0 + forward.abs()) * (1.0 + size(&dv)));

        let Some(change) = difference(&problem, &tangent, 1e-7) else { continue };
        for (dv, change) in dv.iter().zip(&change) {
            near(dv.as_slice(), change.as_slice(), 1e-6 * (1.0 + size(&[*dv])));
        }
        checked += 1;
    }
    assert!(checked > 150, "{checked} of 300 were regular");
    assert_eq!(seen.len(), 4, "every mode occurs: {seen:?}");
}

fn along(a: &[V], b: &[V]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

fn size(values: &[V]) -> f64 {
    values.iter().fold(0.0, |size, value| value.amax().max(size))
}

#[test]
fn a_rebuilt_system_gives_the_same_bits() {
    let problem = supported(1.0);
    let kept = solve(&problem);
    let dropped = LcpSolution { system: None, ..kept.clone() };
    let seed = [V::new(0.3, -0.2, 0.7)];
    let with = lcp_vjp(&problem, &kept, &seed, None).expect("vjp");
    let without = lcp_vjp(&problem, &dropped, &seed, None).expect("vjp");
    assert_eq!(with, without);
}

#[test]
fn many_collinear_supports_share_one_derivative() {
    for supports in [2_u32, 3, 10, 100] {
        let points = (0..supports).flat_map(|k| {
            let x = f64::from(k) / f64::from(supports - 1) - 0.5;
            [
                row([0.0, 1.0, x], 0.0, Law::Unilateral),
                row([1.0, 0.0, 0.5], 0.0, friction(2 * k, 0.3)),
            ]
        });
        let problem = body([1.0, 1.0, 1.0 / 6.0], [3.0, -0.0981, 0.0], points.collect());
        let solution = solve(&problem);
        near(solution.velocities[0].as_slice(), &[3.0 - 0.3 * 0.0981, 0.0, 0.0], 1e-10);
        let normals: Vec<f64> = solution.impulses.iter().step_by(2).copied().collect();
        near(&[normals.iter().sum()], &[0.0981], 1e-12);
        assert!(normals.iter().all(|&normal| normal >= 0.0));
        let (bar, _) = lcp_vjp(&problem, &solution, &[V::x()], None).expect("vjp");
        near(bar.momentum[0].as_slice(), &[1.0, 0.3, 0.0], 1e-10);
        let by_mu: f64 = bar.rows.iter().map(|row| row.bound).sum();
        near(&[by_mu], &[-0.0981], 1e-10);
    }
}

/// One equality entered twice: λ₁ + λ₂ = b − p, the least ones are equal. The sum is determined, one
/// of them is not.
#[test]
fn impulses_of_rows_that_depend_on_each_other() {
    let twice = vec![row([1.0, 0.0, 0.0], 0.3, Law::Equality); 2];
    let problem = body([2.0, 2.0, 1.0], [1.0, 0.0, 0.0], twice);
    let solution = solve(&problem);
    // One by one they are known as well as the proximal term, 10⁻⁹, tells them apart.
    near(&solution.impulses, &[-0.2, -0.2], 1e-9);
    near(&[solution.impulses.iter().sum()], &[-0.4], 1e-12);
    let mut tangent = LcpVector::zeros(&problem);
    tangent.momentum[0].x = 1.0;
    let (_, pushed) = lcp_jvp(&problem, &solution, &tangent).expect("jvp");
    near(&pushed, &[-0.5, -0.5], 1e-7);
    for (seed, exact, undetermined) in [([1.0, 1.0], -1.0, false), ([1.0, 0.0], -0.5, true)] {
        let (bar, report) = lcp_vjp(&problem, &solution, &[V::zeros()], Some(&seed)).expect("vjp");
        near(&[bar.momentum[0].x], &[exact], if undetermined { 1e-7 } else { 1e-12 });
        near(&[bar.rows[0].rhs + bar.rows[1].rhs], &[-2.0 * exact], 1e-6);
        assert_eq!((report.rank_defect, report.undetermined), (1, undetermined));
    }
}

#[test]
fn wrong_lengths_are_refused() {
    let problem = disc(1.0);
    let solution = solve(&problem);
    assert!(lcp_vjp(&problem, &solution, &[], None).is_err());
    assert!(lcp_vjp(&problem, &solution, &[V::x()], Some(&[1.0])).is_err());
    assert!(lcp_jvp(&problem, &solution, &LcpVector::default()).is_err());
}
