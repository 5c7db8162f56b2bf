//! Input that the planner refuses, by names and values.

use nalgebra::{DMatrix, DVector};
use tangency_control::{ControlLimits, Plan, PlanError, Planner, Quadratic};

use crate::linear::Linear;

fn cost() -> Quadratic {
    let mut cost = Quadratic::of_effort(1, 1, 1.0);
    cost.aim(0, 2.0, 0.0, 1.0);
    cost
}

fn plan(
    planner: &Planner,
    cost: &Quadratic,
    limits: &ControlLimits,
    controls: &[Vec<f64>],
) -> Result<Plan, PlanError> {
    planner.plan(&mut Linear::sum(), cost, limits, &DVector::zeros(1), controls)
}

/// What is refused when one thing is wrong.
fn refused(change: impl FnOnce(&mut Planner, &mut Quadratic, &mut Vec<Vec<f64>>)) -> String {
    let (mut planner, mut cost, mut controls) = (Planner::default(), cost(), vec![vec![0.5]; 3]);
    change(&mut planner, &mut cost, &mut controls);
    let limits = ControlLimits::new(vec![-1.0], vec![1.0]).expect("limits");
    plan(&planner, &cost, &limits, &controls).expect_err("it is refused").to_string()
}

#[track_caller]
fn says(message: &str, all: &[&str]) {
    for part in all {
        assert!(message.contains(part), "{message:?} lacks {part:?}");
    }
}

#[test]
fn guesses() {
    says(&refused(|_, _, u| u[2] = vec![1.5]), &["control 0", "step 2", "1.5", "-1 to 1"]);
    says(&refused(|_, _, u| u[1] = vec![f64::NAN]), &["a control of the first guess", "NaN"]);
    says(&refused(|_, _, u| u[1] = vec![0.0; 2]), &["a control of the first guess", "2 × 1"]);
}

#[test]
fn costs() {
    says(&refused(|_, cost, _| cost.target = DVector::zeros(2)), &["target", "2 × 1", "1 × 1"]);
    says(&refused(|_, cost, _| cost.last[(0, 0)] = f64::NAN), &["weights of the last", "NaN"]);
    let mut lopsided = Quadratic::of_effort(2, 1, 1.0);
    lopsided.state = DMatrix::from_row_slice(2, 2, &[1.0, 0.5, 0.25, 1.0]);
    let (limits, at) = (ControlLimits::none(1), DVector::zeros(2));
    let found =
        Planner::default().plan(&mut Linear::mass(0.1), &lopsided, &limits, &at, &[vec![0.0]]);
    says(&found.expect_err("refused").to_string(), &["weights of states", "(1, 0)", "0.25", "0.5"]);
}

#[test]
fn settings() {
    says(&refused(|planner, _, _| planner.tolerance = -1.0), &["tolerance is -1"]);
    says(&refused(|planner, _, _| planner.regularisation_factor = 1.0), &["factor is 1: give"]);
    says(&refused(|planner, _, _| planner.least_regularisation = 0.0), &["least_regularisation"]);
    says(&refused(|planner, _, _| planner.least_success = f64::NAN), &["least_success is NaN"]);
}

#[test]
fn limits() {
    let message = |lower, upper| {
        let found = ControlLimits::new(vec![0.0, lower], vec![1.0, upper]);
        found.expect_err("no room").to_string()
    };
    says(&message(2.0, 1.0), &["control 1", "between 2 and 1"]);
    says(&message(f64::NAN, 1.0), &["control 1", "NaN"]);
    says(&message(f64::INFINITY, f64::INFINITY), &["control 1", "inf"]);
    let found = ControlLimits::new(vec![0.0], vec![]).expect_err("lengths differ");
    assert!(matches!(found, PlanError::Size { expected: (1, 1), found: (0, 1), .. }));
    let found = plan(&Planner::default(), &cost(), &ControlLimits::none(2), &[]);
    assert!(matches!(found, Err(PlanError::Size { what: "the limits of the control", .. })));
}

/// A control that costs nothing and does nothing has no best value: the planner says so instead of
/// dividing by zero. One iteration short of the end, the plan so far is in the error.
#[test]
fn what_is_not_done() {
    let mut planner = Planner { max_iterations: 0, ..Planner::default() };
    let limits = ControlLimits::none(1);
    let found = plan(&planner, &cost(), &limits, &[vec![0.0], vec![0.0]]);
    let Err(PlanError::Iterations { plan: best, .. }) = found else { panic!("{found:?}") };
    assert_eq!((best.cost, best.controls), (2.0, vec![vec![0.0], vec![0.0]]));

    planner.max_iterations = 10;
    let (mut system, at) = (Linear::sum(), DVector::zeros(1));
    system.control[(0, 0)] = 0.0;
    let free = Quadratic { control: DMatrix::zeros(1, 1), ..cost() };
    let found = planner.plan(&mut system, &free, &limits, &at, &[vec![0.0]]);
    let Ok(found) = found else { panic!("{found:?}") };
    assert_eq!((found.controls[0][0], found.cost), (0.0, 2.0));
}

/// No steps: nothing to do.
#[test]
fn no_steps() {
    let found = plan(&Planner::default(), &cost(), &ControlLimits::none(1), &[]);
    assert_eq!(found.expect("a plan").cost, 2.0);
}
