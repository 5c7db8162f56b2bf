//! Nearly dependent rows: the reduced system as one dense saddle matrix and its pseudo-inverse.
//!
//! S squares the rows' condition: two pins 10⁻⁸ of a rod's length apart are one pin to it. In
//!
//! ```text
//!  ⎡ α I   −Ĉᵀ ⎤ ⎡ v̂   ⎤   ⎡ α p̂ ⎤        v̂ = √M v,  Ĉ = R C /√M,  B̂ = R B /√M,  R = diag(1/√Wᵢᵢ)
//!  ⎣ B̂    ĉ/α  ⎦ ⎣ α ŷ ⎦ = ⎣ b̂   ⎦
//! ```
//!
//! with α ≪ 1 they are two. Costs O((3n + m)³): the second attempt, for small problems.

#![expect(non_snake_case, reason = "matrices carry their names from the notes")]

use nalgebra::{DMatrix, DVector, Vector3};

use crate::equations::{Equations, Side};
use crate::refinement::relative;
use crate::{Reduced, pseudo_inverse};

const ALPHA: f64 = 1e-7;
/// Singular values below this count as zero.
const DEPENDENT: f64 = 1e-12;
/// Above this many unknowns there is no second attempt.
const MOST_UNKNOWNS: usize = 200;
const SWEEPS: usize = 3;

/// Whether the system of so many bodies and rows is small enough.
pub(crate) fn takes(bodies: usize, rows: usize) -> bool {
    3 * bodies + rows <= MOST_UNKNOWNS
}

/// Solves for (v, ŷ) from (p/μ, b̂) in a few sweeps; `None` if the system is too large or the
/// decomposition fails.
pub(crate) fn solve(
    equations: &Equations,
    side: Side,
    momentum: &[Vector3<f64>],
    rhs: &[f64],
) -> Option<Reduced> {
    let saddle = Saddle::new(equations)?;
    let (bodies, slots) = (momentum.len(), rhs.len());
    let roots: Vec<Vector3<f64>> = equations.mass.iter().map(|mass| mass.map(f64::sqrt)).collect();
    let mut v = vec![Vector3::zeros(); bodies + 1];
    let mut y = vec![0.0; slots];
    let mut r = vec![0.0; slots];
    for _ in 0..SWEEPS {
        let mut balance = momentum.to_vec();
        balance.push(Vector3::zeros());
        equations.add_impulses(side, &y, &mut balance);
        equations.remainder(side, rhs, &v, &y, &mut r);
        let mut right = DVector::zeros(3 * bodies + slots);
        for body in 0..bodies {
            let defect = balance[body] - equations.mass[body].component_mul(&v[body]);
            right.fixed_rows_mut::<3>(3 * body).copy_from(&defect.component_div(&roots[body]));
        }
        right.rows_mut(3 * bodies, slots).copy_from_slice(&r);
        let step = match side {
            Side::Forward => saddle.solve(&right),
            Side::Transposed => saddle.solve_transpose(&right),
        };
        for body in 0..bodies {
            v[body] += step.fixed_rows::<3>(3 * body).component_div(&roots[body]);
        }
        y.iter_mut().zip(step.rows(3 * bodies, slots).iter()).for_each(|(y, dy)| *y += dy);
    }
    let defect = equations.remainder(side, rhs, &v, &y, &mut r);
    v.truncate(bodies);
    let defect = relative(defect, equations.scale(momentum, rhs));
    Some(Reduced { velocities: v, impulses: y, defect })
}

/// Pseudo-inverse in mass-weighted unknowns (v̂, ŷ).
struct Saddle {
    inverse: DMatrix<f64>,
    unknowns: usize,
}

impl Saddle {
    fn new(equations: &Equations) -> Option<Self> {
        let (n, m) = (3 * equations.mass.len(), equations.rows.len());
        if !takes(equations.mass.len(), m) {
            return None;
        }
        let mut K = DMatrix::zeros(n + m, n + m);
        K.view_mut((0, 0), (n, n)).fill_diagonal(ALPHA);
        let mut add = |bodies: [u32; 2], jacobian: [Vector3<f64>; 2], slot: usize, in_B: bool| {
            for (body, J) in bodies.into_iter().zip(jacobian) {
                let Some(mass) = equations.mass.get(body as usize) else { continue };
                for k in 0..3 {
                    let (unknown, scaled) = (3 * body as usize + k, J[k] / mass[k].sqrt());
                    K[(unknown, n + slot)] -= scaled;
                    if in_B {
                        K[(n + slot, unknown)] += scaled;
                    }
                }
            }
        };
        for (slot, row) in equations.rows.iter().enumerate() {
            add(row.bodies, row.jacobian, slot, true);
        }
        for fold in &equations.folds {
            add(fold.bodies, fold.jacobian, fold.column as usize, false);
        }
        for (slot, row) in equations.rows.iter().enumerate() {
            K[(n + slot, n + slot)] += row.compliance / ALPHA;
        }
        Some(Self { inverse: pseudo_inverse(&K, DEPENDENT)?, unknowns: n })
    }

    /// (v̂, ŷ) from (p̂, b̂).
    fn solve(&self, right: &DVector<f64>) -> DVector<f64> {
        let mut right = right.clone();
        right.rows_mut(0, self.unknowns).scale_mut(ALPHA);
        self.unscale_impulses(&self.inverse * right)
    }

    /// (v̂, ŷ) of the transposed system, M v + Bᵀ y = p, −C v + c y = b.
    ///
    /// ```text
    ///  K = L K₀ D with L = diag(α, 1), D = diag(1, 1/α):   K₀⁻ᵀ = L K⁻ᵀ D
    /// ```
    fn solve_transpose(&self, right: &DVector<f64>) -> DVector<f64> {
        let scaled = {
            let mut right = right.clone();
            let impulses = right.len() - self.unknowns;
            right.rows_mut(self.unknowns, impulses).scale_mut(1.0 / ALPHA);
            right
        };
        let mut found = self.inverse.tr_mul(&scaled);
        found.rows_mut(0, self.unknowns).scale_mut(ALPHA);
        found
    }

    fn unscale_impulses(&self, mut found: DVector<f64>) -> DVector<f64> {
        let impulses = found.len() - self.unknowns;
        found.rows_mut(self.unknowns, impulses).scale_mut(1.0 / ALPHA);
        found
    }
}
