//! Position errors: removed at a bounded rate, without adding energy, by every choice of
//! correction and in both contact models.

use tangency::{
    BodyDef, ContactModel, Correction, JointKind, LcpSolver, Rollout, Scene, SceneDef,
    Stabilisation, State, WORLD,
};
use tangency_bench::scenes::{
    block, disc, double_pendulum, floor, hinge, incline_block, material, parallelogram,
    race_cartpole, race_chain, rod,
};

use crate::engine::{backends, built, near, run, steps};

const VELOCITY: ContactModel = ContactModel::Velocity { contact_distance: 1e-3 };

/// A box that begins 0.1 m deep in the floor.
fn sunk(model: ContactModel, contacts: Correction) -> Scene {
    let bodies = vec![floor(), block("box", [1.0, 1.0], [0.0, 0.4])];
    let stabilisation = Stabilisation { contacts, ..Stabilisation::default() };
    let def = SceneDef { bodies, contact_model: model, stabilisation, ..SceneDef::default() };
    built(&material(def, 0.5, 0.0))
}

fn kinetic(scene: &Scene, state: &State) -> f64 {
    let one = |i: usize| 0.5 * state.v[i].dot(&scene.bodies()[i].mass.component_mul(&state.v[i]));
    (0..state.v.len()).map(one).sum()
}

/// Greatest change of a body's height in one step.
fn fastest(tape: &Rollout, body: usize) -> f64 {
    let states: Vec<&State> = tape.states().collect();
    let rise = |w: &[&State]| (w[1].q[body].y - w[0].q[body].y).abs();
    states.windows(2).map(rise).fold(0.0, f64::max)
}

#[test]
fn post_lifts_a_sunk_box_at_recovery_speed_without_energy() {
    for solver in backends() {
        for model in [ContactModel::Gap, VELOCITY] {
            let scene = sunk(model, Correction::Post);
            let tape = run(&scene, &*solver, 30);
            near("recovery speed", fastest(&tape, 1) / scene.dt(), 1.0, 1e-9);
            near("recovered", tape.last().q[1].y, 0.5, 1e-8);
            let worst = tape.states().map(|s| kinetic(&scene, s)).fold(0.0, f64::max);
            near("kinetic energy of the recovery", worst, 0.0, 1e-20);
        }
    }
}

#[test]
fn baumgarte_lifts_a_sunk_box_at_most_at_recovery_speed() {
    for solver in backends() {
        for model in [ContactModel::Gap, VELOCITY] {
            let scene = sunk(model, Correction::Baumgarte { fraction: 0.5 });
            let tape = run(&scene, &*solver, 100);
            near("recovery speed", fastest(&tape, 1) / scene.dt(), 1.0, 1e-6);
            near("recovered", tape.last().q[1].y, 0.5, 1e-2);
        }
    }
}

#[test]
fn none_leaves_a_sunk_box() {
    for solver in backends() {
        for model in [ContactModel::Gap, VELOCITY] {
            let tape = run(&sunk(model, Correction::None), &*solver, 30);
            near("left as it was", tape.last().q[1].y, 0.4, 1e-12);
        }
    }
}

/// A rod whose pin begins 0.05 m open, along the rod.
fn open_pin(joints: Correction) -> Scene {
    pin_open_by([0.05, 0.0], joints)
}

fn pin_open_by(gap: [f64; 2], joints: Correction) -> Scene {
    let mut pin = hinge("pin", WORLD, "rod", [0.0; 2]);
    if let JointKind::Revolute { anchor_b, .. } = &mut pin.kind {
        *anchor_b = Some(gap);
    }
    let bodies = vec![rod("rod", 1.0, 1.0, [0.55, 0.0], 0.0)];
    let stabilisation = Stabilisation { joints, ..Stabilisation::default() };
    let gravity = [0.0; 2];
    let joints = vec![pin];
    built(&SceneDef { gravity, bodies, joints, stabilisation, ..SceneDef::default() })
}

#[test]
fn post_closes_an_open_pin_at_recovery_speed_without_energy() {
    for solver in backends() {
        let scene = open_pin(Correction::Post);
        let tape = run(&scene, &*solver, 10);
        near("pin after one step", scene.joint_drift(tape.state(1)), 0.04, 1e-12);
        near("pin closed", scene.joint_drift(tape.last()), 0.0, 1e-12);
        near("pin, energy", kinetic(&scene, tape.last()), 0.0, 1e-20);
    }
}

