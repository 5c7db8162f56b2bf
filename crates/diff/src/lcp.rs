//! Derivatives of the mixed complementarity problem at a solution.
//!
//! With the modes fixed the solution obeys the reduced system of [`ActiveSystem`], w = (v, y),
//!
//! ```text
//!  F = ⎡ M v − p − Cᵀ y − J_sᵀ λ_s ⎤ = 0        K = ∂F/∂w = ⎡ M  −Cᵀ ⎤
//!      ⎣ B v + c y − b             ⎦                        ⎣ B   c  ⎦
//!
//!  forward    K dw = −F_θ dθ
//!  backward   Kᵀ a = w̄,   θ̄ = −F_θᵀ a,   a = (a_v, a_y)
//!
//!  p̄  = a_v               M̄  = −a_v ∘ v
//!  b̄ᵢ = a_y,i             c̄ᵢ = −a_y,i λᵢ            i active
//!  J̄ᵢ = λᵢ a_v − [i active] a_y,i v
//!  μ̄  = ± λ_n (J_t a_v + λ̄_t)                        sliding, + on Upper
//!  h̄  = ± (J_s a_v + λ̄_s)                            saturated motor
//! ```
//!
//! C is not B when a contact slides: K is not symmetric, and the backward solve is with its
//! transpose. Where a row is weakly active the derivative is one-sided; the one given belongs to the
//! solution's modes, which the polish chooses released (contacts without impulse open, friction on
//! its bound sliding), and the report names the row.
//!
//! At a point of the central path ([`CentralPoint`], of smoothed derivatives) the system is the same with
//! every row active and softer, v and λ are those of the point, and
//!
//! ```text
//!  μ̄ = a_y,t β λ_n        h̄ = a_y β        β = ∂u/∂h
//! ```

#![expect(non_snake_case, reason = "matrices carry their names from the paper")]

mod adjoint;
mod switches;

use std::sync::Arc;

use nalgebra::Vector3;
use tangency_lcp::{ActiveSystem, CentralPoint, Law, Lcp, LcpSolution, Metric, Row};
pub use tangency_lcp::{WeakKind, WeakRow};
use thiserror::Error;

pub use adjoint::LcpAdjoint;

/// Margins below this, in mass-weighted units relative to s*, are reported as weakly active.
pub const WEAK_MARGIN: f64 = 1e-7;

/// A tangent or a cotangent of an [`Lcp`], entry for entry.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LcpVector {
    /// Of the mass diagonals, per body.
    pub mass: Vec<Vector3<f64>>,
    /// Of the momenta p, per body.
    pub momentum: Vec<Vector3<f64>>,
    /// Of the rows.
    pub rows: Vec<RowVector>,
}

/// A tangent or a cotangent of one row.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RowVector {
    /// Of the Jacobian blocks; zero where there is no body.
    pub jacobian: [Vector3<f64>; 2],
    /// Of the right-hand side b.
    pub rhs: f64,
    /// Of the compliance c.
    pub compliance: f64,
    /// Of the friction coefficient, or of a motor's greatest impulse; zero for other laws.
    pub bound: f64,
}

/// What the user of a gradient should know about the point at which it was taken.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LcpGradientReport {
    /// Weakly active rows: the derivative is one-sided there.
    pub weak: Vec<WeakRow>,
    /// Dependent active rows: derivatives of velocities are unique, those of impulses are not (the
    /// smallest is given).
    pub rank_defect: u32,
    /// Whether the cotangent of the impulses asks for more than dependent rows determine: how they share
    /// what they do together. That part of it is dropped.
    pub undetermined: bool,
    /// What the linear system left over, relative to its right-hand side. Above rounding the
    /// right-hand side contradicts dependent rows, and the derivative is a least-squares one.
    pub defect: f64,
}

