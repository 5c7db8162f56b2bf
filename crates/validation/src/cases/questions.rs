//! The runs that V38 differentiates, and by what.

use tangency_bench::scenes::{
    falling_disc, hanging_chain_hit, hinge, incline_block, line_collision, oblique_collision,
    pendulum, rod, slender_inertia, sliding_disc, stack,
};
use tangency_core::{Param, SceneDef, WORLD};

use crate::run::{by_friction, by_restitution};

/// A direction and its name.
type Named = (&'static str, Vec<(Param, f64)>);

/// A run, and what it is differentiated by.
pub(super) struct Question {
    pub(super) def: SceneDef,
    pub(super) duration: f64,
    pub(super) by: Vec<Named>,
}

fn one(param: Param) -> Vec<(Param, f64)> {
    vec![(param, 1.0)]
}

/// Gravity downwards.
fn gravity() -> Vec<(Param, f64)> {
    vec![(Param::Gravity(1), -1.0)]
}

pub(super) fn large_pendulum() -> Question {
    let (sin, cos) = 2.5_f64.sin_cos();
    let turn = vec![
        (Param::Position(0, 2), 1.0),
        (Param::Position(0, 0), 0.5 * cos),
        (Param::Position(0, 1), 0.5 * sin),
    ];
    // The inertia m L²/12 and the way from pin to centre follow the length.
    let length = vec![
        (Param::Inertia(0), 1.0 / 6.0),
        (Param::AnchorB(0, 0), -0.5),
        (Param::Position(0, 0), 0.5 * sin),
        (Param::Position(0, 1), -0.5 * cos),
    ];
    let mass = vec![(Param::Mass(0), 1.0), (Param::Inertia(0), 1.0 / 12.0)];
    let by = vec![("start angle", turn), ("L", length), ("g", gravity()), ("m", mass)];
    Question { def: SceneDef { dt: 1e-3, ..pendulum(2.5) }, duration: 2.0, by }
}

pub(super) fn bouncing() -> Question {
    let by = vec![
        ("height", one(Param::Position(1, 1))),
        ("speed", one(Param::Velocity(1, 1))),
        ("e", by_restitution(0, 1).to_vec()),
        ("g", gravity()),
        ("r", one(Param::Radius(1, 0))),
    ];
    Question { def: SceneDef { dt: 1e-3, ..falling_disc(1.0, 0.8) }, duration: 2.0, by }
}

pub(super) fn incline() -> Question {
    let angle = 30.0_f64.to_radians();
    let (sin, cos) = angle.sin_cos();
    let by = vec![
        ("mu", by_friction(0, 1).to_vec()),
        ("v0", vec![(Param::Velocity(1, 0), cos), (Param::Velocity(1, 1), sin)]),
        ("g", gravity()),
        ("m", one(Param::Mass(1))),
    ];
    Question { def: SceneDef { dt: 1e-3, ..incline_block(angle, 0.7, 3.0) }, duration: 0.5, by }
}

pub(super) fn rolling() -> Question {
    let by = vec![
        ("v0", one(Param::Velocity(1, 0))),
        ("w0", one(Param::Velocity(1, 2))),
        ("mu", by_friction(0, 1).to_vec()),
        ("I", one(Param::Inertia(1))),
    ];
    Question { def: SceneDef { dt: 1e-3, ..sliding_disc() }, duration: 1.0, by }
}

/// The masses of two bodies, their common e and their velocities along x.
fn pair_numbers() -> Vec<Named> {
    vec![
        ("m1", one(Param::Mass(0))),
        ("m2", one(Param::Mass(1))),
        ("v1", one(Param::Velocity(0, 0))),
        ("v2", one(Param::Velocity(1, 0))),
    ]
}

pub(super) fn line() -> Question {
    let mut by = pair_numbers();
    by.push(("e", by_restitution(0, 1).to_vec()));
    Question { def: line_collision(), duration: 0.05, by }
}

pub(super) fn oblique() -> Question {
    let mut by = pair_numbers();
    by.push(("b", one(Param::Position(1, 1))));
    // At e = 1 a difference would leave the range.
    let mut def = SceneDef { dt: 1e-3, ..oblique_collision(0.0, [1.0, 0.1]) };
    def.bodies.iter_mut().for_each(|body| body.restitution = 0.9);
    by.push(("e", by_restitution(0, 1).to_vec()));
    Question { def, duration: 1.0, by }
}

/// V12: three rods of 1 m and 1 kg, pinned side by side, 1.2 rad from hanging, carry a bar of 1 kg.
pub(super) fn parallelogram() -> Question {
    let (sin, cos) = 1.2_f64.sin_cos();
    let (mut bodies, mut joints) = (Vec::new(), Vec::new());
    for i in 0..3 {
        let x = 0.5 * f64::from(i);
        let name = format!("crank{i}");
        bodies.push(rod(
            &name,
            1.0,
            1.0,
            [x + 0.5 * sin, -0.5 * cos],
            1.2 - 0.5 * std::f64::consts::PI,
        ));
        joints.push(hinge(&format!("top{i}"), WORLD, &name, [x, 0.0]));
        joints.push(hinge(&format!("low{i}"), &name, "bar", [x + sin, -cos]));
    }
    bodies.push(rod("bar", 1.0, 1.0, [0.5 + sin, -cos], 0.0));
    let mut turn = vec![(Param::Position(3, 0), cos), (Param::Position(3, 1), sin)];
    for i in 0..3 {
        turn.push((Param::Position(i, 0), 0.5 * cos));
        turn.push((Param::Position(i, 1), 0.5 * sin));
        turn.push((Param::Position(i, 2), 1.0));
    }
    let by = vec![
        ("start angle", turn),
        ("bar mass", one(Param::Mass(3))),
        ("crank mass", vec![(Param::Mass(0), 1.0), (Param::Inertia(0), slender_inertia(1.0, 1.0))]),
        ("g", gravity()),
    ];
    let def =
        SceneDef { name: "parallelogram".into(), dt: 1e-3, bodies, joints, ..SceneDef::default() };
    Question { def, duration: 1.0, by }
}

pub(super) fn chain() -> Question {
    let inertia = slender_inertia(1.0, 0.2); // per mass
    let links = (0..10).flat_map(|i| [(Param::Mass(i), 1.0), (Param::Inertia(i), inertia)]);
    let mut def = hanging_chain_hit();
    // At e = 1 a difference would leave the range.
    def.bodies.iter_mut().for_each(|body| body.restitution = 0.9);
    let by = vec![
        ("link mass", links.collect()),
        ("disc mass", one(Param::Mass(10))),
        ("v0", one(Param::Velocity(10, 0))),
        ("e", by_restitution(9, 10).to_vec()),
    ];
    Question { def, duration: 0.01, by }
}

pub(super) fn heavy_stack() -> Question {
    let by = vec![
        ("top mass", one(Param::Mass(2))),
        ("g", gravity()),
        ("mu", (0..3).map(|i| (Param::Friction(i), 1.0)).collect()),
        ("vx of the top", one(Param::Velocity(2, 0))),
    ];
    Question { def: stack(&[1.0, 1e3]), duration: 1.0, by }
}
