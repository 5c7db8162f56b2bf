//! Raw problems through Clarabel: monotone ones as one convex program, planar friction by the fixed
//! point on s.
//!
//! ```text
//!  M = Mᵀ ⪰ 0       min ½ zᵀM z + qᵀz          z_P ≥ 0
//!  M + Mᵀ ⪰ 0       min zᵀ(M z + q)            z_P ≥ 0,  (M z + q)_P ≥ 0,  (M z + q)_F = 0
//!  friction         min ½ rᵀW r + (q + s eₙ)ᵀr     |r_t| ≤ μ rₙ;     s ← μ|u_t|
//! ```
//!
//! Other matrices are refused: a convex solver would answer *solved* with something that is not a
//! solution.

#![expect(non_snake_case, reason = "matrices carry their names from the literature")]

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSolver, IPSolver, SupportedConeT};
use nalgebra::{DMatrix, DVector};
use tangency_lcp::{LcpError, RawFriction, RawLcp, RawPolish, RawSolution, RawSolver};

use crate::anderson::Anderson;
use crate::fixed_point::{Clarabel, refused, stopped};
use crate::status::{Verdict, verdict};

/// Eigenvalues above minus this, relative to the largest, count as non-negative.
const INDEFINITE: f64 = 1e-9;
/// Entries that differ by less than this, relative to the largest, are symmetric.
const ASYMMETRY: f64 = 1e-13;

impl RawSolver for Clarabel {
    fn name(&self) -> &'static str {
        "clarabel"
    }

    fn solve_raw(&self, problem: &RawLcp) -> Result<RawSolution, LcpError> {
        problem.validate()?;
        if problem.q.is_empty() {
            return Ok(RawSolution::empty());
        }
        let form = problem.box_form();
        let n = form.len();
        let M = DMatrix::from_fn(n, n, |i, j| form.entry(i, j));
        let q = DVector::from_column_slice(&form.q);
        monotone(&M)?;
        let mut polish = RawPolish::new(problem, &form, self.tolerance, self.max_flips);
        let mut conic = self.convex(&program(&M, &q, problem.free))?;
        conic.solve();
        let iterations = conic.solution.iterations;
        match verdict(conic.solution.status) {
            Verdict::Judge => {
                polish.offer(&conic.solution.x);
                polish.finish(iterations, 0)
            }
            // A monotone problem that some z ≥ 0 with w ≥ 0 satisfies has a solution.
            Verdict::Infeasible => Err(LcpError::Infeasible { residual: conic.solution.r_prim }),
            Verdict::Failed if unbounded(&conic) => {
                Err(LcpError::Infeasible { residual: conic.solution.r_dual })
            }
            Verdict::Failed => Err(stopped(&conic)),
        }
    }

    fn solve_friction(&self, problem: &RawFriction) -> Result<RawSolution, LcpError> {
        problem.validate()?;
        let raw = problem.to_raw();
        if raw.q.is_empty() {
            return Ok(RawSolution::empty());
        }
        let local = Local::new(problem)?;
        let form = raw.box_form();
        let mut polish = RawPolish::new(&raw, &form, self.tolerance, self.max_flips);
        let mut conic = self.convex(&local.program())?;
        let (mut s, mut anderson, mut iterations) =
            (vec![0.0; problem.mu.len()], Anderson::default(), 0);
        for _ in 0..self.max_programs {
            conic.update_q(&local.shifted(&s)).map_err(|e| refused(&e))?;
            conic.solve();
            iterations += conic.solution.iterations;
            if verdict(conic.solution.status) != Verdict::Judge {
                break;
            }
            let r = local.reactions(&conic.solution.x);
            let z = problem.unknowns(&r);
            let y: Vec<f64> = z.iter().zip(&form.unscale).map(|(z, unscale)| z / unscale).collect();
            if polish.offer(&y) {
                break;
            }
            s = anderson.next(&s, &local.sliding(&r));
        }
        polish.finish(iterations, 0)
    }
}

/// Data of one program: min ½ xᵀPx + qᵀx, A x + s = b, s ∈ K.
pub(crate) struct Convex {
    P: DMatrix<f64>,
    q: Vec<f64>,
    A: DMatrix<f64>,
    b: Vec<f64>,
    cones: Vec<SupportedConeT<f64>>,
}

impl Clarabel {
    fn convex(&self, program: &Convex) -> Result<DefaultSolver<f64>, LcpError> {
        let Convex { P, q, A, b, cones } = program;
        let upper = |i: usize, j: usize| i <= j;
        let (P, A) = (sparse(P, upper), sparse(A, |_, _| true));
        DefaultSolver::new(&P, q, &A, b, cones, self.conic_settings()).map_err(|e| refused(&e))
    }
}

fn sparse(dense: &DMatrix<f64>, keep: impl Fn(usize, usize) -> bool) -> CscMatrix<f64> {
    let (mut rows, mut columns, mut values) = (Vec::new(), Vec::new(), Vec::new());
    for j in 0..dense.ncols() {
        for i in (0..dense.nrows()).filter(|&i| keep(i, j) && dense[(i, j)] != 0.0) {
            rows.push(i);
            columns.push(j);
            values.push(dense[(i, j)]);
        }
    }
    CscMatrix::new_from_triplets(dense.nrows(), dense.ncols(), rows, columns, values)
}