/// A derivative that cannot be taken.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum LcpDiffError {
    /// A list is not as long as the problem's.
    #[error("{what} has {found} entries, expected {expected}")]
    DimensionMismatch {
        /// The list.
        what: &'static str,
        /// Expected length.
        expected: usize,
        /// Length found.
        found: usize,
    },
    /// A smoothing that is no positive, finite number.
    #[error("kappa is {kappa}; give a positive, finite number, such as 1e-4")]
    Kappa {
        /// The number given.
        kappa: f64,
    },
    /// No point of the central path was found near the solution.
    #[error(
        "no smoothed point at kappa = {kappa} was found near the solution ({steps} steps of Newton's \
         method leave {residual:.1e}); give another kappa, or take exact derivatives"
    )]
    NoCentralPoint {
        /// The smoothing.
        kappa: f64,
        /// Steps of Newton's method.
        steps: u32,
        /// What its equations leave over, relative to s*.
        residual: f64,
    },
    /// The reduced system is singular beyond dependent rows, or its data are not finite.
    #[error("the reduced system of {rows} active rows has no finite solution")]
    Singular {
        /// Number of active rows.
        rows: usize,
    },
}

impl LcpVector {
    /// Zeros of the problem's shape.
    #[must_use]
    pub fn zeros(problem: &Lcp) -> Self {
        let bodies = vec![Vector3::zeros(); problem.mass.len()];
        let rows = vec![RowVector::default(); problem.rows.len()];
        Self { mass: bodies.clone(), momentum: bodies, rows }
    }

    /// Sum of the products of all entries.
    #[must_use]
    pub fn dot(&self, other: &Self) -> f64 {
        let bodies = |a: &[Vector3<f64>], b: &[Vector3<f64>]| -> f64 {
            a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
        };
        let rows: f64 = self.rows.iter().zip(&other.rows).map(|(a, b)| a.dot(b)).sum();
        bodies(&self.mass, &other.mass) + bodies(&self.momentum, &other.momentum) + rows
    }
}

impl RowVector {
    fn dot(&self, other: &Self) -> f64 {
        let blocks: f64 = self.jacobian.iter().zip(&other.jacobian).map(|(a, b)| a.dot(b)).sum();
        blocks
            + self.rhs * other.rhs
            + self.compliance * other.compliance
            + self.bound * other.bound
    }

    /// J v of the blocks over a row's bodies.
    fn velocity(&self, row: &Row, v: &[Vector3<f64>]) -> f64 {
        sides(row).map(|(side, body)| self.jacobian[side].dot(&v[body])).sum()
    }
}

/// (side, body) of the sides that have a body.
fn sides(row: &Row) -> impl Iterator<Item = (usize, usize)> {
    let known = |&(_, &body): &(usize, &u32)| body != tangency_lcp::NO_BODY;
    row.bodies.iter().enumerate().filter(known).map(|(side, &body)| (side, body as usize))
}

/// Pulls the cotangents of velocities and impulses back onto the problem.
///
/// # Errors
/// [`LcpDiffError`] for lists of a wrong length or a system without a finite solution.
pub fn lcp_vjp(
    problem: &Lcp,
    solution: &LcpSolution,
    velocity_bar: &[Vector3<f64>],
    impulse_bar: Option<&[f64]>,
) -> Result<(LcpVector, LcpGradientReport), LcpDiffError> {
    let mut adjoint = LcpAdjoint::default();
    adjoint.solve(problem, solution, velocity_bar, impulse_bar)?;
    let bar = adjoint.spread(problem, solution);
    Ok((bar, adjoint.report(problem, solution)))
}

