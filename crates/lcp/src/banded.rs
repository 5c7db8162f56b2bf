//! Equalities in a narrow band: chains and small machines.
//!
//! What [`ActiveSystem`](crate::ActiveSystem) does for any rows, in as few passes as there are
//! dependences: weighted rows as they are, a band whose width the compiler knows, no list of what is
//! active, and the residual from the remainders that the sweep needs anyway. Only for rows that do not
//! depend on each other.

use std::sync::Arc;

use nalgebra::Vector3;

use crate::band::BandMatrix;
use crate::cholesky::Cholesky;
use crate::equations::Equations;
use crate::metric::quotient;
use crate::residual::ROUNDING;
use crate::{ActiveSystem, Lcp, LcpSolution, Metric, Mode, Residual, Scratch, SolveStats, narrow};

/// Pivots below this belong to rows that depend on others.
const DEPENDENT: f64 = 1e-6;
/// Remainders, relative to s*, that need no further sweep.
const EXACT: f64 = 1e-15;
const MOST_SWEEPS: usize = 3;

/// Solves a problem of equalities; `None` if its band is too wide or its rows depend on each other.
pub(crate) fn solve_banded(
    problem: &Lcp,
    metric: &Metric,
    scratch: &mut Scratch,
) -> Option<(LcpSolution, Residual)> {
    match narrow::rounded(metric.width)? {
        1 => solve_in::<2>(problem, metric, scratch),
        2 => solve_in::<3>(problem, metric, scratch),
        3 => solve_in::<4>(problem, metric, scratch),
        5 => solve_in::<6>(problem, metric, scratch),
        _ => solve_in::<8>(problem, metric, scratch),
    }
}

fn solve_in<const W: usize>(
    problem: &Lcp,
    metric: &Metric,
    scratch: &mut Scratch,
) -> Option<(LcpSolution, Residual)> {
    let equations = &metric.equations;
    let n = equations.rows.len();
    let mut band = scratch.floats.filled(n * W, 0.0);
    let mut inverse = scratch.floats.filled(n, 0.0);
    assemble::<W>(equations, &mut band);
    narrow::factor::<W>(&mut band, &mut inverse, f64::MIN_POSITIVE);
    if inverse.iter().any(|inverse| inverse * DEPENDENT > 1.0) {
        scratch.floats.give(band);
        scratch.floats.give(inverse);
        return None;
    }
    let mut sweep = Sweep::new(problem, metric, scratch);
    let mut worst = sweep.remainders(equations);
    for _ in 0..MOST_SWEEPS {
        narrow::solve::<W>(&band, &inverse, &mut sweep.r);
        sweep.advance(equations);
        worst = sweep.remainders(equations);
        if worst <= EXACT * metric.scale {
            break;
        }
    }
    let momentum = sweep.momentum_defect(problem, metric, scratch);
    let equality = metric.relative(worst);
    let cholesky = Cholesky::factored(BandMatrix::narrow(n, W - 1, band), inverse);
    let mut system = scratch.system();
    if let Some(system) = Arc::get_mut(&mut system) {
        system.become_factored(metric, cholesky, scratch);
    }
    let solution = sweep.finish(metric, system, scratch);
    Some((solution, Residual { momentum, equality, ..Residual::default() }))
}

/// Ŝ, each row against those within the band.
fn assemble<const W: usize>(equations: &Equations, band: &mut [f64]) {
    let (entries, _) = band.as_chunks_mut::<W>();
    for (i, (row, entries)) in equations.rows.iter().zip(entries).enumerate() {
        let [a, b] = row.bodies;
        let weighted = [0, 1].map(|side| {
            let inverse = &equations.inverse_mass[row.bodies[side] as usize];
            row.jacobian[side].component_mul(inverse)
        });
        let product = |side: usize, other: &Vector3<f64>| weighted[side].dot(other);
        let own = product(0, &row.jacobian[0]) + product(1, &row.jacobian[1]);
        entries[W - 1] = own + row.compliance;
        for (k, entry) in entries.iter_mut().enumerate().take(W - 1).skip((W - 1).saturating_sub(i))
        {
            let other = &equations.rows[i + k + 1 - W];
            for (body, jacobian) in other.bodies.iter().zip(&other.jacobian) {
                // What stands in for no body weighs nothing.
                if *body == a {
                    *entry += product(0, jacobian);
                }
                if *body == b {
                    *entry += product(1, jacobian);
                }
            }
        }
    }
}

