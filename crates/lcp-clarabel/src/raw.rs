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
            Verdict::Infeasible => Err(infeasible(problem)),
            Verdict::Failed if unbounded(&conic) => Err(infeasible(problem)),
            Verdict::Failed => Err(stopped(&conic)),
        }
    }

    fn solve_friction(&self, problem: &RawFriction) -> Result<RawSolution, LcpError> {
        problem.validate()?;
        let raw = problem.to_raw();
        if raw.q.is_empty() {
            return Ok(RawSolution::empty());
        }
        let weighted = problem.weighted();
        let program = cone_program(&weighted)?;
        let form = raw.box_form();
        let mut polish = RawPolish::new(&raw, &form, self.tolerance, self.max_flips);
        let mut conic = self.convex(&program)?;
        let (mut s, mut anderson, mut iterations) =
            (vec![0.0; problem.mu.len()], Anderson::default(), 0);
        for _ in 0..self.max_programs {
            conic.update_q(&shifted(&weighted, &s)).map_err(|e| refused(&e))?;
            conic.solve();
            iterations += conic.solution.iterations;
            if verdict(conic.solution.status) != Verdict::Judge {
                break;
            }
            let r = DVector::from_column_slice(&conic.solution.x);
            let z = weighted.unknowns(&r);
            let y: Vec<f64> = z.iter().zip(&form.unscale).map(|(z, unscale)| z / unscale).collect();
            if polish.offer(&y) {
                break;
            }
            s = anderson.next(&s, &sliding(&weighted, &r));
        }
        problem.judged("clarabel", polish.finish(iterations, 0)?)
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

/// That no z ≥ 0 has w ≥ 0, with the residual of z = 0: what was found is a direction, not a point.
fn infeasible(problem: &RawLcp) -> LcpError {
    let residual = problem.residual(&DVector::zeros(problem.q.len()));
    LcpError::Infeasible { residual }
}

fn unbounded(conic: &DefaultSolver<f64>) -> bool {
    use clarabel::solver::SolverStatus::{AlmostDualInfeasible, DualInfeasible};
    matches!(conic.solution.status, DualInfeasible | AlmostDualInfeasible)
}

/// min ½ rᵀW r + qᵀr over the cones |r_t| ≤ μ rₙ, for the part of W that is symmetric: whoever wrote
/// it may have rounded.
fn cone_program(weighted: &RawFriction) -> Result<Convex, LcpError> {
    let n = weighted.q.len();
    let W = 0.5 * (&weighted.matrix + weighted.matrix.transpose());
    monotone(&W)?;
    let mut A = DMatrix::zeros(n, n);
    let mut cones = Vec::new();
    for (contact, &mu) in weighted.mu.iter().enumerate() {
        let (normal, tangent) = (2 * contact, 2 * contact + 1);
        if mu > 0.0 {
            for (row, sign) in [(normal, 1.0), (tangent, -1.0)] {
                A[(row, normal)] = -mu;
                A[(row, tangent)] = sign;
            }
            cones.push(SupportedConeT::NonnegativeConeT(2));
        } else {
            // Without friction the cone is a ray.
            (A[(normal, normal)], A[(tangent, tangent)]) = (-1.0, 1.0);
            cones.extend([SupportedConeT::NonnegativeConeT(1), SupportedConeT::ZeroConeT(1)]);
        }
    }
    Ok(Convex { P: W, q: weighted.q.as_slice().to_vec(), A, b: vec![0.0; n], cones })
}

/// q + s eₙ.
fn shifted(weighted: &RawFriction, s: &[f64]) -> Vec<f64> {
    let mut q = weighted.q.as_slice().to_vec();
    s.iter().enumerate().for_each(|(contact, s)| q[2 * contact] += s);
    q
}

/// μ|uₜ| per contact.
fn sliding(weighted: &RawFriction, r: &DVector<f64>) -> Vec<f64> {
    let u = &weighted.matrix * r + &weighted.q;
    weighted.mu.iter().enumerate().map(|(contact, mu)| mu * u[2 * contact + 1].abs()).collect()
}
