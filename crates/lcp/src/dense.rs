//! The dense matrices of de Avila Belbute-Peres et al. 2018, equations 2 and 3.
//!
//! ```text
//!  M x + Gᵀ z + Aᵀ y = −q            x = −v        q = p = M v⁻ + dt f
//!  G x + s − F z     = m             z = (λc, λf, γ) ≥ 0,   s = (a, σ, ζ) ≥ 0,   zᵀ s = 0
//!  A x               = d             y = λe
//!
//!      ⎡ Jc ⎤        ⎡ 0   0   0 ⎤        ⎡ −bc ⎤
//!  G = ⎢ Jf ⎥    F = ⎢ 0   0   E ⎥    m = ⎢ −bf ⎥    A = Je    d = −be
//!      ⎣ 0  ⎦        ⎣ μ  −Eᵀ  0 ⎦        ⎣  0  ⎦
//! ```
//!
//! The signs: with x = −v the momentum row is −(M v − Jeᵀ λe − Gᵀ z − p) = 0, and the second row is
//! s = G v + F z + m. Each frictional contact has two rows in Jf, +J_t first, then −J_t, so that
//! λt = λf⁺ − λf⁻; E (2k × k) has two ones per column. Rows of Jc come in the order of the
//! unilateral rows, with or without friction; μ (k × unilateral rows) picks the contact's normal.

#![expect(non_snake_case, reason = "matrices carry their names from the paper")]

use nalgebra::{DMatrix, DVector, Vector3};

use crate::{Law, Lcp, LcpError, LcpSolution, Mode, Row, SolveStats};

/// The paper's problem data. n bodies, e equalities, c unilateral rows, k frictional contacts.
#[derive(Clone, Debug, PartialEq)]
pub struct PaperForm {
    /// Mass matrix, 3n × 3n.
    pub M: DMatrix<f64>,
    /// Equality Jacobian Je, e × 3n.
    pub A: DMatrix<f64>,
    /// Inequality Jacobian [Jc; Jf; 0], (c + 3k) × 3n.
    pub G: DMatrix<f64>,
    /// Coupling of friction, (c + 3k) × (c + 3k).
    pub F: DMatrix<f64>,
    /// Momentum p, 3n.
    pub q: DVector<f64>,
    /// Right side of the inequalities (−bc, −bf, 0), c + 3k.
    pub m: DVector<f64>,
    /// Right side of the equalities −be, e.
    pub d: DVector<f64>,
    rows: RowsByKind,
}

/// The paper's unknowns.
#[derive(Clone, Debug, PartialEq)]
pub struct PaperSolution {
    /// −v, 3n.
    pub x: DVector<f64>,
    /// λe, e.
    pub y: DVector<f64>,
    /// (λc, λf, γ), c + 3k.
    pub z: DVector<f64>,
    /// (a, σ, ζ), c + 3k.
    pub s: DVector<f64>,
}

#[derive(Clone, Debug, Default, PartialEq)]
struct RowsByKind {
    equality: Vec<usize>,
    unilateral: Vec<usize>,
    friction: Vec<usize>,
}

impl Lcp {
    /// The paper's dense matrices.
    ///
    /// # Errors
    /// [`LcpError::NotInPaperForm`] for bounded rows and for compliance, which the paper lacks.
    pub fn to_dense(&self) -> Result<PaperForm, LcpError> {
        let rows = RowsByKind::of(self)?;
        let n = 3 * self.mass.len();
        let (c, k) = (rows.unilateral.len(), rows.friction.len());
        let mut form = PaperForm {
            M: DMatrix::from_diagonal(&flatten(&self.mass)),
            A: DMatrix::zeros(rows.equality.len(), n),
            G: DMatrix::zeros(c + 3 * k, n),
            F: DMatrix::zeros(c + 3 * k, c + 3 * k),
            q: flatten(&self.momentum),
            m: DVector::zeros(c + 3 * k),
            d: DVector::zeros(rows.equality.len()),
            rows,
        };
        form.fill(self);
        Ok(form)
    }
}

impl RowsByKind {
    fn of(problem: &Lcp) -> Result<Self, LcpError> {
        let mut kinds = Self::default();
        for (index, row) in problem.rows.iter().enumerate() {
            if row.compliance != 0.0 {
                return Err(LcpError::NotInPaperForm { row: index, what: "compliance" });
            }
            match row.law {
                Law::Equality => kinds.equality.push(index),
                Law::Unilateral => kinds.unilateral.push(index),
                Law::Friction { .. } => kinds.friction.push(index),
                Law::Bounded { .. } => {
                    return Err(LcpError::NotInPaperForm { row: index, what: "constant bound" });
                }
            }
        }
        Ok(kinds)
    }
}

