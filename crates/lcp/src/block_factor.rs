//! Bodies first: the matrix that remains when the rows are eliminated.
//!
//! ```text
//!  (Ŝ + ε) y = r  with  Ŝ = B̂ μM⁻¹ Ĉᵀ + ĉ       (Woodbury 1950)
//!
//!  w = 1/(ε + ĉ)       K = M/μ + Ĉᵀ w B̂       K x = Ĉᵀ w r       y = w (r − B̂ x)
//! ```
//!
//! K has a 3 × 3 block per body and per pair of bodies that share rows, however many rows those are, and
//! dependent rows do it no harm. It is factored as L D U by blocks in the order of a [`Pattern`], without
//! exchanges: it is positive definite unless contacts slide, and where a sliding contact spoils it the
//! refinement notices.

#![expect(non_snake_case, reason = "matrices carry their names from the notes")]

use std::sync::Arc;

use nalgebra::Vector3;

use crate::Scratch;
use crate::block::{
    Block, add_outer, divide, invert_pivots, solve_pivot, subtract, subtract_times,
    subtract_transposed, transpose,
};
use crate::equations::{Equations, Side};
use crate::factor::PROXIMAL;
use crate::metric::WeightedRow;
use crate::pattern::{NO_BLOCK, Pattern};

/// A pivot below this times M/μ belongs to a direction in which no row acts.
const FREE: f64 = 3e4;
/// Without sliding no pivot is below M/μ; one below this part of it is not to be trusted.
const SOUND: f64 = 1e-3;

/// Refinement mends a defect below this part of the right-hand side in a few sweeps.
const MENDED: f64 = 1e-6;

/// The parts of a row on its two bodies.
type Sides = [Vector3<f64>; 2];

/// K = L D U. L and U have unit diagonals; below and right of it their blocks are stored scaled.
#[derive(Clone, Debug)]
pub(crate) struct BlockFactor {
    pattern: Arc<Pattern>,
    /// Per body in the order of elimination: its block's own L D U, pivots inverted.
    diagonal: Vec<Block>,
    /// Blocks of L below the diagonal, columns after each other.
    lower: Vec<Block>,
    /// Blocks of U right of the diagonal, rows after each other, transposed; empty if U = Lᵀ.
    upper: Vec<Block>,
    /// Directions in which no row acts.
    free: u32,
}

impl BlockFactor {
    /// Assembles K and factors it; `None` if friction slides on other bodies than its normal row, or
    /// spoils the pivots.
    pub(crate) fn new(
        pattern: &Arc<Pattern>,
        equations: &Equations,
        scratch: &mut Scratch,
    ) -> Option<Self> {
        if equations.folds_are_foreign() {
            return None;
        }
        let mut factor = Self::zeros(pattern, !equations.folds.is_empty(), scratch);
        factor.add_masses(&equations.mass);
        factor.add_rows(equations);
        factor.add_folds(equations);
        factor.factor(scratch);
        if factor.count_free(&equations.mass) || factor.proves_itself(equations, scratch) {
            return Some(factor);
        }
        factor.give(scratch);
        None
    }

    /// Whether a solution with pivots that cannot be trusted is one all the same, up to what refinement
    /// mends: tried on remainders that some impulses make, so that dependent rows agree.
    fn proves_itself(&self, equations: &Equations, scratch: &mut Scratch) -> bool {
        let (mut y, mut r) = (scratch.floats.take(), scratch.floats.take());
        let wave = |slot: usize| if slot.is_multiple_of(3) { -1.0 } else { 1.0 };
        y.extend((0..equations.rows.len()).map(wave));
        equations.products(&y, &mut r, scratch);
        y.copy_from_slice(&r);
        self.solve_rows(Side::Forward, equations, &mut y, scratch);
        let mut product = scratch.floats.take();
        equations.products(&y, &mut product, scratch);
        let size = r.iter().fold(0.0_f64, |size, r| size.max(r.abs()));
        let proven = product.iter().zip(&r).all(|(p, r)| (p - r).abs() <= MENDED * size);
        for floats in [y, r, product] {
            scratch.floats.give(floats);
        }
        proven
    }

