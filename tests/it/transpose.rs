//! The adjoint of a sliding contact solves with the transpose: S = B M⁻¹ Cᵀ with C ≠ B is not
//! symmetric, and its own inverse in place of its transpose's is wrong as soon as a sliding contact
//! also turns its body or shares it with another.
//!
//! Here a box slides tilted on one corner, and a second one slides against both floor and box, so
//! that S is visibly asymmetric. Both tests fail on that mistake (tried), as do those of V05, V07,
//! V22 and V35 and the differences of `gradients`.

use nalgebra::Vector3;
use tangency::diff::lcp::{LcpVector, lcp_jvp, lcp_vjp};
use tangency::lcp::{Law, Mode};
use tangency::{BodyDef, IslandRecord, SceneDef};
use tangency_bench::finite_difference::derivative;
use tangency_bench::scenes::{block, floor, material};

use crate::engine::{backends, built, first_step};

/// A tilted box slides on its corner and pushes a second box along the floor.
fn pushing() -> SceneDef {
    let tilted = BodyDef {
        angle: 0.3,
        velocity: [2.0, -0.4],
        mass: Some(2.0),
        ..block("tilted", [0.6, 0.3], [0.0, 0.2316])
    };
    let pushed = BodyDef { mass: Some(0.7), ..block("pushed", [0.3, 0.5], [0.483, 0.25]) };
    let def = SceneDef { bodies: vec![floor(), tilted, pushed], ..SceneDef::default() };
    material(def, 0.25, 0.0)
}

fn sliding(island: &IslandRecord) -> usize {
    let rows = island.problem.rows.iter().zip(&island.solution.modes);
    let slides = |(row, mode): &(&tangency::lcp::Row, &Mode)| {
        matches!(row.law, Law::Friction { .. }) && matches!(mode, Mode::Upper | Mode::Lower)
    };
    rows.filter(slides).count()
}

fn islands() -> Vec<IslandRecord> {
    let scene = built(&pushing());
    backends().iter().map(|solver| first_step(&scene, &**solver).islands.remove(0)).collect()
}

fn bar(bodies: usize) -> Vec<Vector3<f64>> {
    (0..bodies).map(|i| Vector3::new(1.0, -0.4, 0.7) * (1.0 + i as f64)).collect()
}

/// ∂(w·v⁺)/∂p by the adjoint, against differences of the solved problem itself.
#[test]
fn momentum_gradient_of_sliding_contacts() {
    for (solver, island) in backends().iter().zip(islands()) {
        assert!(sliding(&island) >= 2, "{} contacts slide", sliding(&island));
        let bar = bar(island.bodies.len());
        let (by, _) = lcp_vjp(&island.problem, &island.solution, &bar, None).expect("an adjoint");
        for (body, bar_of_body) in by.momentum.iter().enumerate() {
            for axis in 0..3 {
                let value = |p: f64| {
                    let mut problem = island.problem.clone();
                    problem.momentum[body][axis] = p;
                    let solved =
                        solver.solve(&problem, None, &mut tangency::lcp::Scratch::default());
                    let solved = solved.expect("a solution");
                    assert_eq!(solved.modes, island.solution.modes);
                    solved.velocities.iter().zip(&bar).map(|(v, w)| v.dot(w)).sum()
                };
                let exact = derivative(value, island.problem.momentum[body][axis], 1e-3).value;
                let off = (bar_of_body[axis] - exact).abs();
                assert!(off <= 1e-8 * (1.0 + exact.abs()), "{} is not {exact}", bar_of_body[axis]);
            }
        }
    }
}

/// The map p ↦ v⁺ is not symmetric here: an adjoint that takes the matrix for its transpose
/// returns the forward derivative, which differs by far.
#[test]
fn the_map_is_visibly_asymmetric() {
    for island in islands() {
        let seed = bar(island.bodies.len());
        let (by, _) = lcp_vjp(&island.problem, &island.solution, &seed, None).expect("an adjoint");
        let mut along = LcpVector::zeros(&island.problem);
        along.momentum.clone_from(&seed);
        let (forward, _) = lcp_jvp(&island.problem, &island.solution, &along).expect("a tangent");
        let off: f64 = by.momentum.iter().zip(&forward).map(|(a, b)| (a - b).norm()).sum();
        let size: f64 = forward.iter().map(Vector3::norm).sum();
        assert!(off >= 0.05 * size, "matrix and transpose differ by {off} of {size} only");
    }
}
