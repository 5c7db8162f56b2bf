//! Projected Gauss–Seidel: every row in turn takes the impulse that its own law asks for, with the
//! others as they are (Jean & Moreau 1987; Jourdan, Alart & Jean 1998).
//!
//! ```text
//!  λᵢ ← proj(λᵢ − uᵢ/Wᵢᵢ)          v ← v + M⁻¹ Jᵢᵀ Δλᵢ
//! ```
//!
//! It needs no matrix and does not get stuck where Newton's method does, but gains a digit in a
//! hundred sweeps at best: an approximate solution for the polish to start from.

use nalgebra::Vector3;

use crate::{Law, Lcp, LcpSolution};

/// The iterate: impulses, and the velocities that they make.
#[derive(Clone, Debug)]
pub struct Sweeps<'a> {
    problem: &'a Lcp,
    weights: Vec<f64>,
    velocities: Vec<Vector3<f64>>,
    impulses: Vec<f64>,
}

impl<'a> Sweeps<'a> {
    /// Begins at the free velocities.
    #[must_use]
    pub fn new(problem: &'a Lcp) -> Self {
        let weights: Vec<f64> = (0..problem.rows.len()).map(|i| problem.row_weight(i)).collect();
        let impulses = vec![0.0; weights.len()];
        Self { problem, weights, velocities: problem.free_velocities(), impulses }
    }

    /// Begins at impulses within their laws.
    #[must_use]
    pub fn from(problem: &'a Lcp, impulses: Vec<f64>) -> Self {
        let velocities = problem.velocities(&impulses);
        Self { velocities, impulses, ..Self::new(problem) }
    }

    /// All rows forwards, then backwards, and friction once more: the normal impulses that bound it
    /// came after it.
    pub fn sweep(&mut self) {
        let count = self.impulses.len();
        for row in (0..count).chain((0..count).rev()) {
            self.relax(row);
        }
        for row in 0..count {
            if matches!(self.problem.rows[row].law, Law::Friction { .. }) {
                self.relax(row);
            }
        }
    }

    /// The iterate; slacks and modes are left out.
    #[must_use]
    pub fn approximate(&self) -> LcpSolution {
        // Velocities from the impulses anew: updates have added up rounding.
        let (impulses, velocities) =
            (self.impulses.clone(), self.problem.velocities(&self.impulses));
        LcpSolution { velocities, impulses, ..LcpSolution::default() }
    }

    fn relax(&mut self, index: usize) {
        let row = &self.problem.rows[index];
        let before = self.impulses[index];
        let u = row.velocity(&self.velocities) + row.compliance * before - row.rhs;
        let wanted = before - u / self.weights[index];
        let after = match row.law {
            Law::Equality => wanted,
            Law::Unilateral => wanted.max(0.0),
            Law::Bounded { max } => wanted.clamp(-max, max),
            Law::Friction { normal, mu } => {
                let bound = mu * self.impulses[normal as usize];
                wanted.clamp(-bound, bound)
            }
        };
        self.impulses[index] = after;
        for (body, block) in row.blocks() {
            let change = (after - before) * block;
            self.velocities[body] += change.component_div(&self.problem.mass[body]);
        }
    }
}