/// Open across the rod, the pin turns it while it closes, which moves its end along by the square of the
/// turn. That is mended in the step; the way across stays at most the recovery speed, up to that square.
#[test]
fn post_turns_a_rod_at_recovery_speed() {
    for solver in backends() {
        let scene = pin_open_by([0.0, 0.05], Correction::Post);
        let tape = run(&scene, &*solver, 10);
        let end = |k: usize| {
            let q = tape.state(k).q[0];
            let (sin, cos) = q.z.sin_cos();
            [q.x - 0.55 * cos - 0.05 * sin, q.y - 0.55 * sin + 0.05 * cos]
        };
        assert!(tape.records[0].post.len() > 1, "the turn is mended");
        near("pin, along the rod", end(1)[0], 0.0, 1e-9);
        near("pin, across the rod", end(1)[1], 0.04, 1e-4);
        near("pin closed", scene.joint_drift(tape.last()), 0.0, 1e-9);
    }
}

/// Greatest joint error of a second, and the most displacements of a step.
fn drift(solver: &dyn LcpSolver, def: &SceneDef, dt: f64) -> (f64, usize) {
    let stabilisation = Stabilisation { joints: Correction::Post, ..def.stabilisation };
    let scene = built(&SceneDef { dt, stabilisation, ..def.clone() });
    let tape = run(&scene, solver, steps(1.0, dt));
    let worst = tape.states().map(|s| scene.joint_drift(s)).fold(0.0, f64::max);
    (worst, tape.records.iter().map(|r| r.post.len()).max().unwrap_or(0))
}

/// Digits double with every displacement, so that three are enough; also where rows depend on each
/// other (the parallelogram) and where a whipping end opens joints faster than the recovery speed. Long
/// chains stay nearly straight, which takes two more.
#[test]
fn post_leaves_no_joint_error() {
    let scenes = [
        race_chain(10),
        race_chain(50),
        race_chain(200),
        race_chain(1000),
        race_cartpole(),
        double_pendulum([2.5, 2.8]),
        parallelogram(3, 1.2),
        parallelogram(10, 1.2),
    ];
    for solver in backends() {
        for def in &scenes {
            for dt in [0.005, 1.0 / 60.0] {
                let (worst, most) = drift(&*solver, def, dt);
                near(&format!("{}, drift", def.name), worst, 0.0, 1e-9);
                assert!(
                    most <= if def.bodies.len() < 1000 { 3 } else { 5 },
                    "{}: {most} displacements in a step",
                    def.name
                );
            }
        }
    }
}

#[test]
fn baumgarte_closes_an_open_pin_by_its_fraction() {
    for solver in backends() {
        for fraction in [0.2, 1.0] {
            let scene = open_pin(Correction::Baumgarte { fraction });
            let tape = run(&scene, &*solver, 1);
            let left = 0.05 * (1.0 - fraction);
            near("pin after one step", scene.joint_drift(tape.last()), left, 1e-12);
        }
    }
}

#[test]
fn none_leaves_an_open_pin() {
    for solver in backends() {
        let scene = open_pin(Correction::None);
        let tape = run(&scene, &*solver, 10);
        near("pin left open", scene.joint_drift(tape.last()), 0.05, 1e-12);
    }
}

/// A falling disc lands and a block slides in the velocity model under every correction.
#[test]
fn velocity_model_under_every_correction() {
    let corrections = [Correction::None, Correction::Post, Correction::Baumgarte { fraction: 0.2 }];
    for solver in backends() {
        for contacts in corrections {
            let falling = disc("disc", 0.1, [0.0, 0.5]);
            let bodies = vec![floor(), BodyDef { mass: Some(1.0), ..falling }];
            check_velocity(&*solver, bodies, contacts, |tape| {
                near("velocity model, at rest", tape.last().v[1].y, 0.0, 1e-9);
                // It may sink by one step of the speed at which it struck.
                near("velocity model, depth", tape.last().q[1].y.min(0.1), 0.1, 0.03);
            });
        }
    }
}

fn check_velocity(
    solver: &dyn LcpSolver,
    bodies: Vec<BodyDef>,
    contacts: Correction,
    judge: impl Fn(&Rollout),
) {
    let def = SceneDef {
        bodies,
        contact_model: VELOCITY,
        stabilisation: Stabilisation { contacts, ..Stabilisation::default() },
        ..SceneDef::default()
    };
    judge(&run(&built(&material(def, 0.3, 0.0)), solver, 300));
}

/// V05 (a) in the velocity model: the same closed form.
#[test]
fn velocity_model_slides_as_the_gap_model() {
    let mut def = incline_block(30.0_f64.to_radians(), 0.5, 0.0);
    (def.dt, def.contact_model) = (1e-3, VELOCITY);
    for solver in backends() {
        let tape = run(&built(&def), &*solver, 1000);
        let d = tape.last().q[1] - tape.initial.q[1];
        near("V05 (a), velocity model", d.xy().norm(), 0.328_572_697_218_664_22, 0.5e-3);
    }
}