/// Refuses M unless M + Mᵀ is positive semidefinite.
fn monotone(M: &DMatrix<f64>) -> Result<(), LcpError> {
    let eigenvalues = (0.5 * (M + M.transpose())).symmetric_eigenvalues();
    let least = eigenvalues.min();
    if least >= -INDEFINITE * M.amax() {
        return Ok(());
    }
    Err(LcpError::OutsideClass {
        solver: "clarabel",
        class: "monotone (M + Mᵀ positive semidefinite)",
        measure: "least eigenvalue of (M + Mᵀ)/2, scaled",
        value: least,
    })
}

fn program(M: &DMatrix<f64>, q: &DVector<f64>, free: usize) -> Convex {
    let n = q.len();
    let signs = DMatrix::from_fn(n - free, n, |i, j| if j == i + free { -1.0 } else { 0.0 });
    if (M - M.transpose()).amax() <= ASYMMETRY * M.amax() {
        let cones = vec![SupportedConeT::NonnegativeConeT(n - free)];
        let (P, q, b) = (M.clone(), q.as_slice().to_vec(), vec![0.0; n - free]);
        return Convex { P, q, A: signs, b, cones };
    }
    let mut A = DMatrix::zeros(2 * n - free, n);
    A.rows_mut(0, n).copy_from(&-M);
    A.rows_mut(n, n - free).copy_from(&signs);
    let mut b = q.as_slice().to_vec();
    b.resize(2 * n - free, 0.0);
    let cones =
        vec![SupportedConeT::ZeroConeT(free), SupportedConeT::NonnegativeConeT(2 * (n - free))];
    Convex { P: M + M.transpose(), q: q.as_slice().to_vec(), A, b, cones }
}

fn unbounded(conic: &DefaultSolver<f64>) -> bool {
    use clarabel::solver::SolverStatus::{AlmostDualInfeasible, DualInfeasible};
    matches!(conic.solution.status, DualInfeasible | AlmostDualInfeasible)
}

/// A friction problem in the units of the residual: y = r √Wᵢᵢ / s*, u = u / (√Wᵢᵢ s*).
struct Local<'a> {
    problem: &'a RawFriction,
    root: Vec<f64>,
    scale: f64,
    W: DMatrix<f64>,
    q: Vec<f64>,
}

impl<'a> Local<'a> {
    fn new(problem: &'a RawFriction) -> Result<Self, LcpError> {
        let n = problem.q.len();
        let positive = |w: f64| if w > 0.0 { w.sqrt() } else { 1.0 };
        let root: Vec<f64> = problem.matrix.diagonal().iter().map(|&w| positive(w)).collect();
        let scale = (0..n).fold(0.0_f64, |scale, i| scale.max((problem.q[i] / root[i]).abs()));
        let scale = if scale > 0.0 { scale } else { 1.0 };
        // Symmetric up to the rounding of whoever wrote it.
        let half = |i: usize, j: usize| 0.5 * (problem.matrix[(i, j)] + problem.matrix[(j, i)]);
        let W = DMatrix::from_fn(n, n, |i, j| half(i, j) / (root[i] * root[j]));
        monotone(&W)?;
        let q = (0..n).map(|i| problem.q[i] / (root[i] * scale)).collect();
        Ok(Self { problem, root, scale, W, q })
    }

    /// μ̂ = μ √(W_tt/W_nn).
    fn mu(&self, contact: usize) -> f64 {
        self.problem.mu[contact] * self.root[2 * contact + 1] / self.root[2 * contact]
    }

    fn program(&self) -> Convex {
        let n = self.q.len();
        let mut A = DMatrix::zeros(n, n);
        for contact in 0..n / 2 {
            let (normal, tangent) = (2 * contact, 2 * contact + 1);
            for (row, sign) in [(normal, 1.0), (tangent, -1.0)] {
                A[(row, normal)] = -self.mu(contact);
                A[(row, tangent)] = sign;
                // Without friction the cone is a ray.
                if self.problem.mu[contact] == 0.0 {
                    A[(row, normal)] = if row == normal { -1.0 } else { 0.0 };
                    A[(row, tangent)] = if row == normal { 0.0 } else { 1.0 };
                }
            }
        }
        let frictionless = |c: usize| self.problem.mu[c] == 0.0;
        let cones = (0..n / 2)
            .flat_map(|c| {
                let second = if frictionless(c) {
                    SupportedConeT::ZeroConeT(1)
                } else {
                    SupportedConeT::NonnegativeConeT(1)
                };
                [SupportedConeT::NonnegativeConeT(1), second]
            })
            .collect();
        Convex { P: self.W.clone(), q: self.q.clone(), A, b: vec![0.0; n], cones }
    }

    fn shifted(&self, s: &[f64]) -> Vec<f64> {
        let mut q = self.q.clone();
        s.iter().enumerate().for_each(|(contact, s)| q[2 * contact] += s);
        q
    }

    fn reactions(&self, y: &[f64]) -> DVector<f64> {
        DVector::from_fn(y.len(), |i, _| y[i] * self.scale / self.root[i])
    }

    /// μ̂|ûₜ| per contact.
    fn sliding(&self, r: &DVector<f64>) -> Vec<f64> {
        let u = &self.problem.matrix * r + &self.problem.q;
        let slip = |contact: usize| {
            let tangent = 2 * contact + 1;
            self.mu(contact) * (u[tangent] / (self.root[tangent] * self.scale)).abs()
        };
        (0..self.problem.mu.len()).map(slip).collect()
    }
}
