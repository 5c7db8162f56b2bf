//! Cholesky's factorisation of narrow bands: chains, and stacks of a few contacts.
//!
//! A row is an array of `W` entries, the diagonal last: entry `k` of row `i` is column `i + k − (W − 1)`.
//! What lies left of the matrix is zero. With the width known to the compiler, the loops over a row have no
//! counters.

/// Factors in place. `inverse` receives 1/L per row; squared pivots below `floor` are replaced by it.
pub(crate) fn factor<const W: usize>(data: &mut [f64], inverse: &mut [f64], floor: f64) {
    let (rows, _) = data.as_chunks_mut::<W>();
    for i in 0..rows.len() {
        let mut row = rows[i];
        let mut square = row[W - 1];
        for k in (W - 1).saturating_sub(i)..W - 1 {
            let j = i + k + 1 - W;
            let (above, shift) = (&rows[j], W - 1 - k);
            let sum: f64 = (0..k).map(|m| row[m] * above[m + shift]).sum();
            row[k] = (row[k] - sum) * inverse[j];
            square -= row[k] * row[k];
        }
        inverse[i] = square.max(floor).sqrt().recip();
        rows[i] = row;
    }
}

/// x ← (L Lᵀ)⁻¹ x.
pub(crate) fn solve<const W: usize>(data: &[f64], inverse: &[f64], x: &mut [f64]) {
    let (rows, _) = data.as_chunks::<W>();
    for (i, row) in rows.iter().enumerate() {
        let mut value = x[i];
        if i >= W - 1 {
            let before = &x[i + 1 - W..i];
            for k in 0..W - 1 {
                value -= row[k] * before[k];
            }
        } else {
            (0..i).for_each(|j| value -= row[j + W - 1 - i] * x[j]);
        }
        x[i] = value * inverse[i];
    }
    for (i, row) in rows.iter().enumerate().rev() {
        let value = x[i] * inverse[i];
        x[i] = value;
        if i >= W - 1 {
            let before = &mut x[i + 1 - W..i];
            for k in 0..W - 1 {
                before[k] -= row[k] * value;
            }
        } else {
            (0..i).for_each(|j| x[j] -= row[j + W - 1 - i] * value);
        }
    }
}