    /// K = 0; symmetric unless `coupled`.
    pub(crate) fn zeros(pattern: &Arc<Pattern>, coupled: bool, scratch: &mut Scratch) -> Self {
        let (bodies, blocks) = (pattern.bodies(), pattern.blocks());
        let memory = &mut scratch.blocks;
        Self {
            pattern: Arc::clone(pattern),
            diagonal: memory.filled(bodies, [0.0; 9]),
            lower: memory.filled(blocks, [0.0; 9]),
            upper: memory.filled(if coupled { blocks } else { 0 }, [0.0; 9]),
            free: 0,
        }
    }

    /// K ← 0, to be filled again.
    pub(crate) fn clear(&mut self) {
        for blocks in [&mut self.diagonal, &mut self.lower, &mut self.upper] {
            blocks.fill([0.0; 9]);
        }
        self.free = 0;
    }

    /// Gives its memory back.
    pub(crate) fn give(self, scratch: &mut Scratch) {
        scratch.blocks.give(self.diagonal);
        scratch.blocks.give(self.lower);
        scratch.blocks.give(self.upper);
    }

    /// Number of directions in which rows act.
    #[expect(clippy::cast_possible_truncation, reason = "bodies are counted by u32")]
    pub(crate) fn rank(&self) -> u32 {
        3 * self.pattern.bodies() as u32 - self.free
    }

    /// r ← w (r − B̂ K⁻¹ Ĉᵀ w r), or with B̂ and Ĉ exchanged.
    pub(crate) fn solve_rows(
        &self,
        side: Side,
        equations: &Equations,
        r: &mut [f64],
        scratch: &mut Scratch,
    ) {
        let mut x = scratch.vectors.filled(self.pattern.bodies() + 1, Vector3::zeros());
        let (mut ordered, mut along) = (scratch.vectors.take(), scratch.floats.take());
        along.extend(r.iter().zip(&equations.rows).map(|(r, row)| weight(row) * r));
        equations.add_transposed(side, &along, &mut x);
        self.solve(side == Side::Transposed, &mut x[..self.pattern.bodies()], &mut ordered);
        equations.velocities(side, &x, &mut along);
        for ((r, along), row) in r.iter_mut().zip(&along).zip(&equations.rows) {
            *r = weight(row) * (*r - along);
        }
        scratch.vectors.give(x);
        scratch.vectors.give(ordered);
        scratch.floats.give(along);
    }

    /// K ← K + M/μ, for a K without rows.
    pub(crate) fn add_masses(&mut self, mass: &[Vector3<f64>]) {
        for (mass, position) in mass.iter().zip(&self.pattern.position) {
            let block = &mut self.diagonal[*position as usize];
            (block[0], block[4], block[8]) = (mass.x, mass.y, mass.z);
        }
    }

    fn add_rows(&mut self, equations: &Equations) {
        for (row, run) in equations.rows.iter().zip(&equations.runs) {
            let left = row.jacobian.map(|J| J * weight(row));
            let block = self.pattern.block[*run as usize];
            self.add_product(row.bodies, block, &left, &row.jacobian);
        }
    }

    /// Ĉᵀ w B̂ of sliding friction: on the left its own row, on the right its normal row.
    fn add_folds(&mut self, equations: &Equations) {
        for fold in &equations.folds {
            let slot = fold.column as usize;
            let row = &equations.rows[slot];
            let left = fold.jacobian.map(|J| J * weight(row));
            let block = self.pattern.block[equations.runs[slot] as usize];
            self.add_product(row.bodies, block, &left, &row.jacobian);
        }
    }

    /// K ← K + leftᵀ right over the two bodies of a row and the block that they share.
    pub(crate) fn add_product(
        &mut self,
        bodies: [u32; 2],
        block: u32,
        left: &Sides,
        right: &Sides,
    ) {
        let pattern = &self.pattern;
        for side in 0..2 {
            if let Some(position) = pattern.position.get(bodies[side] as usize) {
                add_outer(&mut self.diagonal[*position as usize], &left[side], &right[side]);
            }
        }
        if block == NO_BLOCK {
            return;
        }
        let [a, b] = bodies.map(|body| pattern.position[body as usize]);
        let (early, late) = if a < b { (0, 1) } else { (1, 0) };
        add_outer(&mut self.lower[block as usize], &left[late], &right[early]);
        if let Some(upper) = self.upper.get_mut(block as usize) {
            add_outer(upper, &right[late], &left[early]); // transposed
        }
    }

