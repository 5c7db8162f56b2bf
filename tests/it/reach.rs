//! How far a step looks for contacts: as far as the bodies of a group can get, and no further.

use tangency::{BodyDef, JointDef, JointKind, SceneDef, State};
use tangency_bench::scenes::{block, disc, floor, material};

use crate::engine::{backends, built, first_step, run};

/// A disc of 10 g at 500 m/s.
fn bullet(position: [f64; 2], velocity: [f64; 2]) -> BodyDef {
    BodyDef { mass: Some(0.01), velocity, ..disc("bullet", 0.05, position) }
}

fn boxes(columns: usize, rows: usize) -> Vec<BodyDef> {
    let place = |i: usize| [1.2 * (i % columns) as f64, 0.5 + (i / columns) as f64];
    let each = |i| BodyDef { mass: Some(1.0), ..block(&format!("box{i}"), [1.0; 2], place(i)) };
    std::iter::once(floor()).chain((0..columns * rows).map(each)).collect()
}

#[test]
fn a_fast_body_far_away_adds_no_rows() {
    let resting = SceneDef { bodies: boxes(10, 10), ..SceneDef::default() };
    let mut visited = resting.clone();
    visited.bodies.push(bullet([0.0, 40.0], [500.0, 0.0]));
    for solver in backends() {
        let [alone, beside] = [&resting, &visited].map(|def| {
            let scene = built(def);
            first_step(&scene, &*solver).counts(&scene)
        });
        assert_eq!((alone.rows, alone.contacts), (400, 200));
        assert_eq!((beside.rows, beside.contacts), (400, 200));
        assert_eq!(beside.free_bodies, 1);
    }
}

/// Springs too weak to be felt make one group of all bodies, whose reach is the fastest body's.
fn in_one_group(def: &SceneDef) -> SceneDef {
    let dynamic: Vec<&BodyDef> = def.bodies.iter().filter(|b| b.name != "floor").collect();
    let spring = |pair: &[&BodyDef]| {
        let (anchor_a, anchor_b) = (pair[0].position, pair[1].position);
        let kind =
            JointKind::Spring { anchor_a, anchor_b, length: None, stiffness: 1e-12, damping: 0.0 };
        let bodies = [pair[0].name.clone(), pair[1].name.clone()];
        let name = format!("{} to {}", bodies[0], bodies[1]);
        JointDef { name, bodies, kind, collide: true, softness: None }
    };
    SceneDef { joints: dynamic.windows(2).map(spring).collect(), ..def.clone() }
}

#[test]
fn a_struck_stack_moves_as_if_all_were_within_reach_of_each_other() {
    let mut bodies = boxes(2, 4);
    bodies.push(bullet([-14.0, 1.3], [500.0, 0.0]));
    let def = material(SceneDef { bodies, ..SceneDef::default() }, 0.3, 0.5);
    let (scene, grouped) = (built(&def), built(&in_one_group(&def)));
    for solver in backends() {
        let [own, all] = [&scene, &grouped].map(|scene| run(scene, &*solver, 20));
        let counts = [own.records[0].counts(&scene), all.records[0].counts(&grouped)];
        assert!(counts[0].contacts < counts[1].contacts, "the bullet is still far away");
        for (own, all) in own.states().zip(all.states()) {
            let apart = |(x, y): (&nalgebra::Vector3<f64>, &nalgebra::Vector3<f64>)| (x - y).amax();
            let most = own.q.iter().zip(&all.q).map(apart).fold(0.0, f64::max);
            assert!(most < 1e-8, "{most} m at {} s", own.time);
        }
        assert!(own.states().any(|s| speed_of_boxes(s) > 1.0), "the bullet has struck");
        assert!(scene.penetration(own.last()).expect("contacts") < 1e-8);
    }
}

fn speed_of_boxes(state: &State) -> f64 {
    let boxes = &state.v[1..state.v.len() - 1];
    boxes.iter().map(|v| v.xy().norm()).fold(0.0, f64::max)
}
