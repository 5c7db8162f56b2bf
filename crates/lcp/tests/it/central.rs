//! Points of the central path: known ones, and what all of them obey.

use tangency_lcp::{CentralPoint, Law, Lcp, LcpSolution, Scratch};

use crate::problems::{V, body, disc, near, row, solve, stack, supported};

fn central(problem: &Lcp, energy: f64) -> CentralPoint {
    CentralPoint::new(problem, &solve(problem), energy, &mut Scratch::default()).expect("a point")
}

/// V35 (d): 0 ≤ z ⟂ z + q ≥ 0 becomes z (z + q) = τ, z = (√(q² + 4τ) − q)/2.
#[test]
fn one_row_has_a_closed_form() {
    for q in [-3.0, -0.2, 0.0, 0.2, 3.0] {
        for tau in [1e-8_f64, 1e-4, 0.3] {
            let rows = vec![row([1.0, 0.0, 0.0], 0.0, Law::Unilateral)];
            let found = central(&body([1.0; 3], [q, 0.0, 0.0], rows), tau).solution;
            let root = (q * q + 4.0 * tau).sqrt();
            near(&[2.0 * found.impulses[0]], &[root - q], 1e-14);
            near(&[2.0 * found.slacks[0]], &[root + q], 1e-14);
        }
    }
}

/// |h ∓ λ| w± = ε with u = w⁻ − w⁺ makes u = ε/(h + λ) − ε/(h − λ).
#[track_caller]
fn obeys(problem: &Lcp, kappa: f64) {
    let energy = CentralPoint::energy(problem, kappa);
    let CentralPoint { solution, residual, .. } = central(problem, energy);
    assert!(residual <= 1e-11, "{residual:e}");
    let LcpSolution { velocities, impulses, slacks, .. } = &solution;
    let remainders = problem.remainders(velocities, impulses);
    assert_eq!(&remainders, slacks);
    // The smaller side of a pair is of the order κ, and known to rounding of the greater one.
    let off = energy * (1e-8 + 1e-11 / kappa);
    for (i, row) in problem.rows.iter().enumerate() {
        let (y, u) = (impulses[i], slacks[i]);
        let h = match row.law {
            Law::Equality => continue,
            Law::Unilateral => {
                near(&[y * u], &[energy], off);
                continue;
            }
            Law::Bounded { max } => max,
            Law::Friction { normal, mu } => mu * impulses[normal as usize],
        };
        // (h² − λ²) u = −2 ε λ, without the poles.
        assert!(y.abs() < h);
        near(&[(h - y) * (h + y) * u], &[-2.0 * energy * y], off * h);
    }
}

#[test]
fn every_product_is_the_same() {
    for kappa in [1e-8, 1e-5, 1e-2, 1.0] {
        for speed in [0.0, 0.02, 0.1, 1.0] {
            obeys(&disc(speed), kappa);
            obeys(&supported(2, speed, 0.5), kappa);
            obeys(&supported(5, speed, 0.5), kappa);
        }
        obeys(&stack(&[1.0, 3.0, 1.0]), kappa);
        let mut driven = disc(1.0);
        driven.rows.push(row([0.0, 0.0, 1.0], 7.0, Law::Bounded { max: 0.2 }));
        obeys(&driven, kappa);
    }
}

/// κ has no unit: the same points in other units of length, mass and time.
#[test]
fn units_do_not_matter() {
    let energy = |problem: &Lcp| CentralPoint::energy(problem, 1e-3);
    let problem = supported(3, 0.3, 0.5);
    let found = central(&problem, energy(&problem)).solution;
    for [length, mass, time] in [[10, 7, -3], [-20, -15, 10], [0, 1, 0]] {
        let [l, m, t] = [length, mass, time].map(|n| 2.0_f64.powi(n));
        let mut told = problem.clone();
        told.mass[0].component_mul_assign(&V::new(m, m, m * l * l));
        told.momentum[0].component_mul_assign(&V::new(m * l / t, m * l / t, m * l * l / t));
        told.rows.iter_mut().for_each(|row| row.jacobian[1].z *= l);
        let again = central(&told, energy(&told)).solution;
        let back = |v: &V| V::new(v.x * t / l, v.y * t / l, v.z * t);
        near(back(&again.velocities[0]).as_slice(), found.velocities[0].as_slice(), 1e-14);
        let impulses: Vec<f64> = again.impulses.iter().map(|y| y * t / (m * l)).collect();
        near(&impulses, &found.impulses, 1e-14);
    }
}
