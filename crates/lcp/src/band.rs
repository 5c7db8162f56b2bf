//! Square band matrices and their LU factorisation with partial pivoting.
//!
//! Rows of a planar contact problem couple only where they share a body. In a good order (chains and
//! stacks come in one) their matrices are narrow bands; a full matrix is the band of width n. One
//! storage serves both: entry (i, j) lies at `i · stride + offset + j`.

use crate::narrow;

/// A square matrix, row by row, of which only a band is stored.
#[derive(Clone, Debug)]
pub struct BandMatrix {
    n: usize,
    lower: usize,
    stride: usize,
    offset: usize,
    pub(crate) data: Vec<f64>,
}

impl BandMatrix {
    /// n × n zeros with `lower` subdiagonals and as many superdiagonals, and room for the fill of
    /// row exchanges.
    #[must_use]
    pub fn zeros(n: usize, lower: usize) -> Self {
        Self::full_in(n, lower, Vec::new())
    }

    /// n × n zeros of which only the lower triangle is stored, for [`Cholesky`](crate::Cholesky).
    #[must_use]
    pub fn zeros_lower(n: usize, lower: usize) -> Self {
        Self::lower_in(n, lower, Vec::new())
    }

    /// [`zeros`](Self::zeros) in memory that is used again.
    pub(crate) fn full_in(n: usize, lower: usize, memory: Vec<f64>) -> Self {
        Self::with_width(n, lower, 3 * lower + 1, memory)
    }

    /// [`zeros_lower`](Self::zeros_lower) in memory that is used again.
    pub(crate) fn lower_in(n: usize, lower: usize, mut memory: Vec<f64>) -> Self {
        match narrow::rounded(lower) {
            Some(lower) => {
                memory.clear();
                memory.resize(n * (lower + 1), 0.0);
                Self::narrow(n, lower, memory)
            }
            None => Self::with_width(n, lower, lower + 1, memory),
        }
    }

    /// Rows of a narrow band after each other.
    pub(crate) fn narrow(n: usize, lower: usize, data: Vec<f64>) -> Self {
        Self { n, lower, stride: lower, offset: lower, data }
    }

    fn with_width(n: usize, lower: usize, width: usize, mut data: Vec<f64>) -> Self {
        let (stride, offset, len) =
            if width >= n { (n, 0, n * n) } else { (width - 1, lower, n * width) };
        let lower = lower.min(n.saturating_sub(1));
        data.clear();
        data.resize(len, 0.0);
        Self { n, lower, stride, offset, data }
    }

    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.n
    }

    /// Whether there are no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.n == 0
    }

    /// Number of subdiagonals.
    #[must_use]
    pub fn lower(&self) -> usize {
        self.lower
    }

    /// Entries per row where the lower triangle is stored row after row; 0 where it is not.
    pub(crate) fn narrow_width(&self) -> usize {
        if self.offset == self.lower && self.stride == self.lower { self.lower + 1 } else { 0 }
    }

    pub(crate) fn at(&self, i: usize, j: usize) -> usize {
        i * self.stride + self.offset + j
    }

    /// Entry (i, j); it must lie in the band.
    #[must_use]
    pub fn get(&self, i: usize, j: usize) -> f64 {
        self.data[self.at(i, j)]
    }

    /// Adds to entry (i, j); it must lie in the band.
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        let at = self.at(i, j);
        self.data[at] += value;
    }

    /// Row i from column `from` up to and without column `to`.
    #[must_use]
    pub fn row(&self, i: usize, from: usize, to: usize) -> &[f64] {
        let base = self.at(i, 0);
        &self.data[base + from..base + to]
    }

    fn row_mut(&mut self, i: usize, from: usize, to: usize) -> &mut [f64] {
        let base = self.at(i, 0);
        &mut self.data[base + from..base + to]
    }

    /// The columns of the band in row i.
    #[must_use]
    pub fn columns(&self, i: usize) -> std::ops::Range<usize> {
        i.saturating_sub(self.lower)..(i + self.lower + 1).min(self.n)
    }

    /// y = A x.
    #[must_use]
    pub fn times(&self, x: &[f64]) -> Vec<f64> {
        (0..self.n)
            .map(|i| {
                let columns = self.columns(i);
                dot(self.row(i, columns.start, columns.end), &x[columns])
            })
            .collect()
    }

    /// Multiplies entry (i, j) by `scale[i] · scale[j]`.
    pub fn scale(&mut self, scale: &[f64]) {
        for i in 0..self.n {
            let columns = self.columns(i);
            let row = self.row_mut(i, columns.start, columns.end);
            for (entry, column) in row.iter_mut().zip(&scale[columns]) {
                *entry *= scale[i] * column;
            }
        }
    }
}

/// Sum of products, of long rows in four strands that the processor can run side by side.
#[inline]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    if a.len() < 8 {
        return a.iter().zip(b).fold(0.0, |sum, (x, y)| sum + x * y);
    }
    long_dot(a, b)
}

