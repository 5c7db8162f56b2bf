//! How much faster a solution moves than what drives it.
//!
//! ```text
//!  r = √(I/m)      |v| = max( |v_xy|, r |ω| )      |J| = max over the sides of  |(J_xy, J_θ/r)|
//!
//!  amplification = max |v|  /  ( max |M⁻¹ p|  +  max |bᵢ|/|Jᵢ| )
//! ```
//!
//! over the rows that drive: equalities, and inequalities with b > 0. Nearly dependent rows that
//! ask for different things can make it any large number; a rigid body that is pushed has about 1.

#![expect(non_snake_case, reason = "matrices carry their names from the notes")]

use nalgebra::Vector3;

use crate::{Law, Lcp, LcpSolution, Row};

impl Lcp {
    /// Whether [`amplification`](Self::amplification) is at most `bound`, by the bodies alone where that
    /// tells.
    #[must_use]
    pub fn is_calm(&self, solution: &LcpSolution, bound: f64) -> bool {
        let energy = |v: &Vector3<f64>, ratio: f64| v.xy().norm_squared().max(v.z * v.z * ratio);
        let (mut before, mut after) = (0.0_f64, 0.0_f64);
        for ((m, p), v) in self.mass.iter().zip(&self.momentum).zip(&solution.velocities) {
            let inverse = m.x.recip();
            before = before.max(p.xy().norm_squared() * (inverse * inverse));
            before = before.max(p.z * p.z / m.z * inverse);
            after = after.max(energy(v, m.z * inverse));
        }
        after <= bound * bound * before || self.amplification(solution) <= bound
    }

    /// The greatest speed over what drives it; 0 where nothing moves.
    #[must_use]
    pub fn amplification(&self, solution: &LcpSolution) -> f64 {
        let greatest = |list: &mut dyn Iterator<Item = f64>| list.fold(0.0, f64::max);
        let speed =
            |(v, m): (&Vector3<f64>, &Vector3<f64>)| v.xy().norm().max(v.z.abs() * gyration(m));
        let before = greatest(&mut self.free_velocities().iter().zip(&self.mass).map(speed));
        let after = greatest(&mut solution.velocities.iter().zip(&self.mass).map(speed));
        let drives = |row: &&Row| row.law == Law::Equality || row.rhs > 0.0;
        let demand = |row: &Row| row.rhs.abs() / self.span(row);
        let driven = greatest(&mut self.rows.iter().filter(drives).map(demand));
        if after > 0.0 { after / (before + driven) } else { 0.0 }
    }

    /// |J| of a row with at least one body; 1 for a row without influence.
    fn span(&self, row: &Row) -> f64 {
        let side = |(body, J): (usize, &Vector3<f64>)| {
            J.xy().norm().hypot(J.z / gyration(&self.mass[body]))
        };
        let span = row.blocks().map(side).fold(0.0, f64::max);
        if span > 0.0 { span } else { 1.0 }
    }
}

fn gyration(mass: &Vector3<f64>) -> f64 {
    (mass.z / mass.x).sqrt()
}
