//! Why there is no plan.

use crate::Plan;

/// A plan that could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// A vector or matrix that does not fit.
    #[error(
        "{what}: {} × {} numbers, expected {} × {}",
        found.0, found.1, expected.0, expected.1
    )]
    Size {
        /// Which.
        what: &'static str,
        /// Expected rows and columns.
        expected: (usize, usize),
        /// Those found.
        found: (usize, usize),
    },
    /// A number that is NaN or infinite.
    #[error("{what} at step {step} is {value}; look for a division by zero or an overflow")]
    NotFinite {
        /// What it belongs to.
        what: &'static str,
        /// The step.
        step: usize,
        /// The number.
        value: f64,
    },
    /// Weights that are no quadratic form.
    #[error("{what}: entries ({row}, {column}) are {one} and {other}; make them equal")]
    NotSymmetric {
        /// Which.
        what: &'static str,
        /// Row.
        row: usize,
        /// Column.
        column: usize,
        /// Entry (row, column).
        one: f64,
        /// Entry (column, row).
        other: f64,
    },
    /// Limits that leave no room.
    #[error("control {channel} is to lie between {lower} and {upper}; give lower ≤ upper")]
    Limits {
        /// Which number of the control.
        channel: usize,
        /// Lower limit.
        lower: f64,
        /// Upper limit.
        upper: f64,
    },
    /// A first guess outside the limits.
    #[error(
        "control {channel} of step {step} is {value}, outside {lower} to {upper}; begin within the limits"
    )]
    Outside {
        /// The step.
        step: usize,
        /// Which number of the control.
        channel: usize,
        /// Its value.
        value: f64,
        /// Lower limit.
        lower: f64,
        /// Upper limit.
        upper: f64,
    },
    /// A setting out of its range.
    #[error("{field} is {value}: {expected}")]
    Setting {
        /// The field of the planner.
        field: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        expected: &'static str,
    },
    /// The first guess could not be followed, or a motion not be differentiated.
    #[error("step {step}: {source}")]
    Dynamics {
        /// The step.
        step: usize,
        /// Why.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// Every iteration improved the plan, but it is not done.
    #[error(
        "after {iterations} iterations another step promises {promised:.1e} of a cost of {:.6e}; raise \
         `max_iterations` or go on from `plan`",
        plan.cost
    )]
    Iterations {
        /// Iterations done.
        iterations: usize,
        /// The decrease that the next step would bring if all were quadratic.
        promised: f64,
        /// The best plan so far.
        plan: Box<Plan>,
    },
    /// No step, however short, brings the decrease that derivatives promise.
    #[error(
        "after {iterations} iterations no step brings any of the promised {promised:.1e}; the motion is \
         at a switch (a contact that opens or begins to slide), or the cost's derivatives are wrong"
    )]
    Stuck {
        /// Iterations done.
        iterations: usize,
        /// The decrease that derivatives promise.
        promised: f64,
        /// The best plan so far.
        plan: Box<Plan>,
    },
}
