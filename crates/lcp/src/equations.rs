//! The equations of the active rows, weighted, and the sweeps that refine their solution.
//!
//! ```text
//!  B̂ v + ĉ ŷ = b̂          M v − μ Ĉᵀ ŷ = p          Ĉ = B̂ with the sliding friction folded in
//!
//!  r = b̂ − B̂ v − ĉ ŷ,   dŷ = (Ŝ + ε I)⁻¹ r,   ŷ ← ŷ + dŷ,   v ← v + μM⁻¹ Ĉᵀ dŷ
//! ```
//!
//! The velocities take the small changes and not the sum of large impulses: under mass ratios of 10⁸
//! they still satisfy the rows to rounding. The transposed system, M v + μ B̂ᵀ ŷ = p, −Ĉ v + ĉ ŷ = b̂,
//! goes the same way.

#![expect(non_snake_case, reason = "matrices carry their names from the notes")]

use nalgebra::Vector3;

use crate::metric::WeightedRow;
use crate::{ActiveSystem, Fold, Lcp, Metric, NO_BODY, Row, Scratch};

/// The system as such, or its transpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    /// As such.
    Forward,
    /// Transposed.
    Transposed,
}

/// Sliding friction: `coefficient` J_t/√(μ W_n), whose impulse is ŷ of a slot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WeightedFold {
    /// Slot of the normal row.
    pub(crate) column: u32,
    /// Bodies of the friction row.
    pub(crate) bodies: [u32; 2],
    /// Its Jacobian, weighted.
    pub(crate) jacobian: [Vector3<f64>; 2],
}

impl WeightedFold {
    fn velocity(&self, v: &[Vector3<f64>]) -> f64 {
        let [a, b] = self.bodies.map(|body| body as usize);
        self.jacobian[0].dot(&v[a]) + self.jacobian[1].dot(&v[b])
    }

    fn add_transposed(&self, y: f64, z: &mut [Vector3<f64>]) {
        let [a, b] = self.bodies.map(|body| body as usize);
        z[a] += self.jacobian[0] * y;
        z[b] += self.jacobian[1] * y;
    }
}

/// The active rows in the order of a system's slots, with the folded friction and the masses.
#[derive(Clone, Debug, Default)]
pub(crate) struct Equations {
    /// Per slot.
    pub(crate) rows: Vec<WeightedRow>,
    /// Which run of rows over the same bodies a slot belongs to.
    pub(crate) runs: Vec<u32>,
    /// Sliding friction.
    pub(crate) folds: Vec<WeightedFold>,
    /// M/μ per body.
    pub(crate) mass: Vec<Vector3<f64>>,
    /// μ/M per body, and 0 for what stands in for no body.
    pub(crate) inverse_mass: Vec<Vector3<f64>>,
}

impl Equations {
    /// Those of a system whose rows and folds are known.
    pub(crate) fn gather(&mut self, problem: &Lcp, metric: &Metric, system: &ActiveSystem) {
        self.rows.clear();
        self.rows.extend(system.rows.iter().map(|row| metric.equations.rows[*row as usize]));
        self.mass.clone_from(&metric.equations.mass);
        self.inverse_mass.clone_from(&metric.equations.inverse_mass);
        self.fold(problem, &system.folds);
    }

    /// The same without a metric, for a system that knows its weights.
    pub(crate) fn gather_again(&mut self, problem: &Lcp, system: &ActiveSystem) {
        let none = no_body(problem);
        let weigh = |(row, inverse): (&u32, &f64)| {
            let row = &problem.rows[*row as usize];
            WeightedRow {
                bodies: bodies(row, none),
                jacobian: row.jacobian.map(|J| J * *inverse),
                rhs: row.rhs * inverse,
                compliance: row.compliance * (inverse * inverse * system.unit),
                inverse: *inverse,
            }
        };
        self.rows.clear();
        self.rows.extend(system.rows.iter().zip(&system.inverse).map(weigh));
        self.weigh_bodies(problem, system.unit);
        self.fold(problem, &system.folds);
    }

    /// Numbers the rows of the problem that share their bodies with the row before, for rows in
    /// ascending order.
    pub(crate) fn find_runs(&mut self, problem: &Lcp, rows: &[u32]) {
        self.runs.clear();
        let (mut run, mut at) = (0, 0);
        for row in rows.iter().map(|row| *row as usize) {
            while at < row {
                at += 1;
                run += u32::from(problem.rows[at].bodies != problem.rows[at - 1].bodies);
            }
            self.runs.push(run);
        }
    }

    /// M/μ and μ/M of the bodies.
    pub(crate) fn weigh_bodies(&mut self, problem: &Lcp, unit: f64) {
        self.mass.clear();
        self.inverse_mass.clear();
        let per_unit = unit.recip();
        self.mass.extend(problem.mass.iter().map(|mass| mass * per_unit));
        self.inverse_mass.extend(self.mass.iter().map(|mass| mass.map(f64::recip)));
        self.inverse_mass.push(Vector3::zeros());
    }

