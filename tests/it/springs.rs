//! Springs, dampers and soft joints obey implicit Euler exactly, and converge to the oscillator.
//!
//! ```text
//!  m (v⁺ − v)/dt = −k (x + dt v⁺) − d v⁺       v⁺ = (v − dt k x/m) / (1 + dt d/m + dt² k/m)
//! ```

use tangency::{BodyDef, JointDef, JointKind, Path, SceneDef, Softness, WORLD};
use tangency_bench::scenes::{block, hinge, unit_scene};

use crate::engine::{backends, built, near, order, run, steps, with_dt};

const MASS: f64 = 2.0;

/// A mass on a spring along x, 0.3 m beyond its rest.
fn oscillator(stiffness: f64, damping: f64) -> SceneDef {
    let mass = BodyDef { mass: Some(MASS), ..block("mass", [0.1, 0.1], [1.3, 0.0]) };
    let kind = JointKind::Spring {
        anchor_a: [0.0; 2],
        anchor_b: [1.3, 0.0],
        length: Some(1.0),
        stiffness,
        damping,
    };
    let bodies = [WORLD.into(), "mass".into()];
    let spring = JointDef { name: "spring".into(), bodies, kind, collide: false, softness: None };
    SceneDef { joints: vec![spring], ..unit_scene("oscillator", vec![mass]) }
}

/// (x, v) by the recursion.
fn recursion(stiffness: f64, damping: f64, dt: f64, steps: usize) -> (f64, f64) {
    let below = 1.0 + dt * damping / MASS + dt * dt * stiffness / MASS;
    (0..steps).fold((0.3, 0.0), |(x, v), _| {
        let v = (v - dt * stiffness * x / MASS) / below;
        (x + dt * v, v)
    })
}

#[test]
fn springs_and_dampers() {
    for solver in backends() {
        for (k, d) in [(50.0, 0.0), (50.0, 3.0), (50.0, 40.0), (1e5, 10.0)] {
            let scene = built(&oscillator(k, d));
            let tape = run(&scene, &*solver, 100);
            let (x, v) = recursion(k, d, 0.01, 100);
            near("spring, x", tape.last().q[0].x - 1.0, x, 1e-10);
            near("spring, v", tape.last().v[0].x, v, 1e-10);
            assert_eq!(tape.records[0].islands[0].path, Path::Linear, "springs need no solver");
        }
    }
}

#[test]
fn a_pure_damper_slows() {
    for solver in backends() {
        let mut def = oscillator(0.0, 4.0);
        def.bodies[0].velocity = [1.5, 0.0];
        let tape = run(&built(&def), &*solver, 80);
        near("damper", tape.last().v[0].x, 1.5 / (1.0_f64 + 0.02).powi(80), 1e-12);
    }
}

#[test]
fn frequency_converges() {
    for solver in backends() {
        let (k, t) = (50.0, 1.6);
        let exact = 0.3 * ((k / MASS).sqrt() * t).cos();
        let off = |dt: f64| {
            let scene = built(&with_dt(oscillator(k, 0.0), dt));
            run(&scene, &*solver, steps(t, dt)).last().q[0].x - 1.0 - exact
        };
        near("spring, x(1.6), C=10", off(1e-3), 0.0, 1e-2);
        order("spring, x(1.6)", 0.9, off);
    }
}

/// A soft hinge is the same oscillator in x and in y.
#[test]
fn soft_hinge() {
    let softness = Softness { stiffness: 50.0, damping: 3.0 };
    let mass = BodyDef { mass: Some(MASS), ..block("mass", [0.1, 0.1], [0.3, -0.3]) };
    let mut pin = hinge("pin", WORLD, "mass", [0.0; 2]);
    pin.softness = Some(softness);
    if let JointKind::Revolute { anchor_b, .. } = &mut pin.kind {
        *anchor_b = Some([0.3, -0.3]);
    }
    let scene = built(&SceneDef { joints: vec![pin], ..unit_scene("soft hinge", vec![mass]) });
    for solver in backends() {
        let tape = run(&scene, &*solver, 100);
        let (x, v) = recursion(50.0, 3.0, 0.01, 100);
        for (axis, sign) in [(0, 1.0), (1, -1.0)] {
            near("soft hinge, x", tape.last().q[0][axis], sign * x, 1e-10);
            near("soft hinge, v", tape.last().v[0][axis], sign * v, 1e-10);
        }
    }
}

/// A soft weld turns back like a torsion spring.
#[test]
fn soft_weld() {
    let body =
        BodyDef { mass: Some(1.0), inertia: Some(MASS), ..block("flag", [0.1, 0.1], [0.0; 2]) };
    let bodies = vec![BodyDef { angular_velocity: 1.0, ..body }];
    let joint = JointDef {
        name: "weld".into(),
        bodies: [WORLD.into(), "flag".into()],
        kind: JointKind::Weld { anchor: [0.0; 2] },
        collide: false,
        softness: Some(Softness { stiffness: 50.0, damping: 0.0 }),
    };
    let scene = built(&SceneDef { joints: vec![joint], ..unit_scene("soft weld", bodies) });
    for solver in backends() {
        let tape = run(&scene, &*solver, 100);
        let below = 1.0 + 1e-4 * 50.0 / MASS;
        let (angle, rate) = (0..100).fold((0.0, 1.0), |(x, v), _| {
            let v = (v - 0.01 * 50.0 * x / MASS) / below;
            (x + 0.01 * v, v)
        });
        near("soft weld, angle", tape.last().q[0].z, angle, 1e-10);
        near("soft weld, rate", tape.last().v[0].z, rate, 1e-10);
    }
}

/// Energy counts what the springs hold, and falls: implicit Euler damps.
#[test]
fn energy_of_springs_falls() {
    for solver in backends() {
        let scene = built(&oscillator(50.0, 0.0));
        let tape = run(&scene, &*solver, 200);
        let energies: Vec<f64> = tape.states().map(|s| scene.energy(s)).collect();
        near("spring energy at the start", energies[0], 0.5 * 50.0 * 0.09, 1e-12);
        assert!(energies.windows(2).all(|e| e[1] <= e[0] * (1.0 + 1e-12)));
    }
}