impl PaperForm {
    fn fill(&mut self, problem: &Lcp) {
        let (c, k) = (self.rows.unilateral.len(), self.rows.friction.len());
        for (i, &row) in self.rows.equality.iter().enumerate() {
            put(&mut self.A, i, 1.0, &problem.rows[row]);
            self.d[i] = -problem.rows[row].rhs;
        }
        for (i, &row) in self.rows.unilateral.iter().enumerate() {
            put(&mut self.G, i, 1.0, &problem.rows[row]);
            self.m[i] = -problem.rows[row].rhs;
        }
        for (i, &index) in self.rows.friction.iter().enumerate() {
            let row = &problem.rows[index];
            let Law::Friction { normal, mu } = row.law else { continue };
            let normal = self.rows.position_of_normal(normal as usize);
            let (gamma, plus) = (c + 2 * k + i, c + 2 * i);
            for (tangent, sign) in [(plus, 1.0), (plus + 1, -1.0)] {
                put(&mut self.G, tangent, sign, row);
                self.m[tangent] = -sign * row.rhs;
                self.F[(tangent, gamma)] = 1.0;
                self.F[(gamma, tangent)] = -1.0;
            }
            self.F[(gamma, normal)] = mu;
        }
    }

    /// Residual of the paper's system for a candidate: the greatest entry of the three equations,
    /// of the negative parts of z and s, and of the products z s.
    #[must_use]
    pub fn residual(&self, at: &PaperSolution) -> f64 {
        let momentum = &self.M * &at.x + self.G.tr_mul(&at.z) + self.A.tr_mul(&at.y) + &self.q;
        let inequalities = &self.G * &at.x + &at.s - &self.F * &at.z - &self.m;
        let equalities = &self.A * &at.x - &self.d;
        let signs = at.z.iter().chain(at.s.iter()).map(|value| (-value).max(0.0));
        let products = at.z.iter().zip(at.s.iter()).map(|(z, s)| (z * s).abs());
        let equations = momentum.iter().chain(&inequalities).chain(&equalities).map(|r| r.abs());
        equations.chain(signs).chain(products).fold(0.0, f64::max)
    }

    /// Converts a solution: λf± are the parts of λt, γ = |u_t|.
    #[must_use]
    pub fn from_mixed(&self, solution: &LcpSolution) -> PaperSolution {
        let (c, k) = (self.rows.unilateral.len(), self.rows.friction.len());
        let mut z = DVector::zeros(c + 3 * k);
        for (i, &row) in self.rows.unilateral.iter().enumerate() {
            z[i] = solution.impulses[row];
        }
        for (i, &row) in self.rows.friction.iter().enumerate() {
            z[c + 2 * i] = solution.impulses[row].max(0.0);
            z[c + 2 * i + 1] = (-solution.impulses[row]).max(0.0);
            z[c + 2 * k + i] = solution.slacks[row].abs();
        }
        let equality = self.rows.equality.iter().map(|&row| solution.impulses[row]);
        let y = DVector::from_iterator(self.rows.equality.len(), equality);
        let x = -flatten(&solution.velocities);
        let s = &self.m + &self.F * &z - &self.G * &x;
        PaperSolution { x, y, z, s }
    }

    /// Converts back; modes are read from which of two complementary numbers is greater.
    #[must_use]
    pub fn to_mixed(&self, problem: &Lcp, at: &PaperSolution) -> LcpSolution {
        let (c, k) = (self.rows.unilateral.len(), self.rows.friction.len());
        let mut impulses = vec![0.0; problem.rows.len()];
        let mut modes = vec![Mode::Active; problem.rows.len()];
        for (i, &row) in self.rows.equality.iter().enumerate() {
            impulses[row] = at.y[i];
        }
        for (i, &row) in self.rows.unilateral.iter().enumerate() {
            impulses[row] = at.z[i];
            modes[row] = if at.z[i] > at.s[i] { Mode::Active } else { Mode::Open };
        }
        for (i, &row) in self.rows.friction.iter().enumerate() {
            impulses[row] = at.z[c + 2 * i] - at.z[c + 2 * i + 1];
            let Law::Friction { normal, .. } = problem.rows[row].law else { continue };
            let slides = at.z[c + 2 * k + i] > at.s[c + 2 * k + i];
            modes[row] = match modes[normal as usize] {
                Mode::Open => Mode::Open,
                _ if !slides => Mode::Active,
                _ if impulses[row] > 0.0 => Mode::Upper,
                _ => Mode::Lower,
            };
        }
        let velocities: Vec<Vector3<f64>> =
            at.x.as_slice().chunks_exact(3).map(|x| -Vector3::new(x[0], x[1], x[2])).collect();
        let slacks = problem.remainders(&velocities, &impulses);
        LcpSolution {
            velocities,
            impulses,
            slacks,
            modes,
            stats: SolveStats::default(),
            system: None,
            central: None,
        }
    }
}

impl RowsByKind {
    fn position_of_normal(&self, normal: usize) -> usize {
        self.unilateral.binary_search(&normal).expect("friction's normal row is unilateral")
    }
}

fn flatten(blocks: &[Vector3<f64>]) -> DVector<f64> {
    DVector::from_iterator(3 * blocks.len(), blocks.iter().flat_map(|block| block.iter().copied()))
}

fn put(matrix: &mut DMatrix<f64>, at: usize, sign: f64, row: &Row) {
    for (body, block) in row.blocks() {
        for k in 0..3 {
            matrix[(at, 3 * body + k)] += sign * block[k];
        }
    }
}
