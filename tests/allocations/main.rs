//! Stepping allocates nothing once its memory has grown: counted by a global allocator, and therefore a
//! program of its own.

use allocation_counter::measure;
use tangency::{Scene, SceneDef, Simulator, default_solver};
use tangency_bench::scenes;

/// Steps until memory has grown and contacts persist, and steps counted.
const BEFORE: usize = 200;
const COUNTED: usize = 100;

/// The number of allocations in the counted steps.
fn allocations(def: &SceneDef) -> u64 {
    let (scene, solver) = (Scene::new(def).expect("a valid scene"), default_solver());
    let control = vec![0.0; scene.controls().len()];
    let mut simulator = Simulator::new(&scene, &*solver);
    for _ in 0..BEFORE {
        simulator.step(&control).expect("a step");
    }
    let steps = || {
        for _ in 0..COUNTED {
            simulator.step(&control).expect("a step");
        }
    };
    measure(steps).count_total
}

#[test]
fn joints_flights_and_lasting_contacts_allocate_nothing() {
    let scenes = [
        scenes::free_flight(),
        scenes::race_chain(10),
        scenes::race_chain(300),
        scenes::race_cartpole(),
        scenes::race_stack(10),
        scenes::sliding_box(1.0, 0.3, 30.0),
        scenes::pyramid(10),
        scenes::incline_disc(0.5),
    ];
    for def in scenes {
        assert_eq!(allocations(&def), 0, "{}", def.name);
    }
}

/// What the counter would see of a step that builds everything anew.
#[test]
fn a_first_step_is_counted() {
    let (scene, solver) = (Scene::new(&scenes::race_stack(10)).expect("valid"), default_solver());
    let counted = measure(|| {
        Simulator::new(&scene, &*solver).step(&[]).expect("a step");
    });
    assert!(counted.count_total > 50, "{counted:?}");
}
