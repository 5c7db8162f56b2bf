//! Products with the rows' sparse Jacobian J (m × 3n), block by block.

#![expect(non_snake_case, reason = "matrices carry their names from the paper")]

use nalgebra::{DMatrix, DVector, Vector3};

use crate::{Law, Lcp, NO_BODY, Row};

impl Row {
    /// The blocks that belong to a body: (body index, 1 × 3 block).
    pub fn blocks(&self) -> impl Iterator<Item = (usize, &Vector3<f64>)> {
        self.bodies
            .iter()
            .zip(&self.jacobian)
            .filter(|&(&body, _)| body != NO_BODY)
            .map(|(&body, block)| (body as usize, block))
    }

    /// J v of this row, m/s or rad/s.
    #[must_use]
    pub fn velocity(&self, velocities: &[Vector3<f64>]) -> f64 {
        self.blocks().map(|(body, block)| block.dot(&velocities[body])).sum()
    }

    /// Adds `impulse` Jᵀ to a momentum per body.
    pub fn add_transposed(&self, impulse: f64, momentum: &mut [Vector3<f64>]) {
        for (body, block) in self.blocks() {
            momentum[body] += impulse * block;
        }
    }
}

impl Lcp {
    /// Velocities without the rows' impulses, M⁻¹ p.
    #[must_use]
    pub fn free_velocities(&self) -> Vec<Vector3<f64>> {
        self.momentum.iter().zip(&self.mass).map(|(p, m)| p.component_div(m)).collect()
    }

    /// J v of row `row`, m/s or rad/s.
    #[must_use]
    pub fn row_velocity(&self, row: usize, velocities: &[Vector3<f64>]) -> f64 {
        self.rows[row].velocity(velocities)
    }

    /// Adds Jᵀ λ to a momentum per body.
    pub fn apply_rows_transposed(&self, impulses: &[f64], momentum: &mut [Vector3<f64>]) {
        for (row, &impulse) in self.rows.iter().zip(impulses) {
            row.add_transposed(impulse, momentum);
        }
    }

    /// Remainders u = J v + c λ − b per row, m/s or rad/s.
    #[must_use]
    pub fn remainders(&self, velocities: &[Vector3<f64>], impulses: &[f64]) -> Vec<f64> {
        let remainder = |(row, &impulse): (&Row, &f64)| {
            row.velocity(velocities) + row.compliance * impulse - row.rhs
        };
        self.rows.iter().zip(impulses).map(remainder).collect()
    }

    /// Velocities v = M⁻¹ (p + Jᵀ λ) for given impulses.
    #[must_use]
    pub fn velocities(&self, impulses: &[f64]) -> Vec<Vector3<f64>> {
        let mut momentum = self.momentum.clone();
        self.apply_rows_transposed(impulses, &mut momentum);
        momentum.iter().zip(&self.mass).map(|(p, m)| p.component_div(m)).collect()
    }

    /// Wᵢᵢ = Jᵢ M⁻¹ Jᵢᵀ + cᵢ, velocity per impulse; 1 for a row without influence.
    #[must_use]
    pub fn row_weight(&self, row: usize) -> f64 {
        let weight = self.rigid_weight(row) + self.rows[row].compliance;
        if weight > 0.0 { weight } else { 1.0 }
    }

    /// Jᵢ M⁻¹ Jᵢᵀ, velocity per impulse.
    fn rigid_weight(&self, row: usize) -> f64 {
        let blocks = self.rows[row].blocks();
        blocks.map(|(body, J)| J.component_div(&self.mass[body]).dot(J)).sum()
    }

    /// Lets rows give way: cᵢ ← cᵢ + `softness`(i) Jᵢ M⁻¹ Jᵢᵀ. Rows of a softness above zero cannot
    /// contradict any others.
    pub fn soften(&mut self, softness: impl Fn(usize) -> f64) {
        for i in 0..self.rows.len() {
            self.rows[i].compliance += softness(i) * self.rigid_weight(i);
        }
    }

    /// The problem with these rows only, which must be ascending and name each friction row's normal
    /// row, too.
    ///
    /// # Panics
    /// If a friction row is kept without its normal row.
    #[must_use]
    pub fn select(&self, kept: &[usize]) -> Self {
        let place = |row: usize| kept.binary_search(&row).expect("the normal row is kept, too");
        let pick = |row: &usize| {
            let mut row = self.rows[*row].clone();
            if let Law::Friction { normal, .. } = &mut row.law {
                let place = place(*normal as usize);
                *normal = u32::try_from(place).expect("fewer rows than u32 counts");
            }
            row
        };
        let rows = kept.iter().map(pick).collect();
        Self { rows, mass: self.mass.clone(), momentum: self.momentum.clone() }
    }

    /// Dense Delassus form u = W λ + q: W = J M⁻¹ Jᵀ + diag(c), m × m; q = J M⁻¹ p − b, m.
    #[must_use]
    pub fn delassus(&self) -> (DMatrix<f64>, DVector<f64>) {
        let n = self.rows.len();
        let mut W = DMatrix::zeros(n, n);
        let touching = self.rows_of_bodies();
        for (i, row) in self.rows.iter().enumerate() {
            W[(i, i)] += row.compliance;
            for (body, J) in row.blocks() {
                let weighted = J.component_div(&self.mass[body]);
                for &(j, side) in touching.of(body) {
                    W[(i, j as usize)] +=
                        weighted.dot(&self.rows[j as usize].jacobian[side as usize]);
                }
            }
        }
        let free = self.free_velocities();
        let q = self.rows.iter().map(|row| row.velocity(&free) - row.rhs);
        (W, DVector::from_iterator(n, q))
    }

    fn rows_of_bodies(&self) -> Touching {
        Touching::new(self, 0..self.rows.len())
    }
}

/// Which rows touch a body, as one list cut into slices.
pub(crate) struct Touching {
    start: Vec<u32>,
    entries: Vec<(u32, u32)>,
}

impl Touching {
    /// From the rows listed; an entry is (position in that list, side).
    #[expect(clippy::cast_possible_truncation, reason = "row and body indices are u32")]
    pub(crate) fn new(problem: &Lcp, rows: impl Iterator<Item = usize> + Clone) -> Self {
        let mut start = vec![0_u32; problem.mass.len() + 1];
        for row in rows.clone() {
            for (body, _) in problem.rows[row].blocks() {
                start[body + 1] += 1;
            }
        }
        for body in 0..problem.mass.len() {
            start[body + 1] += start[body];
        }
        let mut next = start.clone();
        let mut entries = vec![(0, 0); start[problem.mass.len()] as usize];
        for (position, row) in rows.enumerate() {
            for (side, &body) in problem.rows[row].bodies.iter().enumerate() {
                if body != NO_BODY {
                    let slot = &mut next[body as usize];
                    entries[*slot as usize] = (position as u32, side as u32);
                    *slot += 1;
                }
            }
        }
        Self { start, entries }
    }

    /// Entries of one body, in list order.
    pub(crate) fn of(&self, body: usize) -> &[(u32, u32)] {
        &self.entries[self.start[body] as usize..self.start[body + 1] as usize]
    }
}
