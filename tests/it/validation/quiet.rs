//! V24 Grazing, V29 Quiet contact.

use tangency::{BodyDef, Scene, SceneDef};
use tangency_bench::scenes::{
    block, disc, fixed_block, floor, material, plane, sliding_box, stack, unit_scene,
};

use crate::engine::{backends, built, first_step, near, run};

#[test]
fn v24_grazing() {
    for solver in backends() {
        for gap in [0.0, 1e-12, -1e-12] {
            let passing = BodyDef { velocity: [5.0, 0.0], ..disc("disc", 0.1, [0.0, 0.1 + gap]) };
            let scene = material(unit_scene("grazing", vec![floor(), passing]), 0.5, 1.0);
            for record in run(&built(&scene), &*solver, 20).records {
                let worst = record.contact_impulses().iter().map(|i| i.normal).fold(0.0, f64::max);
                near("V24 grazing impulse", worst, 0.0, 1e-9);
            }
        }
    }
}

/// `SceneDef` with gravity.
fn on_floor(body: BodyDef, friction: f64, restitution: f64) -> SceneDef {
    let def = SceneDef { bodies: vec![floor(), body], ..SceneDef::default() };
    material(def, friction, restitution)
}

#[test]
fn v29_rest_with_full_restitution() {
    for solver in backends() {
        let scene = built(&on_floor(disc("disc", 0.1, [0.0, 0.1]), 0.0, 1.0));
        let tape = run(&scene, &*solver, 1000);
        let worst = tape.states().map(|s| s.v[1].norm()).fold(0.0, f64::max);
        near("V29 disc at rest, e=1", worst, 0.0, 1e-12);
    }
}

/// A fast disc far away widens the reach, so that the slow one's contact is modelled.
#[test]
fn v29_no_force_at_a_distance() {
    for solver in backends() {
        for (e, far) in [(0.0, 0.0), (0.5, 0.0), (0.0, 50.0), (0.5, 50.0), (1.0, 50.0)] {
            let slow = BodyDef { velocity: [0.0, -0.01], ..disc("disc", 0.1, [0.0, 0.15]) };
            let fast = BodyDef { velocity: [far, 0.0], ..disc("fast", 0.1, [50.0, 9.0]) };
            let def = material(unit_scene("approach", vec![floor(), slow, fast]), 0.0, e);
            let record = first_step(&built(&def), &*solver);
            assert_eq!(record.contacts.is_empty(), far == 0.0, "contacts in reach");
            near("V29 speed unchanged", record.after.v[1].y, -0.01, 1e-17);
            assert!(record.contact_impulses().is_empty(), "V29 impulse exactly 0");
        }
    }
}

#[test]
fn v29_sliding_block_neither_sinks_nor_hops() {
    for solver in backends() {
        let scene = built(&sliding_box(1.0, 0.5, 3.0));
        let tape = run(&scene, &*solver, 100);
        let worst = tape.states().map(|s| (s.q[1].y - 0.1).abs()).fold(0.0, f64::max);
        near("V29 gap of a sliding block", worst, 0.0, 1e-9);
    }
}

/// A box crosses the common edge of two static boxes at 2 m/s.
fn seam() -> Scene {
    let left = fixed_block("left", [2.0, 0.5], [-1.0, -0.25]);
    let right = fixed_block("right", [2.0, 0.5], [1.0, -0.25]);
    let slider = BodyDef { velocity: [2.0, 0.0], ..block("box", [0.4, 0.2], [-0.7, 0.1]) };
    let def = SceneDef { bodies: vec![left, right, slider], ..SceneDef::default() };
    built(&material(def, 0.0, 0.0))
}

#[test]
fn v29_seam() {
    for solver in backends() {
        let tape = run(&seam(), &*solver, 70);
        assert!(tape.last().q[2].x > 0.6, "it has crossed");
        for state in tape.states() {
            near("V29 seam, speed", state.v[2].x, 2.0, 1e-12);
            near("V29 seam, turn", state.q[2].z, 0.0, 1e-12);
        }
    }
}

#[test]
fn v29_corner() {
    for solver in backends() {
        let wall = plane("wall", [-1.0, 0.0], -1.0); // solid where x >= 1
        let moving = BodyDef { velocity: [2.0, -1.0], ..block("box", [0.5, 0.5], [0.75, 0.25]) };
        let def = material(unit_scene("corner", vec![floor(), wall, moving]), 0.0, 0.0);
        let after = first_step(&built(&def), &*solver).after;
        near("V29 corner", after.v[2].norm(), 0.0, 1e-12);
    }
}

#[test]
fn v29_stack_of_three_for_long() {
    for solver in backends() {
        let scene = built(&stack(&[1.0, 1.0, 1.0]));
        let tape = run(&scene, &*solver, 20_000);
        let drift = |i: usize| (tape.last().q[i] - tape.initial.q[i]).norm();
        let worst = (1..4).map(drift).fold(0.0, f64::max);
        near("V29 drift of a stack, 20000 steps", worst, 0.0, 1e-9);
    }
}