    /// Right-looking elimination: A_ba ← A_ba − L_b A_ja for all later neighbours a, b of j.
    pub(crate) fn factor(&mut self, scratch: &mut Scratch) {
        let mut column = scratch.blocks.take();
        let pattern = &self.pattern;
        let mut targets = pattern.target.iter();
        for j in 0..pattern.bodies() {
            let pivot = invert_pivots(self.diagonal[j]);
            self.diagonal[j] = pivot;
            let range = pattern.column(j);
            // Aᵀ_ja, before the blocks are scaled.
            let right = if self.upper.is_empty() { &self.lower } else { &self.upper };
            column.clear();
            column.extend_from_slice(&right[range.clone()]);
            for block in &mut self.lower[range.clone()] {
                divide(block, &pivot);
            }
            for (a, right_a) in column.iter().enumerate() {
                let left_a = self.lower[range.start + a];
                let diagonal = *targets.next().expect("one per pair") as usize;
                subtract(&mut self.diagonal[diagonal], &left_a, right_a);
                for (b, right_b) in column.iter().enumerate().skip(a + 1) {
                    let target = *targets.next().expect("one per pair") as usize;
                    let left_b = self.lower[range.start + b];
                    subtract(&mut self.lower[target], &left_b, right_a);
                    if let Some(upper) = self.upper.get_mut(target) {
                        subtract(upper, right_b, &left_a);
                    }
                }
            }
            if !self.upper.is_empty() {
                let transposed = transpose(&pivot);
                self.upper[range].iter_mut().for_each(|block| divide(block, &transposed));
            }
        }
        scratch.blocks.give(column);
    }

    /// Counts pivots without rows; whether all can be trusted.
    pub(crate) fn count_free(&mut self, mass: &[Vector3<f64>]) -> bool {
        let mut sound = true;
        for (mass, position) in mass.iter().zip(&self.pattern.position) {
            let pivot = &self.diagonal[*position as usize];
            for k in 0..3 {
                let inverse = pivot[4 * k] * mass[k];
                self.free += u32::from(inverse * FREE > 1.0);
                sound &= inverse > 0.0 && inverse * SOUND < 1.0;
            }
        }
        sound
    }

    /// x ← K⁻¹ x, or K⁻ᵀ x; `ordered` is working memory.
    pub(crate) fn solve(
        &self,
        transposed: bool,
        x: &mut [Vector3<f64>],
        ordered: &mut Vec<Vector3<f64>>,
    ) {
        let upper = if self.upper.is_empty() { &self.lower } else { &self.upper };
        let (lower, upper) = if transposed { (upper, &self.lower) } else { (&self.lower, upper) };
        let pattern = &self.pattern;
        ordered.clear();
        ordered.resize(pattern.bodies(), Vector3::zeros());
        for (x, position) in x.iter().zip(&pattern.position) {
            ordered[*position as usize] = *x;
        }
        for j in 0..pattern.bodies() {
            let value = ordered[j];
            for block in pattern.column(j) {
                subtract_times(&mut ordered[pattern.row[block] as usize], &lower[block], &value);
            }
            let pivot = &self.diagonal[j];
            ordered[j] = if transposed {
                solve_pivot(&transpose(pivot), value)
            } else {
                solve_pivot(pivot, value)
            };
        }
        for j in (0..pattern.bodies()).rev() {
            let mut value = ordered[j];
            for block in pattern.column(j) {
                subtract_transposed(
                    &mut value,
                    &upper[block],
                    &ordered[pattern.row[block] as usize],
                );
            }
            ordered[j] = value;
        }
        for (x, position) in x.iter_mut().zip(&pattern.position) {
            *x = ordered[*position as usize];
        }
    }
}

/// w = 1/(ε + ĉ).
pub(crate) fn weight(row: &WeightedRow) -> f64 {
    (PROXIMAL + row.compliance).recip()
}
