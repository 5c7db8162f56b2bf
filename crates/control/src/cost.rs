//! What a motion costs, and how that changes with states and controls.

use nalgebra::{DMatrix, DVector};

use crate::PlanError;

/// The cost of a motion, a sum over its steps and its end.
///
/// Hessians need not be exact: any symmetric matrix makes a descent direction as long as the one by
/// the control is positive definite together with what comes through the dynamics. Where it is not, the
/// planner adds to its diagonal.
pub trait Cost {
    /// l(k, x, u), of taking control u (m numbers) in state x (n numbers) at step k.
    fn running(&self, k: usize, x: &DVector<f64>, u: &DVector<f64>) -> f64;

    /// Its first and second derivatives.
    fn running_expansion(&self, k: usize, x: &DVector<f64>, u: &DVector<f64>) -> Expansion;

    /// `l_T(x)`, of ending in state x.
    fn last(&self, x: &DVector<f64>) -> f64;

    /// Its first and second derivatives.
    fn last_expansion(&self, x: &DVector<f64>) -> LastExpansion;

    /// Refuses a cost that does not fit states of n and controls of m numbers.
    ///
    /// # Errors
    /// A [`PlanError`] that names what does not fit.
    fn check(&self, states: usize, controls: usize) -> Result<(), PlanError> {
        let _ = (states, controls);
        Ok(())
    }
}

/// Derivatives of the cost of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct Expansion {
    /// ∂l/∂x, n.
    pub x: DVector<f64>,
    /// ∂l/∂u, m.
    pub u: DVector<f64>,
    /// ∂²l/∂x², n × n, symmetric.
    pub xx: DMatrix<f64>,
    /// ∂²l/∂u∂x, m × n.
    pub ux: DMatrix<f64>,
    /// ∂²l/∂u², m × m, symmetric.
    pub uu: DMatrix<f64>,
}

/// Derivatives of the cost of the end.
#[derive(Clone, Debug, PartialEq)]
pub struct LastExpansion {
    /// ∂l/∂x, n.
    pub x: DVector<f64>,
    /// ∂²l/∂x², n × n, symmetric.
    pub xx: DMatrix<f64>,
}

impl Expansion {
    /// Refuses an expansion of other sizes, or one that is not finite.
    pub(crate) fn check(&self, step: usize, n: usize, m: usize) -> Result<(), PlanError> {
        let Self { x, u, xx, ux, uu } = self;
        size("∂l/∂x of the cost", [n, 1], x.shape())?;
        size("∂l/∂u of the cost", [m, 1], u.shape())?;
        size("∂²l/∂x² of the cost", [n, n], xx.shape())?;
        size("∂²l/∂u∂x of the cost", [m, n], ux.shape())?;
        size("∂²l/∂u² of the cost", [m, m], uu.shape())?;
        let all = x.iter().chain(u).chain(xx).chain(ux).chain(uu);
        finite("a derivative of the cost", step, all)
    }
}

impl LastExpansion {
    /// The same for the end, after so many steps.
    pub(crate) fn check(&self, step: usize, n: usize) -> Result<(), PlanError> {
        size("∂l/∂x of the last cost", [n, 1], self.x.shape())?;
        size("∂²l/∂x² of the last cost", [n, n], self.xx.shape())?;
        finite("a derivative of the last cost", step, self.x.iter().chain(&self.xx))
    }
}

/// Refuses a matrix of another size.
pub(crate) fn size(
    what: &'static str,
    [rows, columns]: [usize; 2],
    found: (usize, usize),
) -> Result<(), PlanError> {
    if found == (rows, columns) {
        Ok(())
    } else {
        Err(PlanError::Size { what, expected: (rows, columns), found })
    }
}

/// Refuses numbers of which one is not finite.
pub(crate) fn finite<'a>(
    what: &'static str,
    step: usize,
    mut all: impl Iterator<Item = &'a f64>,
) -> Result<(), PlanError> {
    match all.find(|x| !x.is_finite()) {
        None => Ok(()),
        Some(value) => Err(PlanError::NotFinite { what, step, value: *value }),
    }
}
