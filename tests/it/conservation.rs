//! What a scene without outside influence keeps: momentum, energy, symmetry.

use nalgebra::Vector3;
use tangency::{BodyDef, SceneDef, State};
use tangency_bench::scenes::{block, disc, fixed_block, floor, material, unit_scene};

use crate::engine::{backends, built, near, run};

/// Twelve discs of unlike sizes and masses that fly through each other's middle.
fn swarm(friction: f64, restitution: f64) -> SceneDef {
    let body = |i: u32| {
        let (sin, cos) = (f64::from(i) * 0.524).sin_cos();
        let far = 1.0 + 0.1 * f64::from(i % 3);
        BodyDef {
            mass: Some(0.5 + 0.3 * f64::from(i)),
            velocity: [-2.0 * cos + 0.3 * sin, -2.0 * sin],
            angular_velocity: f64::from(i) - 5.0,
            ..disc(&format!("d{i}"), 0.1 + 0.01 * f64::from(i), [far * cos, far * sin])
        }
    };
    let def = unit_scene("swarm", (0..12).map(body).collect());
    material(def, friction, restitution)
}

#[test]
fn momentum_of_colliding_discs() {
    for solver in backends() {
        for (friction, restitution) in [(0.0, 1.0), (0.5, 0.5), (0.9, 0.0)] {
            let scene = built(&swarm(friction, restitution));
            let tape = run(&scene, &*solver, 150);
            let met = tape.records.iter().map(|r| r.contact_impulses().len()).sum::<usize>();
            assert!(met >= 10, "only {met} impulses: the swarm must collide");
            let before = scene.total_momentum(&tape.initial);
            for state in tape.states() {
                let off = (scene.total_momentum(state) - before).amax();
                assert!(off <= 1e-12 * 60.0, "momentum of a swarm changed by {off:e}");
            }
            let off = (scene.total_momentum(tape.last()) - before).amax();
            near("momentum of a swarm", off, 0.0, 1e-12 * 60.0);
        }
    }
}

#[test]
fn linear_momentum_of_colliding_boxes() {
    let spinning = |name: &str, x: f64, v: f64, w: f64| BodyDef {
        velocity: [v, 0.1 * v],
        angular_velocity: w,
        mass: Some(1.0 + x * x),
        ..block(name, [0.6, 0.3], [x, 0.05 * x])
    };
    let bodies = vec![spinning("a", -1.0, 2.0, 3.0), spinning("b", 0.1, -1.0, -5.0)];
    let scene = built(&material(unit_scene("boxes", bodies), 0.4, 0.3));
    for solver in backends() {
        let tape = run(&scene, &*solver, 150);
        assert!(tape.records.iter().any(|r| !r.contact_impulses().is_empty()), "they collide");
        let change = scene.total_momentum(tape.last()) - scene.total_momentum(&tape.initial);
        near("linear momentum of boxes", change.xy().amax(), 0.0, 1e-12);
    }
}

/// Discs in a closed room without friction.
fn room(restitution: f64) -> SceneDef {
    let mut def = swarm(0.0, restitution);
    for (name, size, at) in [
        ("left", [0.5, 6.0], [-2.0, 0.0]),
        ("right", [0.5, 6.0], [2.0, 0.0]),
        ("low", [6.0, 0.5], [0.0, -2.0]),
        ("high", [6.0, 0.5], [0.0, 2.0]),
    ] {
        def.bodies.push(fixed_block(name, size, at));
    }
    material(def, 0.0, restitution)
}

#[test]
fn energy_never_grows_without_friction() {
    for solver in backends() {
        for restitution in [0.0, 0.5, 0.9, 1.0] {
            let scene = built(&room(restitution));
            let tape = run(&scene, &*solver, 400);
            let energies: Vec<f64> = tape.states().map(|s| scene.energy(s)).collect();
            let growth = energies.windows(2).map(|e| e[1] - e[0]).fold(0.0, f64::max);
            near("energy growth in a step", growth, 0.0, 1e-12 * energies[0]);
        }
    }
}

/// The mirror image: x, angle and what belongs to them change sign.
fn mirrored(mut def: SceneDef) -> SceneDef {
    for body in &mut def.bodies {
        body.position[0] *= -1.0;
        body.velocity[0] *= -1.0;
        body.angle *= -1.0;
        body.angular_velocity *= -1.0;
    }
    def
}

#[test]
fn a_mirrored_scene_moves_as_the_mirror_image() {
    let tumbling = BodyDef {
        velocity: [1.5, -1.0],
        angle: 0.3,
        angular_velocity: 2.0,
        ..block("box", [0.5, 0.3], [-0.4, 0.5])
    };
    let standing = block("post", [0.2, 0.6], [0.6, 0.3]);
    let bodies = vec![floor(), tumbling, standing, disc("ball", 0.15, [1.1, 0.15])];
    let def = SceneDef { bodies, ..SceneDef::default() };
    let def = material(def, 0.4, 0.3);
    for solver in backends() {
        let image = |state: &State| -> Vec<Vector3<f64>> {
            let flip = Vector3::new(-1.0, 1.0, -1.0);
            state.q.iter().chain(&state.v).map(|x| x.component_mul(&flip)).collect()
        };
        let one = run(&built(&def), &*solver, 60);
        let two = run(&built(&mirrored(def.clone())), &*solver, 60);
        for (one, two) in one.states().zip(two.states()) {
            let two: Vec<_> = two.q.iter().chain(&two.v).copied().collect();
            let off = image(one).iter().zip(&two).map(|(a, b)| (a - b).amax()).fold(0.0, f64::max);
            assert!(off <= 1e-9, "mirror image off by {off:e} at {}", one.time);
        }
    }
}