/// Pushes a tangent of the problem forward: changes of the velocities, and of the impulses per row.
///
/// # Errors
/// As [`lcp_vjp`].
pub fn lcp_jvp(
    problem: &Lcp,
    solution: &LcpSolution,
    tangent: &LcpVector,
) -> Result<(Vec<Vector3<f64>>, Vec<f64>), LcpDiffError> {
    check_solution(problem, solution)?;
    check("tangent.mass", problem.mass.len(), tangent.mass.len())?;
    check("tangent.momentum", problem.mass.len(), tangent.momentum.len())?;
    check("tangent.rows", problem.rows.len(), tangent.rows.len())?;
    let own;
    let (problem, system) = if let Some(central) = &solution.central {
        (central.soft(), central.system())
    } else {
        own = system(problem, solution);
        (problem, &*own)
    };
    let at = solution.linearised();
    let (v, lambda) = (&at.velocities, &at.impulses);

    let mut momentum = tangent.momentum.clone();
    for ((p, dM), v) in momentum.iter_mut().zip(&tangent.mass).zip(v) {
        *p -= dM.component_mul(v);
    }
    for ((row, change), lambda) in problem.rows.iter().zip(&tangent.rows).zip(lambda) {
        for (side, body) in sides(row) {
            momentum[body] += *lambda * change.jacobian[side];
        }
    }
    let bounds = match solution.central {
        Some(_) => Vec::new(),
        None => bound_changes(system, solution, tangent),
    };
    for &(row, change) in &bounds {
        problem.rows[row as usize].add_transposed(change, &mut momentum);
    }
    let right = |&index: &u32| {
        let (row, change) = (&problem.rows[index as usize], &tangent.rows[index as usize]);
        change.rhs - change.velocity(row, v) - change.compliance * lambda[index as usize]
    };
    let mut rhs: Vec<f64> = system.rows().iter().map(right).collect();
    if let Some(central) = &solution.central {
        for (row, rhs) in system.rows().iter().zip(&mut rhs) {
            *rhs += slack_change(central, problem, *row, tangent);
        }
    }
    let reduced = system.solve_with(problem, &momentum, &rhs);
    check_finite(system, reduced.defect)?;

    let mut d_impulses = vec![0.0; problem.rows.len()];
    for (&row, dy) in system.rows().iter().zip(&reduced.impulses) {
        d_impulses[row as usize] = *dy;
    }
    for fold in system.folds() {
        d_impulses[fold.row as usize] += fold.coefficient * reduced.impulses[fold.column as usize];
    }
    for (row, change) in bounds {
        d_impulses[row as usize] += change;
    }
    Ok((reduced.velocities, d_impulses))
}

/// Changes of the impulses on a bound by the bound alone: `±dμ λ_n`, `±dh`.
fn bound_changes(
    system: &ActiveSystem,
    solution: &LcpSolution,
    tangent: &LcpVector,
) -> Vec<(u32, f64)> {
    let sliding = system.folds().iter().map(|fold| {
        let normal = system.rows()[fold.column as usize] as usize;
        let d_mu = tangent.rows[fold.row as usize].bound;
        (fold.row, fold.coefficient.signum() * d_mu * solution.impulses[normal])
    });
    let saturated = system
        .saturated()
        .iter()
        .map(|&(row, impulse)| (row, impulse.signum() * tangent.rows[row as usize].bound));
    sliding.chain(saturated).collect()
}

/// Change of what a softened law leaves over by its bound alone: β dh.
fn slack_change(central: &CentralPoint, problem: &Lcp, row: u32, tangent: &LcpVector) -> f64 {
    let row = row as usize;
    let d_bound = tangent.rows[row].bound;
    match problem.rows[row].law {
        Law::Friction { normal, .. } => {
            central.by_bound(row) * central.solution.impulses[normal as usize] * d_bound
        }
        Law::Bounded { .. } => central.by_bound(row) * d_bound,
        Law::Equality | Law::Unilateral => 0.0,
    }
}

/// The factored system of the solution's modes: the solver's, if it left it.
fn system(problem: &Lcp, solution: &LcpSolution) -> Arc<ActiveSystem> {
    solution.system.clone().unwrap_or_else(|| {
        Arc::new(ActiveSystem::new(problem, &Metric::new(problem), &solution.modes))
    })
}

fn check_finite(system: &ActiveSystem, defect: f64) -> Result<(), LcpDiffError> {
    let rows = system.rows().len();
    if defect.is_finite() { Ok(()) } else { Err(LcpDiffError::Singular { rows }) }
}

fn check_solution(problem: &Lcp, solution: &LcpSolution) -> Result<(), LcpDiffError> {
    check("solution.velocities", problem.mass.len(), solution.velocities.len())?;
    check("solution.impulses", problem.rows.len(), solution.impulses.len())?;
    check("solution.slacks", problem.rows.len(), solution.slacks.len())?;
    check("solution.modes", problem.rows.len(), solution.modes.len())
}

fn check(what: &'static str, expected: usize, found: usize) -> Result<(), LcpDiffError> {
    if expected == found {
        Ok(())
    } else {
        Err(LcpDiffError::DimensionMismatch { what, expected, found })
    }
}

#[cfg(test)]
mod tests;
