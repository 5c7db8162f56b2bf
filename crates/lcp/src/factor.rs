//! A factored Ŝ + ε I: by rows, or by bodies.

#![expect(non_snake_case, reason = "matrices carry their names from the notes")]

use crate::Scratch;
use crate::band::{BandMatrix, Lu};
use crate::block_factor::BlockFactor;
use crate::cholesky::Cholesky;
use crate::delassus::Assembly;
use crate::equations::{Equations, Side};

/// ε: dependent rows stay solvable, independent ones converge in two or three sweeps. Impulses along
/// dependent directions carry a noise of 10⁻¹⁶/ε; larger values cost sweeps under mass ratios.
pub(crate) const PROXIMAL: f64 = 1e-9;

/// ε of a first attempt where all rows are equalities: enough unless rows depend on each other.
const LEAST: f64 = 1e-14;
/// Pivots below this tell that they do.
const DEPENDENT: f64 = 1e-6;

/// A factorisation.
#[derive(Clone, Debug, Default)]
pub(crate) enum Factor {
    /// Nothing is factored.
    #[default]
    None,
    /// Rows that do not slide.
    Symmetric(Cholesky),
    /// Rows of which some slide.
    General(Lu),
    /// Bodies.
    Bodies(BlockFactor),
}

impl Factor {
    /// Of the rows' own matrix, a band of this half-width.
    pub(crate) fn of_rows(equations: &Equations, width: usize, scratch: &mut Scratch) -> Self {
        Self::regularised(equations, width, PROXIMAL, scratch)
    }

    /// The same with as small an ε as will do.
    pub(crate) fn of_equalities(
        equations: &Equations,
        width: usize,
        scratch: &mut Scratch,
    ) -> Self {
        let first = Self::regularised(equations, width, LEAST, scratch);
        let Self::Symmetric(cholesky) = &first else { return first };
        if cholesky.count_below(DEPENDENT) == 0 {
            return first;
        }
        first.give(scratch);
        Self::of_rows(equations, width, scratch)
    }

    fn regularised(
        equations: &Equations,
        width: usize,
        epsilon: f64,
        scratch: &mut Scratch,
    ) -> Self {
        let (n, data) = (equations.rows.len(), scratch.floats.take());
        let symmetric = equations.folds.is_empty();
        let mut S = if symmetric {
            BandMatrix::lower_in(n, width, data)
        } else {
            BandMatrix::full_in(n, if equations.folds_are_foreign() { n } else { width }, data)
        };
        let mut assembly = Assembly::new(equations, symmetric, scratch);
        assembly.add_rows(&mut S);
        assembly.add_folds(&mut S);
        assembly.give(scratch);
        for slot in 0..n {
            S.add(slot, slot, epsilon);
        }
        if symmetric {
            let memory = (scratch.indices.take(), scratch.floats.take());
            Self::Symmetric(Cholesky::in_memory(S, 0.25 * epsilon, memory))
        } else {
            let memory = (scratch.indices.take(), scratch.indices.take());
            Self::General(Lu::in_memory(S, 1e-3 * epsilon, memory))
        }
    }

    /// Gives its memory back.
    pub(crate) fn give(self, scratch: &mut Scratch) {
        match self {
            Self::None => {}
            Self::Symmetric(cholesky) => {
                let (matrix, first, inverse) = cholesky.into_memory();
                scratch.floats.give(matrix);
                scratch.indices.give(first);
                scratch.floats.give(inverse);
            }
            Self::General(lu) => {
                let (matrix, exchanged, last) = lu.into_memory();
                scratch.floats.give(matrix);
                scratch.indices.give(exchanged);
                scratch.indices.give(last);
            }
            Self::Bodies(factor) => factor.give(scratch),
        }
    }

    /// x ← (Ŝ + ε I)⁻¹ x, or with the transpose.
    pub(crate) fn solve(
        &self,
        side: Side,
        equations: &Equations,
        x: &mut [f64],
        scratch: &mut Scratch,
    ) {
        match (self, side) {
            (Self::None, _) => {}
            (Self::Symmetric(cholesky), _) => cholesky.solve(x),
            (Self::General(lu), Side::Forward) => lu.solve(x),
            (Self::General(lu), Side::Transposed) => lu.solve_transpose(x),
            (Self::Bodies(factor), _) => factor.solve_rows(side, equations, x, scratch),
        }
    }

    /// How many of `rows` depend on the others.
    #[expect(clippy::cast_possible_truncation, reason = "row counts are u32")]
    pub(crate) fn rank_defect(&self, rows: usize) -> u32 {
        let small = |pivot: &f64| pivot.abs() < 16.0 * PROXIMAL;
        match self {
            Self::None => 0,
            Self::Symmetric(cholesky) => cholesky.count_below(16.0 * PROXIMAL) as u32,
            Self::General(lu) => lu.pivots().filter(small).count() as u32,
            Self::Bodies(factor) => (rows as u32).saturating_sub(factor.rank()),
        }
    }
}