    fn fold(&mut self, problem: &Lcp, folds: &[Fold]) {
        let none = no_body(problem);
        self.folds.clear();
        for fold in folds {
            let factor = fold.coefficient * self.rows[fold.column as usize].inverse;
            let row = &problem.rows[fold.row as usize];
            let (column, bodies) = (fold.column, bodies(row, none));
            let jacobian = row.jacobian.map(|J| J * factor);
            self.folds.push(WeightedFold { column, bodies, jacobian });
        }
    }

    /// Whether friction slides on other bodies than its normal row.
    pub(crate) fn folds_are_foreign(&self) -> bool {
        self.folds.iter().any(|fold| fold.bodies != self.rows[fold.column as usize].bodies)
    }

    /// Largest entry of a right-hand side (p/μ, b̂) in mass-weighted units.
    pub(crate) fn scale(&self, momentum: &[Vector3<f64>], rhs: &[f64]) -> f64 {
        let energy = |(p, inverse): (&Vector3<f64>, &Vector3<f64>)| {
            p.component_mul(p).component_mul(inverse).max()
        };
        let energies = momentum.iter().zip(&self.inverse_mass).map(energy);
        let of_bodies = energies.fold(0.0, f64::max).sqrt();
        rhs.iter().fold(of_bodies, |scale, b| scale.max(b.abs()))
    }

    /// v ← v + μM⁻¹ z;  z ← 0.
    pub(crate) fn advance(&self, z: &mut [Vector3<f64>], v: &mut [Vector3<f64>]) {
        for ((z, v), inverse) in z.iter_mut().zip(v).zip(&self.inverse_mass) {
            *v += z.component_mul(inverse);
            *z = Vector3::zeros();
        }
    }

    /// r = b̂ − B̂ v − ĉ ŷ, or b̂ + Ĉ v − ĉ ŷ; returns the greatest.
    pub(crate) fn remainder(
        &self,
        side: Side,
        rhs: &[f64],
        v: &[Vector3<f64>],
        y: &[f64],
        r: &mut [f64],
    ) -> f64 {
        let sign = if side == Side::Forward { -1.0 } else { 1.0 };
        for (slot, row) in self.rows.iter().enumerate() {
            r[slot] = rhs[slot] + sign * row.velocity(v) - row.compliance * y[slot];
        }
        if side == Side::Transposed {
            for fold in &self.folds {
                r[fold.column as usize] += fold.velocity(v);
            }
        }
        r.iter()
            .fold(0.0, |worst: f64, r| if r.is_nan() { f64::INFINITY } else { worst.max(r.abs()) })
    }

    /// z ← z + Ĉᵀ ŷ, or z − B̂ᵀ ŷ: what impulses change a momentum by.
    pub(crate) fn add_impulses(&self, side: Side, y: &[f64], z: &mut [Vector3<f64>]) {
        if side == Side::Forward {
            return self.add_transposed(side, y, z);
        }
        for (row, y) in self.rows.iter().zip(y) {
            row.add_transposed(-y, z);
        }
    }

    /// Ŝ ŷ.
    pub(crate) fn products(&self, y: &[f64], out: &mut Vec<f64>, scratch: &mut Scratch) {
        let mut z = scratch.vectors.filled(self.mass.len() + 1, Vector3::zeros());
        let mut v = scratch.vectors.filled(self.mass.len() + 1, Vector3::zeros());
        self.add_impulses(Side::Forward, y, &mut z);
        self.advance(&mut z, &mut v);
        out.clear();
        out.extend(self.rows.iter().zip(y).map(|(row, y)| row.velocity(&v) + row.compliance * y));
        scratch.vectors.give(z);
        scratch.vectors.give(v);
    }

    /// z ← z + Ĉᵀ ŷ, or z + B̂ᵀ ŷ.
    pub(crate) fn add_transposed(&self, side: Side, y: &[f64], z: &mut [Vector3<f64>]) {
        for (row, y) in self.rows.iter().zip(y) {
            row.add_transposed(*y, z);
        }
        if side == Side::Forward {
            for fold in &self.folds {
                fold.add_transposed(y[fold.column as usize], z);
            }
        }
    }

    /// B̂ v, or Ĉ v, slot by slot.
    pub(crate) fn velocities(&self, side: Side, v: &[Vector3<f64>], out: &mut [f64]) {
        for (out, row) in out.iter_mut().zip(&self.rows) {
            *out = row.velocity(v);
        }
        if side == Side::Transposed {
            for fold in &self.folds {
                out[fold.column as usize] += fold.velocity(v);
            }
        }
    }
}

fn bodies(row: &Row, none: u32) -> [u32; 2] {
    row.bodies.map(|body| if body == NO_BODY { none } else { body })
}

fn no_body(problem: &Lcp) -> u32 {
    u32::try_from(problem.mass.len()).expect("fewer bodies than u32 counts")
}
