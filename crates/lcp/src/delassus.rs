//! The rows' own matrix W = J M⁻¹ Jᵀ + diag(c), scaled to unit diagonal and stored as a band.

#![expect(non_snake_case, reason = "matrices carry their names from the paper")]

use crate::band::BandMatrix;
use crate::order;
use crate::rows::Touching;
use crate::{Law, Lcp, Metric};

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
        let mut rows: Vec<u32> = (0..problem.rows.len() as u32).collect();
        let half_width = order::narrow(problem, &mut rows).max(coupling_width(problem, &rows));
        let scaling = Scaling::new(metric, &rows);
        let mut matrix = BandMatrix::zeros(rows.len(), half_width);
        Assembly::new(problem, &rows, &scaling, false).add_rows(&mut matrix);
        Self { rows, matrix }
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

/// How rows listed in some order are scaled.
#[derive(Clone, Debug)]
pub(crate) struct Scaling {
    /// 1/√(μ Wᵢᵢ) per slot: times a remainder it gives û.
    pub(crate) of_remainder: Vec<f64>,
    /// μ/√(μ Wᵢᵢ) per slot: times ŷ it gives an impulse.
    pub(crate) to_impulse: Vec<f64>,
    /// μ.
    pub(crate) unit: f64,
}

impl Scaling {
    pub(crate) fn new(metric: &Metric, rows: &[u32]) -> Self {
        let unit = metric.unit();
        let of_remainder: Vec<f64> =
            rows.iter().map(|&row| metric.root(row as usize).recip()).collect();
        let to_impulse = of_remainder.iter().map(|inverse| inverse * unit).collect();
        Self { of_remainder, to_impulse, unit }
    }
}

/// Writes columns of R J M⁻¹ Jᵀ μ R into a band matrix.
pub(crate) struct Assembly<'a> {
    problem: &'a Lcp,
    rows: &'a [u32],
    scaling: &'a Scaling,
    touching: Touching,
    lower_only: bool,
}

impl<'a> Assembly<'a> {
    /// For the rows listed, in that order.
    pub(crate) fn new(
        problem: &'a Lcp,
        rows: &'a [u32],
        scaling: &'a Scaling,
        lower_only: bool,
    ) -> Self {
        let touching = Touching::new(problem, rows.iter().map(|&row| row as usize));
        Self { problem, rows, scaling, touching, lower_only }
    }

    /// Every listed row as the column of its own, and the compliance.
    pub(crate) fn add_rows(&self, matrix: &mut BandMatrix) {
        for (slot, &row) in self.rows.iter().enumerate() {
            self.add_column(matrix, row, slot, 1.0);
            let compliance = self.problem.rows[row as usize].compliance;
            let Scaling { of_remainder, to_impulse, .. } = self.scaling;
            matrix.add(slot, slot, compliance * of_remainder[slot] * to_impulse[slot]);
        }
    }

    /// `coefficient` times row `row` as part of column `column`.
    pub(crate) fn add_column(
        &self,
        matrix: &mut BandMatrix,
        row: u32,
        column: usize,
        coefficient: f64,
    ) {
        let factor = coefficient * self.scaling.to_impulse[column];
        for (body, J) in self.problem.rows[row as usize].blocks() {
            let weighted = factor * J.component_div(&self.problem.mass[body]);
            for &(slot, side) in self.touching.of(body) {
                let (slot, side) = (slot as usize, side as usize);
                if self.lower_only && slot < column {
                    continue;
                }
                let B = &self.problem.rows[self.rows[slot] as usize].jacobian[side];
                matrix.add(slot, column, self.scaling.of_remainder[slot] * B.dot(&weighted));
            }
        }
    }
}
