//! Untracked.
use tangency::{Scene, StepScratch, step};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let seed: u64 = a[1].parse().unwrap();
    let steps: usize = a[2].parse().unwrap();
    let n = 1 + (seed as usize * 7919) % 30;
    let def = tangency_bench::random_scene(seed, n);
    let scene = Scene::new(&def).unwrap();
    let solver = tangency::backend("ipm").unwrap();
    let mut state = scene.initial_state();
    println!("dt {}", def.dt);
    for k in 0..=steps {
        match step(&scene, &*solver, &state, &[], &mut StepScratch::default()) {
            Ok(r) => {
                state = r.after.clone();
                println!(
                    "{k} drift {:.2e} pen {:.2e} {:?}",
                    scene.joint_drift(&state),
                    scene.penetration(&state).unwrap_or(9.0),
                    r.counts(&scene)
                );
                for i in r.islands.iter().chain(r.post.iter().flat_map(|p| &p.islands)) {
                    if i.stage != tangency::core::row::Stage::Velocity
                        && i.stage != tangency::core::row::Stage::Post
                    {
                        println!(
                            "   {:?} {:?}",
                            i.stage,
                            i.bodies
                                .iter()
                                .map(|b| &def.bodies[*b as usize].name)
                                .collect::<Vec<_>>()
                        );
                    }
                }
            }
            Err(e) => {
                println!("{k} {e}");
                for j in 0..scene.joints().len() {
                    let p = scene.joint_poses(j, &state.q);
                    let jt = &scene.joints()[j];
                    for h in &jt.held {
                        let m =
                            h.measure.evaluate([&p[0], &p[1]], [&jt.anchors[0], &jt.anchors[1]]);
                        if (m.value - h.reference).abs() > 1e-6 {
                            println!(
                                "  joint {j} {:?} {:?} err {:.3e}",
                                jt.name,
                                def.joints[j].bodies,
                                m.value - h.reference
                            );
                        }
                    }
                }
                break;
            }
        }
    }
}
