//! The comparison of two answers to one problem.

use nalgebra::Vector3;
use tangency::LcpSolver;
use tangency::diff::lcp::{LcpVector, RowVector, lcp_vjp};
use tangency::lcp::{Law, Lcp, LcpError, LcpSolution, Metric, Scratch};

/// How far velocities may be apart, mass-weighted and relative to the problem's scale.
const VELOCITY: f64 = 1e-9;
/// Greatest natural residual of an answer.
const RESIDUAL: f64 = 1e-10;
/// How far derivatives may be apart, relative to their size.
const DERIVATIVE: f64 = 1e-8;
/// Answers that differ must solve the problem to rounding each.
const EXACT: f64 = 1e-12;

/// What the backends made of one problem.
#[derive(Clone, Debug, Default)]
pub(super) struct Verdict {
    /// Backends that solved it.
    pub(super) solved: usize,
    /// Names of those that said they could not.
    pub(super) failed: Vec<&'static str>,
    /// Answers with other velocities than the first, exact both: Coulomb's law has several solutions
    /// here.
    pub(super) multiple: usize,
    /// Comparisons of derivatives.
    pub(super) derivatives: usize,
}

/// Solves by every backend and compares with the first answer. A failure must be a typed one that
/// claims no conflict; `Err` lists what is wrong.
pub(super) fn compare(
    problem: &Lcp,
    solvers: &[Box<dyn LcpSolver>],
) -> Result<Verdict, Vec<String>> {
    let (mut verdict, mut wrong) = (Verdict::default(), Vec::new());
    let mut first: Option<(&'static str, LcpSolution)> = None;
    for solver in solvers {
        let name = solver.name();
        let solution = match solver.solve(problem, None, &mut Scratch::default()) {
            Ok(solution) => solution,
            Err(LcpError::NotConverged { .. }) => {
                verdict.failed.push(name);
                continue;
            }
            Err(error) => {
                wrong.push(format!("{name}: {error}"));
                continue;
            }
        };
        verdict.solved += 1;
        let residual = problem.residual(&solution).max();
        if residual > RESIDUAL {
            wrong.push(format!("{name}: residual {residual:e}"));
        }
        let Some((other, reference)) = &first else {
            first = Some((name, solution));
            continue;
        };
        let apart = distance(problem, reference, &solution);
        if apart > VELOCITY {
            if several(problem, reference, &solution) {
                verdict.multiple += 1;
            } else {
                let [one, two] = [reference, &solution].map(|s| problem.residual(s).max());
                wrong.push(format!(
                    "{other} and {name}: velocities {apart:e} apart, residuals {one:e} and {two:e}"
                ));
            }
        } else if let Some(apart) = derivatives(problem, reference, &solution) {
            verdict.derivatives += 1;
            if apart > DERIVATIVE || apart.is_nan() {
                wrong.push(format!("{other} and {name}: derivatives {apart:e} apart"));
            }
        }
    }
    if wrong.is_empty() { Ok(verdict) } else { Err(wrong) }
}

/// max √M |v − v'| relative to s*.
pub(super) fn distance(problem: &Lcp, one: &LcpSolution, other: &LcpSolution) -> f64 {
    let mut worst = 0.0_f64;
    for ((mass, a), b) in problem.mass.iter().zip(&one.velocities).zip(&other.velocities) {
        worst = (0..3).fold(worst, |worst, k| worst.max(mass[k].sqrt() * (a[k] - b[k]).abs()));
    }
    if worst == 0.0 { 0.0 } else { worst / Metric::new(problem).scale }
}

/// Whether two answers are two solutions: both solve the problem to rounding and lie on different
/// pieces of a law that allows it. Without friction the velocities are unique.
fn several(problem: &Lcp, one: &LcpSolution, other: &LcpSolution) -> bool {
    let frictional = problem.rows.iter().any(|row| matches!(row.law, Law::Friction { .. }));
    let metric = Metric::new(problem);
    let exact = |solution: &LcpSolution| {
        // Impulses of a jammed body may be thousands of times what drives it, and round accordingly.
        let scaled = |(row, y): (usize, &f64)| metric.impulse(row, *y).abs();
        let impulses = solution.impulses.iter().enumerate().map(scaled);
        let rounding = 4.0 * f64::EPSILON * impulses.fold(0.0, f64::max) / metric.scale;
        problem.residual(solution).max() <= EXACT.max(rounding)
    };
    frictional && one.modes != other.modes && exact(one) && exact(other)
}

/// Greatest difference of the pullbacks of one cotangent relative to their size; `None` on a switch,
/// where each answer may take another one-sided derivative. Where rows depend on each other only the
/// cotangents of momenta and masses are unique, and compared.
fn derivatives(problem: &Lcp, one: &LcpSolution, other: &LcpSolution) -> Option<f64> {
    let wave = |i: usize| (2.3 * i as f64 + 0.4).sin();
    let bar: Vec<Vector3<f64>> =
        (0..problem.mass.len()).map(|i| Vector3::from_fn(|k, _| wave(3 * i + k))).collect();
    let pull = |solution| lcp_vjp(problem, solution, &bar, None).expect("a derivative");
    let ((a, report), (b, other_report)) = (pull(one), pull(other));
    if !report.weak.is_empty() || !other_report.weak.is_empty() || one.modes != other.modes {
        return None;
    }
    let rows = report.rank_defect == 0 && other_report.rank_defect == 0;
    let (a, b) = (flat(problem, &a, rows), flat(problem, &b, rows));
    let size = a.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
    let apart = a.iter().zip(&b).fold(0.0_f64, |apart, (x, y)| apart.max((x - y).abs()));
    Some(if apart == 0.0 { 0.0 } else { apart / size })
}

/// Entries in mass-weighted units.
fn flat(problem: &Lcp, by: &LcpVector, rows: bool) -> Vec<f64> {
    let metric = Metric::new(problem);
    let mut all = Vec::new();
    for (body, mass) in problem.mass.iter().enumerate() {
        for k in 0..3 {
            all.push(by.momentum[body][k] * (metric.unit() * mass[k]).sqrt());
            all.push(by.mass[body][k] * mass[k] / metric.scale);
        }
    }
    if rows {
        for (row, by) in by.rows.iter().enumerate() {
            let RowVector { rhs, bound, .. } = by;
            all.extend([rhs * metric.root(row), bound / metric.scale]);
        }
    }
    all
}
