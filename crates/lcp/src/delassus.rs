//! The rows' own matrix W = J M⁻¹ Jᵀ + diag(c), scaled to unit diagonal and stored as a band.

use nalgebra::Vector3;

use crate::band::BandMatrix;
use crate::equations::Equations;
use crate::{ActiveSystem, Law, Lcp, Metric, Scratch, order};

/// Ŵ = R μ W R with R = diag(1/√(μ Wᵢᵢ)), m × m, in an order of the rows in which it is a narrow band.
#[derive(Clone, Debug)]
pub struct Delassus {
    /// Row of the problem at each position.
    pub rows: Vec<u32>,
    /// Ŵ, both triangles.
    pub matrix: BandMatrix,
}

impl Delassus {
    /// Assembles over bodies that rows share. The band also holds every pair of a friction row and
    /// its normal row.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "row indices are u32")]
    pub fn new(problem: &Lcp, metric: &Metric) -> Self {
        let (mut scratch, mut equations) = (Scratch::default(), Equations::default());
        let mut rows: Vec<u32> = (0..problem.rows.len() as u32).collect();
        let natural = order::half_width(problem, &rows, &mut scratch.spans);
        let half_width = order::narrow(problem, &mut rows, natural, &mut scratch);
        let half_width = half_width.max(coupling_width(problem, &rows));
        let system = ActiveSystem::of_all(rows, metric);
        equations.gather(problem, metric, &system);
        let mut matrix = BandMatrix::zeros(equations.rows.len(), half_width);
        Assembly::new(&equations, false, &mut scratch).add_rows(&mut matrix);
        Self { rows: system.rows, matrix }
    }
}

/// Greatest distance of a friction row from its normal row.
fn coupling_width(problem: &Lcp, rows: &[u32]) -> usize {
    let mut position = vec![0; rows.len()];
    for (slot, &row) in rows.iter().enumerate() {
        position[row as usize] = slot;
    }
    let distance = |(index, row): (usize, &crate::Row)| match row.law {
        Law::Friction { normal, .. } => position[index].abs_diff(position[normal as usize]),
        _ => 0,
    };
    problem.rows.iter().enumerate().map(distance).max().unwrap_or(0)
}

/// Writes B̂ μM⁻¹ Ĉᵀ + ĉ into a band matrix. The entries of a body, 2 · slot + side, are linked from the
/// last that was added to the first.
pub(crate) struct Assembly<'a> {
    equations: &'a Equations,
    lower_only: bool,
    /// Last entry of each body.
    last: Vec<u32>,
    /// The entry before each.
    before: Vec<u32>,
}

/// Ends a list.
const END: u32 = u32::MAX;

impl<'a> Assembly<'a> {
    /// An empty matrix.
    pub(crate) fn new(equations: &'a Equations, lower_only: bool, scratch: &mut Scratch) -> Self {
        let last = scratch.indices.filled(equations.mass.len(), END);
        let before = scratch.indices.filled(2 * equations.rows.len(), END);
        Self { equations, lower_only, last, before }
    }

    /// Gives its memory back.
    pub(crate) fn give(self, scratch: &mut Scratch) {
        scratch.indices.give(self.last);
        scratch.indices.give(self.before);
    }

    /// Every row against itself and those before it.
    pub(crate) fn add_rows(&mut self, matrix: &mut BandMatrix) {
        for (slot, row) in self.equations.rows.iter().enumerate() {
            matrix.add(slot, slot, row.compliance);
            for side in 0..2 {
                let body = row.bodies[side] as usize;
                let Some(last) = self.last.get(body) else { continue };
                let weighted = row.jacobian[side].component_mul(&self.equations.inverse_mass[body]);
                matrix.add(slot, slot, weighted.dot(&row.jacobian[side]));
                self.walk(*last, &weighted, |other, value| {
                    matrix.add(slot, other, value);
                    if !self.lower_only {
                        matrix.add(other, slot, value);
                    }
                });
                self.link(slot, side, body);
            }
        }
    }

    /// Sliding friction as part of its normal row's column.
    pub(crate) fn add_folds(&mut self, matrix: &mut BandMatrix) {
        for fold in &self.equations.folds {
            for side in 0..2 {
                let body = fold.bodies[side] as usize;
                let Some(last) = self.last.get(body) else { continue };
                let weighted =
                    fold.jacobian[side].component_mul(&self.equations.inverse_mass[body]);
                self.walk(*last, &weighted, |slot, value| {
                    matrix.add(slot, fold.column as usize, value);
                });
            }
        }
    }

    /// Calls with the slot of each entry in a body's list, and its product with a column.
    fn walk(&self, mut entry: u32, column: &Vector3<f64>, mut add: impl FnMut(usize, f64)) {
        while entry != END {
            let (slot, side) = (entry as usize / 2, entry as usize % 2);
            add(slot, self.equations.rows[slot].jacobian[side].dot(column));
            entry = self.before[entry as usize];
        }
    }

    #[expect(clippy::cast_possible_truncation, reason = "row counts are u32")]
    fn link(&mut self, slot: usize, side: usize, body: usize) {
        let entry = 2 * slot + side;
        self.before[entry] = std::mem::replace(&mut self.last[body], entry as u32);
    }
}
