//! Linear systems with quadratic costs: closed forms, and the whole problem as one quadratic.

use nalgebra::{DMatrix, DVector};
use tangency_control::{ControlLimits, Ending, Plan, Planner, Quadratic};

use crate::box_qp::by_enumeration;
use crate::linear::Linear;

fn plan(
    system: &Linear,
    cost: &Quadratic,
    limits: &ControlLimits,
    initial: &[f64],
    steps: usize,
) -> Plan {
    let initial = DVector::from_column_slice(initial);
    let guess = vec![vec![0.0; system.control.ncols()]; steps];
    Planner { tolerance: 1e-14, ..Planner::default() }
        .plan(&mut system.clone(), cost, limits, &initial, &guess)
        .unwrap_or_else(|error| panic!("{error}"))
}

#[track_caller]
fn near(what: &str, found: f64, exact: f64, tolerance: f64) {
    assert!((found - exact).abs() <= tolerance, "{what}: {found} is not {exact}");
}

/// x⁺ = x + u, cost ½ Σ r u² + ½ q x_T²: all controls are −q x₀/(r + T q), in one iteration.
#[test]
fn shared_out_evenly() {
    let (r, q, steps) = (0.3, 2.0, 7);
    let mut cost = Quadratic::of_effort(1, 1, r);
    cost.aim(0, 0.0, 0.0, q);
    let found = plan(&Linear::sum(), &cost, &ControlLimits::none(1), &[1.5], steps);
    let exact = -q * 1.5 / (r + 7.0 * q);
    found.controls.iter().for_each(|u| near("u", u[0], exact, 1e-13));
    near("cost", found.cost, 0.5 * r * q * 1.5 * 1.5 / (r + 7.0 * q), 1e-13);
    assert_eq!((found.iterations, found.ending), (1, Some(Ending::Optimal)));
}

/// x⁺ = x + u, cost ½ Σ (x² + u²): the stationary Riccati equation P = 1 + P − P²/(1 + P) has the
/// golden ratio as its solution, and the gain −P/(1 + P) = −1/P. With P as the weight of the end, every
/// step has that gain.
#[test]
fn golden_ratio() {
    let golden = f64::midpoint(1.0, 5.0_f64.sqrt());
    let mut cost = Quadratic::of_effort(1, 1, 1.0);
    cost.aim(0, 0.0, 1.0, golden);
    let found = plan(&Linear::sum(), &cost, &ControlLimits::none(1), &[1.0], 20);
    for (k, gain) in found.gains.iter().enumerate() {
        near("K", gain[(0, 0)], -1.0 / golden, 1e-14);
        near("u", found.controls[k][0], -found.states[k][0] / golden, 1e-14);
    }
    near("cost", found.cost, 0.5 * golden, 1e-14);
    assert_eq!(found.iterations, 1);
}

/// A mass brought to rest at a place: without limits, the Riccati recursion written out.
#[test]
fn riccati_recursion() {
    let (system, steps) = (Linear::mass(0.1), 30);
    let mut cost = Quadratic::of_effort(2, 1, 0.02);
    cost.aim(0, 0.0, 0.4, 30.0);
    cost.aim(1, 0.0, 0.1, 20.0);
    let found = plan(&system, &cost, &ControlLimits::none(1), &[1.0, -0.5], steps);
    let (a, b) = (&system.state, &system.control);
    let mut p = cost.last.clone();
    for k in (0..steps).rev() {
        let inner = (&cost.control + b.transpose() * &p * b)[(0, 0)];
        let gain = b.transpose() * &p * a / -inner;
        p = &cost.state + a.transpose() * &p * (a + b * &gain);
        near("K", (&found.gains[k] - &gain).amax(), 0.0, 1e-12);
        near("u", found.controls[k][0], (&gain * &found.states[k])[(0, 0)], 1e-12);
    }
    assert_eq!(found.iterations, 1);
}

/// Six bounded pushes of a mass: the problem in all controls at once, x_T = A⁶ x₀ + Σ A⁵⁻ᵏ B uₖ, by
/// trying all 3⁶ sets of limits.
#[test]
fn limits_against_enumeration() {
    let (system, steps, initial) = (Linear::mass(0.5), 6, DVector::from_vec(vec![2.0, 0.3]));
    let mut cost = Quadratic::of_effort(2, 1, 0.05);
    cost.aim(0, 0.0, 0.0, 8.0);
    cost.aim(1, 0.0, 0.0, 3.0);
    let columns: Vec<DVector<f64>> = (0..steps)
        .map(|k| {
            let power = (k + 1..steps).fold(DMatrix::identity(2, 2), |all, _| &system.state * all);
            (power * &system.control).column(0).into()
        })
        .collect();
    let by_controls = DMatrix::from_columns(&columns);
    let drift = (0..steps).fold(initial.clone(), |x, _| &system.state * x);
    let weighted = &cost.last * &by_controls;
    let hessian = by_controls.tr_mul(&weighted) + DMatrix::identity(6, 6) * 0.05;
    let exact = by_enumeration(&hessian, &weighted.tr_mul(&drift), -0.7, 0.9);
    let met = exact.iter().filter(|u| **u == -0.7 || **u == 0.9).count();
    assert!((2..=5).contains(&met), "{met} limits are met: {exact}");

    let limits = ControlLimits::new(vec![-0.7], vec![0.9]).expect("limits");
    let found = plan(&system, &cost, &limits, initial.as_slice(), steps);
    for (k, u) in found.controls.iter().enumerate() {
        near("u", u[0], exact[k], 1e-7);
    }
    assert!(found.history.is_sorted_by(|before, after| after <= before));
    assert_eq!(found.gains.iter().filter(|gain| gain.amax() == 0.0).count(), met);
}

/// Off the plan by a little, feedback keeps to it; far off, it keeps to the limits.
#[test]
fn feedback() {
    let golden = f64::midpoint(1.0, 5.0_f64.sqrt());
    let mut cost = Quadratic::of_effort(1, 1, 1.0);
    cost.aim(0, 0.0, 1.0, golden);
    let limits = ControlLimits::new(vec![-0.8], vec![0.8]).expect("limits");
    let found = plan(&Linear::sum(), &cost, &limits, &[1.0], 5);
    let at = |x: f64| found.feedback(0, &DVector::from_element(1, x))[0];
    near("near", at(1.1), -1.1 / golden, 1e-14);
    near("far", at(3.0), -0.8, 0.0);
}