fn long_dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
    let tail: f64 = a4.remainder().iter().zip(b4.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in a4.zip(b4) {
        for k in 0..4 {
            sums[k] += x[k] * y[k];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + tail
}

/// target −= factor · source.
pub(crate) fn subtract(target: &mut [f64], factor: f64, source: &[f64]) {
    for (t, s) in target.iter_mut().zip(source) {
        *t -= factor * s;
    }
}

/// P A = L U with partial pivoting inside the band.
#[derive(Clone, Debug)]
pub struct Lu {
    matrix: BandMatrix,
    exchanged: Vec<u32>,
    last: Vec<u32>,
}

impl Lu {
    /// Factors; pivots smaller than `floor` are replaced by it, with their sign.
    #[must_use]
    pub fn new(matrix: BandMatrix, floor: f64) -> Self {
        Self::in_memory(matrix, floor, (Vec::new(), Vec::new()))
    }

    /// The same in memory that is used again.
    #[expect(clippy::cast_possible_truncation, reason = "row indices are u32")]
    pub(crate) fn in_memory(
        mut matrix: BandMatrix,
        floor: f64,
        (mut exchanged, mut last): (Vec<u32>, Vec<u32>),
    ) -> Self {
        let n = matrix.n;
        last.extend((0..n).map(|i| matrix.columns(i).end as u32));
        exchanged.resize(n, 0);
        for k in 0..n {
            let below = (k + matrix.lower + 1).min(n);
            let pivot = pivot_row(&matrix, k, below);
            // A row without entries may have moved down past its own end.
            last[k] = last[k].max(k as u32 + 1);
            last[pivot] = last[pivot].max(k as u32 + 1);
            exchanged[k] = pivot as u32;
            if pivot != k {
                let end = last[k].max(last[pivot]) as usize;
                swap_rows(&mut matrix, k, pivot, k, end);
                last.swap(k, pivot);
            }
            let diagonal = matrix.at(k, k);
            if matrix.data[diagonal].abs() < floor {
                matrix.data[diagonal] = floor.copysign(matrix.data[diagonal]);
            }
            eliminate(&mut matrix, k, below, &mut last);
        }
        Self { matrix, exchanged, last }
    }

    /// Its memory.
    pub(crate) fn into_memory(self) -> (Vec<f64>, Vec<u32>, Vec<u32>) {
        (self.matrix.data, self.exchanged, self.last)
    }

    /// Pivots in order of elimination.
    pub fn pivots(&self) -> impl Iterator<Item = f64> {
        (0..self.matrix.n).map(|k| self.matrix.get(k, k))
    }

    /// x ← A⁻¹ x.
    pub fn solve(&self, x: &mut [f64]) {
        let n = self.matrix.n;
        for k in 0..n {
            x.swap(k, self.exchanged[k] as usize);
            let value = x[k];
            if value != 0.0 {
                let below = (k + self.matrix.lower + 1).min(n);
                for (i, entry) in x.iter_mut().enumerate().take(below).skip(k + 1) {
                    *entry -= self.matrix.get(i, k) * value;
                }
            }
        }
        for k in (0..n).rev() {
            let end = self.last[k] as usize;
            let sum = dot(self.matrix.row(k, k + 1, end), &x[k + 1..end]);
            x[k] = (x[k] - sum) / self.matrix.get(k, k);
        }
    }

    /// x ← A⁻ᵀ x.
    pub fn solve_transpose(&self, x: &mut [f64]) {
        let n = self.matrix.n;
        for k in 0..n {
            let end = self.last[k] as usize;
            x[k] /= self.matrix.get(k, k);
            let value = x[k];
            subtract(&mut x[k + 1..end], value, self.matrix.row(k, k + 1, end));
        }
        for k in (0..n).rev() {
            let below = k + 1..(k + self.matrix.lower + 1).min(n);
            let sum: f64 = below.map(|i| self.matrix.get(i, k) * x[i]).sum();
            x[k] -= sum;
            x.swap(k, self.exchanged[k] as usize);
        }
    }
}

fn pivot_row(matrix: &BandMatrix, k: usize, below: usize) -> usize {
    let mut best = k;
    for i in k + 1..below {
        if matrix.get(i, k).abs() > matrix.get(best, k).abs() {
            best = i;
        }
    }
    best
}

fn swap_rows(matrix: &mut BandMatrix, i: usize, j: usize, from: usize, to: usize) {
    let (a, b) = (matrix.at(i, from), matrix.at(j, from));
    for k in 0..to - from {
        matrix.data.swap(a + k, b + k);
    }
}

fn eliminate(matrix: &mut BandMatrix, k: usize, below: usize, last: &mut [u32]) {
    let end = last[k] as usize;
    let pivot = matrix.get(k, k);
    for i in k + 1..below {
        let at = matrix.at(i, k);
        if matrix.data[at] == 0.0 {
            continue;
        }
        let factor = matrix.data[at] / pivot;
        matrix.data[at] = factor;
        let source = matrix.at(k, k + 1);
        let (head, tail) = matrix.data.split_at_mut(at + 1);
        subtract(&mut tail[..end - k - 1], factor, &head[source..source + end - k - 1]);
        last[i] = last[i].max(last[k]);
    }
}
