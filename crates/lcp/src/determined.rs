//! What dependent rows determine of a linear function of their impulses.
//!
//! ```text
//!  ŝ = ŝ_r + ŝ_0,   ŝ_r in the range of Ŝᵀ,   Ŝᵀ ŝ_0 = 0          ȳ·dy = ŝ·dŷ = ŝ_r·dŷ  for the least dŷ
//!
//!  Ŝᵀ ŷ = Ŝᵀ ŝ,  ŷ from zero:   ŷ = ŝ_r
//! ```
//!
//! Only ŝ_r may go into the transposed system: along ŝ_0 it has no solution.

use nalgebra::Vector3;

use crate::{ActiveSystem, Lcp, Reduced, Scratch};

impl ActiveSystem {
    /// Replaces a cotangent of the active impulses (per active row) by what of it is determined, if that
    /// is less than all by more than `tolerance` times its norm; whether it was. `room` is overwritten.
    pub fn determined(
        &self,
        problem: &Lcp,
        bar: &mut [f64],
        tolerance: f64,
        scratch: &mut Scratch,
        room: &mut Reduced,
    ) -> bool {
        // y = μ D ŷ and ŝ = D ȳ, so that ŷ = ŝ is y = μ D² ȳ.
        let weight = |slot: usize| self.unit * self.inverse[slot] * self.inverse[slot];
        let mut momentum = vec![Vector3::zeros(); problem.mass.len()];
        let mut rhs = Vec::with_capacity(bar.len());
        for (slot, (row, bar)) in self.rows.iter().zip(bar.iter()).enumerate() {
            let (row, y) = (&problem.rows[*row as usize], weight(slot) * bar);
            row.add_transposed(y, &mut momentum);
            rhs.push(row.compliance * y);
        }
        self.solve_transpose_into(problem, &momentum, &rhs, scratch, room);
        let (mut all, mut dropped) = (0.0, 0.0);
        for (slot, (y, bar)) in room.impulses.iter_mut().zip(bar.iter()).enumerate() {
            *y /= weight(slot);
            all += weight(slot) * bar * bar;
            dropped += weight(slot) * (bar - *y) * (bar - *y);
        }
        let less = dropped > tolerance * tolerance * all;
        if less {
            bar.copy_from_slice(&room.impulses);
        }
        less
    }
}
