//! L D Lᵀ of narrow bands: chains, and stacks of a few contacts.
//!
//! A row is an array of `W` entries, the diagonal last: entry `k` of row `i` is column `i + k − (W − 1)`.
//! What lies left of the matrix is zero. With the width known to the compiler, the loops over a row have no
//! counters, and what the neighbouring rows need stays in registers.

/// The next half-width that is one of a narrow band.
pub(crate) fn rounded(lower: usize) -> Option<usize> {
    [1, 2, 3, 5, 7].into_iter().find(|known| lower <= *known)
}

/// Factors in place. `inverse` receives 1/D per row; pivots below `floor` are replaced by it.
pub(crate) fn factor<const W: usize>(data: &mut [f64], inverse: &mut [f64], floor: f64) {
    let (rows, _) = data.as_chunks_mut::<W>();
    for i in 0..rows.len() {
        let (above, rest) = rows.split_at_mut(i);
        let row = &mut rest[0];
        let pivot = if i >= W - 1 {
            eliminate(&above[i + 1 - W..], &inverse[i + 1 - W..i], 0, row)
        } else {
            eliminate(above, &inverse[..i], W - 1 - i, row)
        };
        inverse[i] = pivot.max(floor).recip();
    }
}

/// Turns a row into one of L, given the rows above it; returns its pivot. Its first `empty` entries lie
/// left of the matrix.
///
/// ```text
///  cₖ = aᵢₖ − Σ_{m<k} c_m l_km        lᵢₖ = cₖ/dₖ        dᵢ = aᵢᵢ − Σ cₖ lᵢₖ
/// ```
#[inline]
fn eliminate<const W: usize>(
    above: &[[f64; W]],
    inverse: &[f64],
    empty: usize,
    row: &mut [f64; W],
) -> f64 {
    let mut pivot = row[W - 1];
    let mut c = [0.0; W];
    for k in empty..W - 1 {
        let (other, shift) = (&above[k - empty], W - 1 - k);
        let mut value = row[k];
        for m in 0..k {
            value -= c[m] * other[m + shift];
        }
        c[k] = value;
        row[k] = value * inverse[k - empty];
        pivot -= value * row[k];
    }
    pivot
}

/// x ← (L D Lᵀ)⁻¹ x.
pub(crate) fn solve<const W: usize>(data: &[f64], inverse: &[f64], x: &mut [f64]) {
    let (rows, _) = data.as_chunks::<W>();
    // The last W entries of x, so far.
    let mut before = [0.0; W];
    for (row, x) in rows.iter().zip(x.iter_mut()) {
        let mut value = *x;
        for k in 0..W - 1 {
            value -= row[k] * before[k + 1];
        }
        before.rotate_left(1);
        before[W - 1] = value;
        *x = value;
    }
    // What the entries below take from the W entries up to this one.
    let mut taken = [0.0; W];
    for ((row, inverse), x) in rows.iter().zip(inverse).zip(x.iter_mut()).rev() {
        let value = *x * inverse - taken[W - 1];
        *x = value;
        for k in (0..W - 1).rev() {
            taken[k + 1] = taken[k] + row[k] * value;
        }
        taken[0] = 0.0;
    }
}
