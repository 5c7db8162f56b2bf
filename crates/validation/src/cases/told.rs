//! The scenes that V27 tells in several ways.

use tangency_bench::random_scene;
use tangency_bench::scenes::{
    bent_arm, compound_tumble, conveyor, incline_block, motor_arm, oblique_collision,
    parallelogram, pendulum, piston, pyramid, sliding_disc, soft_bridge, spring_cart, stack,
};
use tangency_core::SceneDef;

/// A scene to be told in several ways.
pub(super) struct Told {
    pub(super) def: SceneDef,
    /// How long it runs, s.
    pub(super) duration: f64,
    /// Whether more rows hold it than need be. Then one place alone cannot be moved without
    /// contradicting others, and what derivatives by places say depends on the frame.
    pub(super) overdetermined: bool,
}

/// V05, V07, V09 (b) and V19.
pub(super) fn named() -> Vec<Told> {
    let slope = 30.0_f64.to_radians();
    let told = |name: &str, def: SceneDef, duration| {
        let def = SceneDef { name: name.into(), ..def };
        Told { def, duration, overdetermined: false }
    };
    vec![
        told("V05 (a)", incline_block(slope, 0.5, 0.0), 1.0),
        told("V05 (b)", incline_block(slope, 0.7, 3.0), 1.0),
        told("V07", sliding_disc(), 2.0),
        told("V09 (b)", oblique_collision(0.0, [1.0, 0.1]), 1.0),
        told("V19", stack(&[1.0, 1e3]), 1.0),
    ]
}

/// Joints, limits, motors, springs, a pile, and whatever else a seed brings.
fn others() -> Vec<Told> {
    let three_cranks = SceneDef { name: "three cranks".into(), ..parallelogram(3, 1.2) };
    let overdetermined = [three_cranks, pyramid(4)];
    let machines = [
        pendulum(2.5),
        parallelogram(2, 1.2),
        soft_bridge(6),
        motor_arm(),
        bent_arm(),
        piston(),
        spring_cart(),
        compound_tumble(),
        conveyor(),
        random_scene(3, 8),
        random_scene(7, 8),
        random_scene(8, 8),
        random_scene(29, 8),
    ];
    let undriven = |(def, overdetermined): (SceneDef, bool)| {
        let def = SceneDef { controls: Vec::new(), ..def };
        Told { def, duration: 0.5, overdetermined }
    };
    let enough = machines.into_iter().map(|def| (def, false));
    enough.chain(overdetermined.map(|def| (def, true))).map(undriven).collect()
}

pub(super) fn all() -> Vec<Told> {
    named().into_iter().chain(others()).collect()
}
