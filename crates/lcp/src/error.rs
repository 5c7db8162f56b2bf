//! Why a problem was refused or not solved.

use std::error::Error;

use thiserror::Error;

/// A number without rows of zeros.
fn number(value: f64) -> String {
    let plain = value == 0.0 || (1e-6..1e12).contains(&value.abs());
    if plain { value.to_string() } else { format!("{value:e}") }
}

/// Causes, each with its numbers.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LcpError {
    /// A number in the problem is NaN or infinite.
    #[error("{what} of item {index} is not finite")]
    NotFinite {
        /// Field, for instance `row.rhs`.
        what: &'static str,
        /// Index of the body or row.
        index: usize,
    },
    /// A number that must be positive (or not negative) is not, or is not from 1e-150 to 1e150.
    #[error("{what} of item {index} is {}, which is out of range", number(*value))]
    OutOfRange {
        /// Field, for instance `row.law.mu`.
        what: &'static str,
        /// Index of the body or row.
        index: usize,
        /// Value found.
        value: f64,
    },
    /// Two lists that belong together differ in length.
    #[error("{what} has {found} entries, expected {expected}")]
    DimensionMismatch {
        /// List, for instance `momentum`.
        what: &'static str,
        /// Expected length.
        expected: usize,
        /// Length found.
        found: usize,
    },
    /// A row names a body that does not exist.
    #[error("row {row} acts on body {body}, but there are {bodies} bodies")]
    NoSuchBody {
        /// Row index.
        row: usize,
        /// Body index found.
        body: usize,
        /// Number of bodies.
        bodies: usize,
    },
    /// A row names the same body twice.
    #[error("row {row} joins body {body} to itself")]
    SameBody {
        /// Row index.
        row: usize,
        /// Body index.
        body: usize,
    },
    /// A row has a Jacobian block on the side where it has no body.
    #[error("row {row} has a non-zero jacobian block {side} but no body there")]
    BlockWithoutBody {
        /// Row index.
        row: usize,
        /// Side, 0 or 1.
        side: usize,
    },
    /// A friction row's normal row does not come before it.
    #[error("friction row {row} names row {normal} as its normal, which must come earlier")]
    NormalNotEarlier {
        /// Row index of the friction row.
        row: usize,
        /// Index given for the normal row.
        normal: usize,
    },
    /// A friction row's normal row has another law than [`Law::Unilateral`](crate::Law).
    #[error("friction row {row} names row {normal} as its normal, which is not unilateral")]
    NormalNotUnilateral {
        /// Row index of the friction row.
        row: usize,
        /// Index given for the normal row.
        normal: usize,
    },
    /// The paper's dense form has no place for this row.
    #[error("row {row} has no counterpart in the paper's form: {what}")]
    NotInPaperForm {
        /// Row index.
        row: usize,
        /// What the row has that the form lacks.
        what: &'static str,
    },
    /// The backend does not take problems of this class.
    #[error(
        "{solver} solves {class} problems only, and this one has {measure} = {value:e}; take another backend"
    )]
    OutsideClass {
        /// Name of the solver.
        solver: &'static str,
        /// The class that it solves.
        class: &'static str,
        /// The number that decides.
        measure: &'static str,
        /// Its value.
        value: f64,
    },
    /// The constraints contradict each other.
    #[error("conflicting constraints, violated by {residual:e} at least; loosen or remove rows")]
    Infeasible {
        /// The least violation that was found, free of units.
        residual: f64,
    },
    /// The solver stopped before the residual was small enough.
    #[error(
        "not converged after {iterations} iterations, residual {residual:e}; raise `max_iterations`, loosen `tolerance` or take a smaller time step"
    )]
    NotConverged {
        /// Iterations spent.
        iterations: u32,
        /// Smallest natural residual reached, free of units.
        residual: f64,
    },
    /// The backend returned a solution that the residual does not confirm.
    #[error("{solver} returned a residual of {residual:e}, above the accepted {tolerance:e}")]
    Rejected {
        /// Name of the solver.
        solver: &'static str,
        /// Natural residual found, free of units.
        residual: f64,
        /// Greatest residual accepted.
        tolerance: f64,
    },
    /// A failure private to a backend.
    #[error("{solver} failed")]
    Backend {
        /// Name of the solver.
        solver: &'static str,
        /// The backend's own error.
        source: Box<dyn Error + Send + Sync>,
    },
}

impl LcpError {
    /// The best residual reached, where the error carries one.
    #[must_use]
    pub fn residual(&self) -> Option<f64> {
        match self {
            Self::Infeasible { residual }
            | Self::NotConverged { residual, .. }
            | Self::Rejected { residual, .. } => Some(*residual),
            _ => None,
        }
    }
}
