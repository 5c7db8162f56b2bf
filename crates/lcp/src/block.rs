//! 3 × 3 blocks: what elimination by bodies does with them.

#![expect(non_snake_case, reason = "matrices carry their names from the notes")]

use nalgebra::Vector3;

/// A 3 × 3 block, row by row.
pub(crate) type Block = [f64; 9];

/// A ← A + x yᵀ.
pub(crate) fn add_outer(A: &mut Block, x: &Vector3<f64>, y: &Vector3<f64>) {
    for i in 0..3 {
        for k in 0..3 {
            A[3 * i + k] += x[i] * y[k];
        }
    }
}

/// A ← A − X Yᵀ.
#[inline]
pub(crate) fn subtract(A: &mut Block, X: &Block, Y: &Block) {
    for i in 0..3 {
        for k in 0..3 {
            A[3 * i + k] -=
                X[3 * i] * Y[3 * k] + X[3 * i + 1] * Y[3 * k + 1] + X[3 * i + 2] * Y[3 * k + 2];
        }
    }
}

/// L D U of a block, with unit triangles, and the pivots inverted.
pub(crate) fn invert_pivots(mut A: Block) -> Block {
    for k in 0..3 {
        let inverse = A[4 * k].recip();
        for i in k + 1..3 {
            let factor = A[3 * i + k] * inverse;
            for m in k + 1..3 {
                A[3 * i + m] -= factor * A[3 * k + m];
            }
            A[3 * i + k] = factor;
        }
        for m in k + 1..3 {
            A[3 * k + m] *= inverse;
        }
        A[4 * k] = inverse;
    }
    A
}

pub(crate) fn transpose(A: &Block) -> Block {
    [A[0], A[3], A[6], A[1], A[4], A[7], A[2], A[5], A[8]]
}

/// X ← X P⁻¹, P = L D U: row by row.
pub(crate) fn divide(X: &mut Block, P: &Block) {
    for row in X.chunks_exact_mut(3) {
        row[1] -= row[0] * P[1];
        row[2] -= row[0] * P[2] + row[1] * P[5];
        for k in 0..3 {
            row[k] *= P[4 * k];
        }
        row[1] -= row[2] * P[7];
        row[0] -= row[1] * P[3] + row[2] * P[6];
    }
}

/// P⁻¹ x, P = L D U.
pub(crate) fn solve_pivot(P: &Block, mut x: Vector3<f64>) -> Vector3<f64> {
    x[1] -= P[3] * x[0];
    x[2] -= P[6] * x[0] + P[7] * x[1];
    for k in 0..3 {
        x[k] *= P[4 * k];
    }
    x[1] -= P[5] * x[2];
    x[0] -= P[1] * x[1] + P[2] * x[2];
    x
}

/// y ← y − A x.
pub(crate) fn subtract_times(y: &mut Vector3<f64>, A: &Block, x: &Vector3<f64>) {
    for i in 0..3 {
        y[i] -= A[3 * i] * x[0] + A[3 * i + 1] * x[1] + A[3 * i + 2] * x[2];
    }
}

/// y ← y − Aᵀ x.
pub(crate) fn subtract_transposed(y: &mut Vector3<f64>, A: &Block, x: &Vector3<f64>) {
    for i in 0..3 {
        y[i] -= A[i] * x[0] + A[3 + i] * x[1] + A[6 + i] * x[2];
    }
}
