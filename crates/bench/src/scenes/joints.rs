//! Pendulums and chains.

use tangency_core::{BodyDef, ForceDef, SceneDef, Shape, WORLD};

use super::bodies::{block, disc, hinge, material, rod, slender_inertia};

/// V02: slender rod (1 m, 1 kg) pinned at one end to the origin, `angle` from hanging, at rest.
#[must_use]
pub fn pendulum(angle: f64) -> SceneDef {
    doubled_hinge(angle, 1)
}

/// V22 (b): the pendulum with its hinge entered `k` times.
#[must_use]
pub fn doubled_hinge(angle: f64, k: usize) -> SceneDef {
    let (sin, cos) = angle.sin_cos();
    let turn = angle - std::f64::consts::FRAC_PI_2;
    let bodies = vec![rod("rod", 1.0, 1.0, [0.5 * sin, -0.5 * cos], turn)];
    let joints = (0..k).map(|i| hinge(&format!("pin{i}"), WORLD, "rod", [0.0; 2])).collect();
    SceneDef { name: "pendulum".into(), bodies, joints, ..SceneDef::default() }
}

/// `n` hanging slender rods (`length`, `mass`), the first pinned to the origin.
#[must_use]
pub fn chain(n: usize, length: f64, mass: f64) -> SceneDef {
    let down = -std::f64::consts::FRAC_PI_2;
    let link = |i: usize| BodyDef {
        groups: vec!["links".into()],
        ..rod(&format!("link{i}"), length, mass, [0.0, -(i as f64 + 0.5) * length], down)
    };
    let joint = |i: usize| {
        let above = if i == 0 { WORLD.into() } else { format!("link{}", i - 1) };
        hinge(&format!("pin{i}"), &above, &format!("link{i}"), [0.0, -(i as f64) * length])
    };
    let bodies = (0..n).map(link).collect();
    SceneDef {
        name: "chain".into(),
        bodies,
        joints: (0..n).map(joint).collect(),
        ..SceneDef::default()
    }
}

/// V16 (c): ten hanging rods (0.2 m, 0.1 kg); a disc (0.3 kg, 2 m/s) touches the centre of the
/// lowest, e = 1.
#[must_use]
pub fn hanging_chain_hit() -> SceneDef {
    let mut def = chain(10, 0.2, 0.1);
    def.name = "hanging chain struck by a disc".into();
    let lowest = &mut def.bodies[9];
    lowest.shapes =
        vec![Shape::Rectangle { width: 0.2, height: 0.01, center: [0.0; 2], angle: 0.0 }];
    let height = lowest.position[1];
    def.bodies.push(BodyDef {
        mass: Some(0.3),
        velocity: [2.0, 0.0],
        ..disc("disc", 0.1, [-0.105, height])
    });
    for body in &mut def.bodies {
        debug_assert!(body.name == "disc" || body.inertia == Some(slender_inertia(0.1, 0.2)));
    }
    material(def, 0.0, 1.0)
}

/// The chain of the paper's section 4.1 with `n` links of `total` mass, in its own unit of length:
/// pinned end to end, and struck by a ball that is pushed for a tenth of a second.
#[must_use]
pub fn paper_chain(n: usize, total: f64) -> SceneDef {
    let depth = |i: usize| -(50.0 + 50.0 * i as f64);
    let mut bodies = Vec::new();
    let mut joints = Vec::new();
    for i in 0..n {
        bodies.push(BodyDef {
            mass: Some(total / n as f64),
            groups: vec!["links".into()],
            ..block(&format!("link{i}"), [20.0, 60.0], [300.0, depth(i)])
        });
        let (above, anchor) = match i {
            0 => (WORLD.into(), [300.0, -30.0]),
            _ => (format!("link{}", i - 1), [300.0, depth(i) + 25.0]),
        };
        joints.push(hinge(&format!("pin{i}"), &above, &format!("link{i}"), anchor));
    }
    let ball = disc("ball", 20.0, [50.0, depth(n - 1)]);
    bodies.push(BodyDef { mass: Some(1.0), gravity_scale: 0.0, ..ball });
    let push = ForceDef {
        body: "ball".into(),
        force: [1500.0, 0.0],
        end: Some(0.1),
        ..ForceDef::default()
    };
    let def = SceneDef {
        name: "the paper's chain".into(),
        gravity: [0.0, -100.0],
        dt: 1.0 / 30.0,
        duration: 10.0,
        recovery_speed: 100.0,
        bodies,
        joints,
        forces: vec![push],
        ..SceneDef::default()
    };
    material(def, 0.5, 1.0)
}
