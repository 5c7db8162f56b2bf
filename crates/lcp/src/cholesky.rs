//! Cholesky's factorisation of band matrices, without square roots.

use crate::band::{BandMatrix, dot, subtract};
use crate::narrow;

/// A = L D Lᵀ inside the envelope.
#[derive(Clone, Debug)]
pub struct Cholesky {
    matrix: BandMatrix,
    first: Vec<u32>,
    inverse: Vec<f64>,
}

impl Cholesky {
    /// Factors; pivots smaller than `floor` are replaced by it.
    #[must_use]
    pub fn new(matrix: BandMatrix, floor: f64) -> Self {
        Self::in_memory(matrix, floor, (Vec::new(), Vec::new()))
    }

    /// The same in memory that is used again.
    pub(crate) fn in_memory(
        mut matrix: BandMatrix,
        floor: f64,
        (mut first, mut inverse): (Vec<u32>, Vec<f64>),
    ) -> Self {
        let n = matrix.len();
        inverse.resize(n, 0.0);
        let width = matrix.narrow_width();
        let data = &mut matrix.data;
        match width {
            2 => narrow::factor::<2>(data, &mut inverse, floor),
            3 => narrow::factor::<3>(data, &mut inverse, floor),
            4 => narrow::factor::<4>(data, &mut inverse, floor),
            6 => narrow::factor::<6>(data, &mut inverse, floor),
            8 => narrow::factor::<8>(data, &mut inverse, floor),
            _ => {
                first.resize(n, 0);
                factor_envelope(&mut matrix, &mut first, &mut inverse, floor);
            }
        }
        Self { matrix, first, inverse }
    }

    /// Of rows of a narrow band that are factored already.
    pub(crate) fn factored(matrix: BandMatrix, inverse: Vec<f64>) -> Self {
        Self { matrix, first: Vec::new(), inverse }
    }

    /// Its memory.
    pub(crate) fn into_memory(self) -> (Vec<f64>, Vec<u32>, Vec<f64>) {
        (self.matrix.data, self.first, self.inverse)
    }

    /// Pivots in order of elimination.
    pub fn pivots(&self) -> impl Iterator<Item = f64> {
        self.inverse.iter().map(|inverse| inverse.recip())
    }

    /// Number of pivots below a bound.
    pub(crate) fn count_below(&self, bound: f64) -> usize {
        self.inverse.iter().filter(|inverse| *inverse * bound > 1.0).count()
    }

    /// x ← A⁻¹ x.
    pub fn solve(&self, x: &mut [f64]) {
        let (data, inverse) = (&self.matrix.data, &self.inverse);
        match self.matrix.narrow_width() {
            2 => narrow::solve::<2>(data, inverse, x),
            3 => narrow::solve::<3>(data, inverse, x),
            4 => narrow::solve::<4>(data, inverse, x),
            6 => narrow::solve::<6>(data, inverse, x),
            8 => narrow::solve::<8>(data, inverse, x),
            _ => self.solve_envelope(x),
        }
    }

    fn solve_envelope(&self, x: &mut [f64]) {
        let n = self.matrix.len();
        for i in 0..n {
            let from = self.first[i] as usize;
            x[i] -= dot(self.matrix.row(i, from, i), &x[from..i]);
        }
        x.iter_mut().zip(&self.inverse).for_each(|(x, inverse)| *x *= inverse);
        for i in (0..n).rev() {
            let from = self.first[i] as usize;
            let value = x[i];
            subtract(&mut x[from..i], value, self.matrix.row(i, from, i));
        }
    }
}

/// The formulas of [`narrow`]; the c of a row are kept in its place until it is done.
#[expect(clippy::cast_possible_truncation, reason = "row indices are u32")]
fn factor_envelope(matrix: &mut BandMatrix, first: &mut [u32], inverse: &mut [f64], floor: f64) {
    for i in 0..matrix.len() {
        let start = matrix.columns(i).start;
        let from = start + matrix.row(i, start, i).iter().take_while(|&&a| a == 0.0).count();
        first[i] = from as u32;
        let base = matrix.at(i, 0);
        for (j, first) in first.iter().enumerate().take(i).skip(from) {
            let common = from.max(*first as usize);
            let sum = dot(matrix.row(i, common, j), matrix.row(j, common, j));
            matrix.data[base + j] -= sum;
        }
        let mut pivot = matrix.get(i, i);
        for (c, inverse) in matrix.data[base + from..base + i].iter_mut().zip(&inverse[from..i]) {
            let l = *c * inverse;
            pivot -= *c * l;
            *c = l;
        }
        inverse[i] = pivot.max(floor).recip();
    }
}
