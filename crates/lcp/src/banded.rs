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
use crate::metric::{WeightedRow, greater};
use crate::{ActiveSystem, Lcp, LcpSolution, Metric, Mode, Residual, Scratch, SolveStats, narrow};

/// Pivots below this belong to rows that depend on others.
const DEPENDENT: f64 = 1e-6;
/// Remainders, relative to s*, that need no further sweep.
const EXACT: f64 = 1e-15;
/// A momentum defect, relative to s*, that needs no allowance for rounding.
const BALANCED: f64 = 1e-14;
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
    let equality = metric.relative(worst);
    let momentum = sweep.momentum_defect(problem, metric);
    let cholesky = Cholesky::factored(BandMatrix::narrow(n, W - 1, band), inverse);
    let mut system = scratch.system();
    if let Some(system) = Arc::get_mut(&mut system) {
        system.become_factored(metric, cholesky, scratch);
    }
    let solution = sweep.finish(metric, system, scratch);
    let mut residual = Residual { momentum, equality, ..Residual::default() };
    if momentum > BALANCED {
        residual = problem.residual_with(metric, &solution, scratch);
    }
    Some((solution, residual))
}

/// Ŝ, each row against those within the band.
fn assemble<const W: usize>(equations: &Equations, band: &mut [f64]) {
    let (entries, _) = band.as_chunks_mut::<W>();
    for (i, entries) in entries.iter_mut().enumerate() {
        let first = (i + 1).saturating_sub(W);
        let (others, row) = (&equations.rows[first..i], &equations.rows[i]);
        let weighted = [0, 1].map(|side| {
            let inverse = &equations.inverse_mass[row.bodies[side] as usize];
            row.jacobian[side].component_mul(inverse)
        });
        let own = weighted[0].dot(&row.jacobian[0]) + weighted[1].dot(&row.jacobian[1]);
        entries[W - 1] = own + row.compliance;
        for (entry, other) in entries[W - 1 - others.len()..].iter_mut().zip(others) {
            *entry = coupling(row.bodies, &weighted, other);
        }
    }
}

/// Jᵢ M⁻¹ Jⱼᵀ, given Jᵢ M⁻¹. What stands in for no body weighs nothing.
#[inline]
fn coupling(bodies: [u32; 2], weighted: &[Vector3<f64>; 2], other: &WeightedRow) -> f64 {
    let mut sum = 0.0;
    for side in 0..2 {
        for of_other in 0..2 {
            if bodies[side] == other.bodies[of_other] {
                sum += weighted[side].dot(&other.jacobian[of_other]);
            }
        }
    }
    sum
}

/// Unknowns of one solve.
struct Sweep {
    /// v, and what stands in for no body.
    v: Vec<Vector3<f64>>,
    /// ŷ.
    y: Vec<f64>,
    /// b̂ − B̂ v − ĉ ŷ, and then the change of ŷ.
    r: Vec<f64>,
    /// B̂ᵀ ŷ, and B̂ᵀ dŷ of the last sweep.
    z: Vec<[Vector3<f64>; 2]>,
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
        let mut z = std::mem::take(&mut scratch.pairs);
        z.clear();
        z.resize(bodies + 1, [Vector3::zeros(); 2]);
        Self { v, y, r, z }
    }

    /// Writes the remainders; returns the greatest, infinite if one is not a number.
    fn remainders(&mut self, equations: &Equations) -> f64 {
        let mut worst = 0.0_f64;
        let mut sum = 0.0;
        for ((row, r), y) in equations.rows.iter().zip(&mut self.r).zip(&self.y) {
            *r = row.rhs - row.velocity(&self.v) - row.compliance * y;
            worst = greater(worst, r.abs());
            sum += *r;
        }
        if sum.is_nan() { f64::INFINITY } else { worst }
    }

    /// ŷ ← ŷ + r,  v ← v + μM⁻¹ B̂ᵀ r.
    fn advance(&mut self, equations: &Equations) {
        for ((row, dy), y) in equations.rows.iter().zip(&self.r).zip(&mut self.y) {
            *y += dy;
            for (body, jacobian) in row.bodies.iter().zip(&row.jacobian) {
                self.z[*body as usize][1] += jacobian * *dy;
            }
        }
        let bodies = self.v.iter_mut().zip(&mut self.z);
        for ((v, [z, dz]), inverse) in bodies.zip(&equations.inverse_mass) {
            *v += dz.component_mul(inverse);
            *z += *dz;
            *dz = Vector3::zeros();
        }
    }

    /// At least [`Residual::momentum`]: the defect relative to s* alone.
    fn momentum_defect(&self, problem: &Lcp, metric: &Metric) -> f64 {
        let (mut worst, mut sum) = (0.0_f64, 0.0);
        let bodies = problem.mass.iter().zip(&problem.momentum).zip(&self.v).zip(&self.z);
        for (body, (((mass, p), v), [z, _])) in bodies.enumerate() {
            let defect = mass.component_mul(v) - p - z * metric.unit();
            let weighted = metric.weighted_momentum(body, &defect);
            worst = weighted.iter().map(|defect| defect.abs()).fold(worst, greater);
            sum += weighted.x + weighted.y + weighted.z;
        }
        metric.relative(if sum.is_nan() { sum } else { worst })
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
        scratch.pairs = self.z;
        LcpSolution {
            velocities: self.v,
            impulses: self.y,
            slacks: self.r,
            modes: scratch.modes.filled(rows.len(), Mode::Active),
            stats: SolveStats { factorisations: 1, ..SolveStats::default() },
            system: Some(system),
            central: None,
        }
    }
}
