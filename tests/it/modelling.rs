//! A step models only what the scene needs, and `inspect` says the same as the step's record.

use tangency::lcp::Law;
use tangency::{
    BodyDef, ContactImpulse, Counts, JointKind, Limits, Path, Scene, SceneDef, State, StepRecord,
    WORLD, inspect,
};
use tangency_bench::scenes::{
    block, chain, copies, disc, fixed_block, floor, free_flight, material, pendulum, pyramid, rod,
    sliding_box, soft_bridge, stack, unit_scene,
};

use crate::engine::{backends, built, first_step, near, run};

/// Every number of `inspect` against the record of the step from the same state.
#[track_caller]
fn check_inspection(scene: &Scene, state: &State, record: &StepRecord) -> Counts {
    let seen = inspect(scene, state).expect("a state that was stepped from");
    let counts = record.counts(scene);
    assert_eq!(seen.free_bodies.len(), counts.free_bodies);
    assert_eq!(seen.islands.len(), record.islands.len());
    for (seen, island) in seen.islands.iter().zip(&record.islands) {
        let names = island.bodies.iter().map(|b| &scene.bodies()[*b as usize].name);
        assert!(names.eq(&seen.bodies));
        assert_eq!(seen.path, island.path);
        let number =
            |law: fn(&Law) -> bool| island.problem.rows.iter().filter(|row| law(&row.law)).count();
        assert_eq!(seen.equality_rows, number(|law| *law == Law::Equality));
        assert_eq!(seen.motor_rows, number(|law| matches!(law, Law::Bounded { .. })));
        assert_eq!(seen.friction_rows, number(|law| matches!(law, Law::Friction { .. })));
        let unilateral = number(|law| *law == Law::Unilateral);
        assert_eq!(seen.limit_rows + seen.contact_rows, unilateral);
    }
    counts
}

#[track_caller]
fn counted(def: &SceneDef) -> Counts {
    let mut last = None;
    for solver in backends() {
        let scene = built(def);
        let record = first_step(&scene, &*solver);
        last = Some(check_inspection(&scene, &scene.initial_state(), &record));
    }
    last.expect("at least one backend")
}

#[test]
fn free_flight_is_closed_form() {
    let counts = counted(&free_flight());
    assert_eq!(counts, Counts { free_bodies: 1, ..Counts::default() });
}

#[test]
fn joints_alone_are_one_linear_solve() {
    for def in [pendulum(1.0), chain(10, 0.2, 0.1)] {
        let counts = counted(&def);
        assert_eq!((counts.linear_islands, counts.lcp_islands, counts.iterations), (1, 0, 0));
        assert_eq!(counts.rows, 2 * def.joints.len());
    }
}

#[test]
fn a_contact_has_one_unknown_without_friction_and_two_with_it() {
    let slider = |friction| counted(&sliding_box(1.0, friction, 1.0));
    assert_eq!((slider(0.0).contacts, slider(0.0).rows), (2, 2));
    assert_eq!((slider(0.3).contacts, slider(0.3).rows), (2, 4));
}

/// Only the contact that needs friction has it.
#[test]
fn friction_only_where_it_is_needed() {
    let mut bodies = vec![floor(), block("rough", [0.4, 0.2], [0.0, 0.1])];
    bodies.push(BodyDef { friction: 0.0, ..block("smooth", [0.4, 0.2], [1.0, 0.1]) });
    let counts = counted(&SceneDef { bodies, ..SceneDef::default() });
    assert_eq!((counts.contacts, counts.rows), (4, 6));
}

#[test]
fn static_bodies_have_no_unknowns() {
    let far = |i: u32| fixed_block(&format!("wall{i}"), [0.1, 0.1], [f64::from(i) + 5.0, 0.0]);
    let mut def = sliding_box(1.0, 0.3, 1.0);
    def.bodies.extend((0..50).map(far));
    let scene = built(&def);
    for solver in backends() {
        let record = first_step(&scene, &*solver);
        let counts = check_inspection(&scene, &scene.initial_state(), &record);
        assert_eq!((counts.contacts, counts.rows), (2, 4));
        assert_eq!(record.islands[0].bodies, [1]);
        assert_eq!(record.islands[0].problem.mass.len(), 1);
    }
}

/// A limit has a row only when it is in reach.
#[test]
fn limits_out_of_reach_have_no_row() {
    for (upper, rows, path) in [(1.0, 2, Path::Linear), (1e-4, 3, Path::Complementarity)] {
        let mut def = pendulum(0.5);
        let limits = Limits { lower: None, upper: Some(upper) };
        def.joints[0].kind =
            JointKind::Revolute { anchor: [0.0; 2], anchor_b: None, limits, motor: None };
        def.bodies[0].angular_velocity = 1.0;
        def.bodies[0].velocity = [0.5 * 0.5_f64.cos(), 0.5 * 0.5_f64.sin()];
        for solver in backends() {
            let record = first_step(&built(&def), &*solver);
            assert_eq!(record.islands[0].sources.len(), rows, "upper limit {upper}");
            assert_eq!(record.islands[0].path, path);
        }
    }
}