/// Unknowns of one solve.
struct Sweep {
    /// v, and what stands in for no body.
    v: Vec<Vector3<f64>>,
    /// ŷ.
    y: Vec<f64>,
    /// b̂ − B̂ v − ĉ ŷ, and then the change of ŷ.
    r: Vec<f64>,
    /// B̂ᵀ dŷ of the last sweep.
    z: Vec<Vector3<f64>>,
}

impl Sweep {
    /// At the free velocities.
    fn new(problem: &Lcp, metric: &Metric, scratch: &mut Scratch) -> Self {
        let (rows, bodies) = (problem.rows.len(), problem.mass.len());
        let mut v = scratch.vectors.take();
        let per_unit = metric.unit().recip();
        let free =
            |(p, inverse): (&Vector3<f64>, &Vector3<f64>)| (p * per_unit).component_mul(inverse);
        v.extend(problem.momentum.iter().zip(&metric.equations.inverse_mass).map(free));
        v.push(Vector3::zeros());
        let (y, r) = (scratch.floats.filled(rows, 0.0), scratch.floats.filled(rows, 0.0));
        Self { v, y, r, z: scratch.vectors.filled(bodies + 1, Vector3::zeros()) }
    }

    /// Writes the remainders; returns the greatest, infinite if one is not a number.
    fn remainders(&mut self, equations: &Equations) -> f64 {
        let mut worst = 0.0_f64;
        let mut sum = 0.0;
        for ((row, r), y) in equations.rows.iter().zip(&mut self.r).zip(&self.y) {
            *r = row.rhs - row.velocity(&self.v) - row.compliance * y;
            worst = worst.max(r.abs());
            sum += *r;
        }
        if sum.is_nan() { f64::INFINITY } else { worst }
    }

    /// ŷ ← ŷ + r,  v ← v + μM⁻¹ B̂ᵀ r.
    fn advance(&mut self, equations: &Equations) {
        self.z.fill(Vector3::zeros());
        for ((row, dy), y) in equations.rows.iter().zip(&self.r).zip(&mut self.y) {
            *y += dy;
            row.add_transposed(*dy, &mut self.z);
        }
        for ((v, z), inverse) in self.v.iter_mut().zip(&self.z).zip(&equations.inverse_mass) {
            *v += z.component_mul(inverse);
        }
    }

    /// As [`Residual::momentum`].
    fn momentum_defect(&mut self, problem: &Lcp, metric: &Metric, scratch: &mut Scratch) -> f64 {
        let Metric { equations, scale, .. } = metric;
        let balance = &mut self.z;
        balance.fill(Vector3::zeros());
        let mut acting = scratch.vectors.filled(balance.len(), Vector3::zeros());
        for (row, y) in equations.rows.iter().zip(&self.y) {
            for (body, jacobian) in row.bodies.iter().zip(&row.jacobian) {
                let (body, change) = (*body as usize, jacobian * *y);
                balance[body] += change;
                acting[body] += change.abs();
            }
        }
        let (unit, mut worst) = (metric.unit(), 0.0_f64);
        for (body, p) in problem.momentum.iter().enumerate() {
            let held = problem.mass[body].component_mul(&self.v[body]);
            let defect = metric.weighted_momentum(body, &(held - p - balance[body] * unit));
            let acting = metric.weighted_momentum(body, &(acting[body] * unit));
            for k in 0..3 {
                worst = worst.max(quotient(defect[k].abs(), scale + ROUNDING * acting[k]));
            }
        }
        scratch.vectors.give(acting);
        worst
    }

    fn finish(
        mut self,
        metric: &Metric,
        system: Arc<ActiveSystem>,
        scratch: &mut Scratch,
    ) -> LcpSolution {
        let rows = &metric.equations.rows;
        self.r.clear();
        self.r.resize(rows.len(), 0.0); // equalities leave nothing over
        for (y, row) in self.y.iter_mut().zip(rows) {
            *y *= metric.unit() * row.inverse;
        }
        self.v.pop();
        scratch.vectors.give(self.z);
        LcpSolution {
            velocities: self.v,
            impulses: self.y,
            slacks: self.r,
            modes: scratch.modes.filled(rows.len(), Mode::Active),
            stats: SolveStats { factorisations: 1, ..SolveStats::default() },
            system: Some(system),
        }
    }
}