#[test]
fn bodies_apart_are_separate_islands() {
    let bodies = vec![
        floor(),
        block("a", [1.0, 1.0], [0.0, 0.5]),
        block("b", [1.0, 1.0], [5.0, 0.5]),
        block("on b", [1.0, 1.0], [5.0, 1.5]),
        disc("flying", 0.2, [10.0, 8.0]),
    ];
    let def = SceneDef { bodies, ..SceneDef::default() };
    let counts = counted(&def);
    assert_eq!((counts.lcp_islands, counts.free_bodies), (2, 1));
    let scene = built(&def);
    let seen = inspect(&scene, &scene.initial_state()).expect("a state");
    assert_eq!(seen.islands[1].bodies, ["b", "on b"]);
    assert_eq!((seen.dynamic_bodies, seen.other_bodies), (4, 1));
}

#[test]
fn what_opens_leaves_the_model() {
    let rising = BodyDef { velocity: [0.0, 3.0], ..disc("disc", 0.1, [0.0, 0.1]) };
    let def = material(unit_scene("rising", vec![floor(), rising]), 0.5, 0.0);
    let scene = built(&def);
    for solver in backends() {
        let tape = run(&scene, &*solver, 30);
        let last = tape.records.last().expect("steps");
        let counts = check_inspection(&scene, tape.state(29), last);
        assert_eq!(counts, Counts { free_bodies: 1, ..Counts::default() });
    }
}

/// 32 distant copies are 32 islands; each moves bit by bit as the first.
#[test]
fn distant_copies() {
    let mut bodies = Vec::new();
    let mut joints = Vec::new();
    for i in 0..32 {
        // Far apart along y, where nothing in these scenes depends on the place: x stays exact.
        let name = format!("rod{i}");
        bodies.push(rod(&name, 1.0, 1.0, [0.5, 64.0 * f64::from(i)], 0.0));
        joints.push(tangency_bench::scenes::hinge(
            &format!("pin{i}"),
            WORLD,
            &name,
            [0.0, 64.0 * f64::from(i)],
        ));
    }
    let scene = built(&SceneDef { bodies, joints, ..SceneDef::default() });
    for solver in backends() {
        let tape = run(&scene, &*solver, 1);
        assert_eq!(tape.records[0].islands.len(), 32);
        let first = tape.last().v[0];
        assert!(tape.last().v.iter().all(|v| *v == first), "the copies differ");
    }
}

#[test]
fn distant_stacks() {
    let def = copies(&stack(&[1.0, 2.0, 0.5]), 32, 64.0);
    let scene = built(&def);
    for solver in backends() {
        let tape = run(&scene, &*solver, 100);
        assert_eq!(tape.records[0].islands.len(), 32);
        for state in tape.states() {
            for (i, v) in state.v[1..].iter().enumerate() {
                assert_eq!(*v, state.v[1 + i % 3], "copy {} moves on its own", i / 3);
            }
        }
    }
}

/// A pyramid at rest in short steps: what its rows know of its gaps, to the last digit, contradicts itself the
/// more the shorter a step is, but no backend has to be asked; the floor carries its weight.
#[test]
fn short_steps_of_a_pile_at_rest() {
    let boxes = 55;
    let scene = built(&SceneDef { dt: 1e-3, ..pyramid(10) });
    for solver in backends() {
        let tape = run(&scene, &*solver, 150);
        let late = &tape.records[50..];
        let asked: usize = late.iter().map(|record| record.counts(&scene).iterations).sum();
        assert!(asked < late.len(), "{asked} iterations in {} steps", late.len());
        let floor = |record: &StepRecord| -> f64 {
            let on_floor =
                |it: &ContactImpulse| record.contacts[it.contact].feature.id.bodies[0] == 0;
            let all = record.contact_impulses();
            all.iter().filter(|it| on_floor(it)).map(|it| it.normal * it.direction.y).sum()
        };
        let weight = f64::from(boxes) * 9.81 * scene.dt();
        for record in late {
            near("floor", floor(record), weight, 1e-8 * weight);
        }
    }
}

#[test]
fn inspection_of_a_busy_scene() {
    let scene = built(&soft_bridge(6));
    for solver in backends() {
        let tape = run(&scene, &*solver, 120);
        for (k, record) in tape.records.iter().enumerate() {
            check_inspection(&scene, tape.state(k), record);
        }
    }
}

#[test]
fn inspection_reads_as_text() {
    let scene = built(&stack(&[1.0]));
    let text = inspect(&scene, &scene.initial_state()).expect("a state").to_string();
    assert!(
        text.contains(
            "complementarity problem: 0 equality, 0 motor, 0 limit, 2 contact, 2 friction rows"
        ),
        "{text}"
    );
}
