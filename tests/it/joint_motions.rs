//! States that move with a joint, against the kinematics of two links and known derivatives of motions.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Vector2, Vector3};
use tangency::diff::JointMotionError;
use tangency::{
    JointDef, JointKind, Limits, Scene, SceneDef, SceneFormat, State, StateVector, Stepping, WORLD,
    gradient, joint_motion, parse_scene, simulate,
};
use tangency_bench::finite_difference::derivative;
use tangency_bench::scenes::{
    block, double_pendulum, hinge, parallelogram, pendulum, slider_crank, supported_rod,
    suspended_chain, unit_scene,
};

use crate::engine::{backends, built, near, near_relative, with_dt};

/// Two links of 1 m with the angles (φ₁, φ₁ + φ₂) from hanging and the rates of these: (φ₁, φ₂, ω₁, ω₂).
fn links([first, second, rate, relative]: [f64; 4]) -> State {
    let (angle, turning) = (first + second, rate + relative);
    let ([s1, c1], [s2, c2]) = ([first.sin(), first.cos()], [angle.sin(), angle.cos()]);
    let upper = Vector3::new(0.5 * s1, -0.5 * c1, first - FRAC_PI_2);
    let lower = Vector3::new(s1 + 0.5 * s2, -c1 - 0.5 * c2, angle - FRAC_PI_2);
    let v_upper = Vector3::new(0.5 * c1 * rate, 0.5 * s1 * rate, rate);
    let x = c1 * rate + 0.5 * c2 * turning;
    let y = s1 * rate + 0.5 * s2 * turning;
    State { time: 0.0, q: vec![upper, lower], v: vec![v_upper, Vector3::new(x, y, turning)] }
}

/// Every number of a state, one after the other.
fn numbers(state: &State) -> Vec<f64> {
    state.q.iter().chain(&state.v).flatten().copied().collect()
}

fn entries(vector: &StateVector) -> Vec<f64> {
    vector.q.iter().chain(&vector.v).flatten().copied().collect()
}

#[track_caller]
fn check(found: &StateVector, at: impl Fn(f64) -> State) {
    for (k, found) in entries(found).into_iter().enumerate() {
        let exact = derivative(|h| numbers(&at(h))[k], 0.0, 1e-2).value;
        near("a number of the state", found, exact, 1e-9);
    }
}

#[test]
fn two_links() {
    let start = [0.7, 0.4, 1.3, -2.1];
    let scene = built(&double_pendulum([start[0], start[0] + start[1]]));
    let state = links(start);
    for joint in 0..2 {
        let motion = joint_motion(&scene, &state, joint).expect("a tree");
        let changed = |k: usize| {
            move |h: f64| {
                let mut it = start;
                it[k] += h;
                links(it)
            }
        };
        check(&motion.coordinate, changed(joint));
        check(&motion.rate, changed(2 + joint));
    }
}

/// A slide on a turning arm: the body is at R(θ)(s, 0).
#[test]
fn slide_on_an_arm() {
    let at = |[angle, offset, turning, speed]: [f64; 4]| {
        let (sin, cos) = angle.sin_cos();
        let arm = Vector3::new(0.0, 0.0, angle);
        let place = Vector3::new(offset * cos, offset * sin, angle);
        let along = Vector3::new(speed * cos, speed * sin, 0.0);
        let v = along + Vector3::new(-place.y, place.x, 1.0) * turning;
        let v = vec![Vector3::new(0.0, 0.0, turning), v];
        State { time: 0.0, q: vec![arm, place], v }
    };
    let kind = JointKind::Prismatic {
        anchor: [0.0; 2],
        axis: [1.0, 0.0],
        limits: Limits::default(),
        motor: None,
    };
    let slide = JointDef {
        name: "slide".into(),
        bodies: ["arm".into(), "bead".into()],
        kind,
        ..hinge("", "", "", [0.0; 2])
    };
    let bodies = vec![block("arm", [1.0, 0.1], [0.0; 2]), block("bead", [0.1, 0.2], [0.0; 2])];
    let joints = vec![hinge("pin", WORLD, "arm", [0.0; 2]), slide];
    let scene = built(&SceneDef { joints, ..unit_scene("bead on an arm", bodies) });
    let start = [0.6, 0.8, 1.5, -0.4];
    let motions = [0, 1].map(|joint| joint_motion(&scene, &at(start), joint).expect("a tree"));
    for (k, motion) in motions.iter().enumerate() {
        let changed = |k: usize| {
            move |h: f64| {
                let mut it = start;
                it[k] += h;
                at(it)
            }
        };
        check(&motion.coordinate, changed(k));
        check(&motion.rate, changed(2 + k));
    }
}

/// V02: dφ(2)/dφ(0).
#[test]
fn swinging_pendulum() {
    for solver in backends() {
        let scene = built(&with_dt(pendulum(2.5), 2e-4));
        let tape = simulate(&scene, &*solver, 10_000).expect("a run");
        let seed = |k: usize, state: &State| {
            let mut seed = StateVector::like(state);
            seed.q[0].z = 1.0;
            (k == 10_000).then_some(seed)
        };
        let by = gradient(&scene, &tape, seed).expect("a gradient").by.initial;
        let motion = joint_motion(&scene, &tape.initial, 0).expect("a tree");
        let found = motion.coordinate.dot(&by);
        near_relative("V02", found, -8.067_354_362_055_703_3, 1e-2);
    }
}

/// V13: crank, rod and slider, by the crank's angle and rate, against where they are at other ones.
#[test]
fn slider_and_crank() {
    let (angle, rate) = (0.5, 10.0);
    let at = |angle, rate| built(&slider_crank(angle, rate)).initial_state();
    let scene = built(&slider_crank(angle, rate));
    let motion = joint_motion(&scene, &at(angle, rate), 0).expect("one way to move");
    check(&motion.coordinate, |h| at(angle + h, rate));
    check(&motion.rate, |h| at(angle, rate + h));
}

/// Redundant rows: three cranks on one coupler, by each of them.
#[test]
fn three_cranks() {
    let at = |angle| built(&parallelogram(3, angle)).initial_state();
    let scene = built(&parallelogram(3, 1.2));
    for pin in ["pin0", "pin1", "pin2"] {
        let joint = scene.joint_index(pin).expect("a pin");
        let motion = joint_motion(&scene, &at(1.2), joint).expect("one way to move");
        check(&motion.coordinate, |h| at(1.2 + h));
    }
}

/// The poses of scenes/four_bar.toml at an angle of the crank, where circles around the crank's end and the
/// pivot meet.
fn four_bar(angle: f64) -> Vec<Vector3<f64>> {
    let pin = Vector2::new(angle.cos(), angle.sin()) * 0.3;
    let pivot = Vector2::new(1.0, 0.0);
    let (across, [coupler, rocker]) = (pivot - pin, [1.0, 0.6]);
    let distance = across.norm();
    let along = (distance * distance + coupler * coupler - rocker * rocker) / (2.0 * distance);
    let u = across / distance;
    let up = Vector2::new(-u.y, u.x) * (coupler * coupler - along * along).sqrt();
    let end = pin + u * along + up;
    let rod = |from: Vector2<f64>, to: Vector2<f64>| {
        let (middle, d) = ((from + to) / 2.0, to - from);
        Vector3::new(middle.x, middle.y, d.y.atan2(d.x))
    };
    vec![rod(Vector2::zeros(), pin), rod(pin, end), rod(pivot, end)]
}

#[test]
fn four_bars() {
    let text = include_str!("../../scenes/four_bar.toml");
    let scene = built(&parse_scene(text, SceneFormat::Toml).expect("a scene"));
    let state = scene.initial_state();
    for (q, exact) in state.q.iter().zip(four_bar(FRAC_PI_2)) {
        near("pose of a bar", (q - exact).amax(), 0.0, 1e-9);
    }
    let slopes = |k: usize| {
        let entry = |h: f64| four_bar(FRAC_PI_2 + h).iter().flatten().copied().nth(k);
        derivative(|h| entry(h).expect("a number"), 0.0, 1e-2).value
    };
    let by = |joint: &str| {
        let joint = scene.joint_index(joint).expect("a joint");
        joint_motion(&scene, &state, joint).expect("one way to move").coordinate
    };
    let (crank, rocker) = (by("motor"), by("pivot"));
    for (k, found) in crank.q.iter().flatten().enumerate() {
        near("a number of a bar", *found, slopes(k), 1e-9);
    }
    near("turn of the crank by the rocker's", rocker.q[0].z, 1.0 / slopes(8), 1e-9);
}

/// V12: d angle(3)/d angle(0), at rest 1.2 rad from hanging.
#[test]
fn swinging_cranks() {
    let known = [(2, -0.909_438_091_648_851_21), (3, -1.238_721_895_752_345_6)];
    for (n, exact) in known {
        let stepping = Stepping::Accurate { max_events: 32 };
        let scene = built(&SceneDef { stepping, ..with_dt(parallelogram(n, 1.2), 5e-3) });
        for solver in backends() {
            let tape = simulate(&scene, &*solver, 600).expect("a run");
            let seed = |k: usize, state: &State| {
                let mut seed = StateVector::like(state);
                seed.q[0].z = 1.0;
                (k == 600).then_some(seed)
            };
            let by = gradient(&scene, &tape, seed).expect("a gradient").by.initial;
            let motion = joint_motion(&scene, &tape.initial, 0).expect("one way to move");
            near_relative("V12", motion.coordinate.dot(&by), exact, 1e-6);
        }
    }
}

#[test]
fn what_does_not_move_by_itself() {
    let refused = |def: &SceneDef, joint| {
        let scene: Scene = built(def);
        joint_motion(&scene, &scene.initial_state(), joint).expect_err("refused")
    };
    // Ten rods between two walls: 30 numbers, 22 rows, one more for the joint.
    let chain = suspended_chain(8.0);
    assert_eq!(refused(&chain, 0), JointMotionError::NotUnique { joint: 0, ways: 7 });
    assert_eq!(refused(&supported_rod(true), 0), JointMotionError::Blocked { joint: 0 });
    let count = chain.joints.len();
    assert_eq!(refused(&chain, 20), JointMotionError::NoSuchJoint { joint: 20, count });
    let mut welded = pendulum(1.0);
    welded.joints[0].kind = JointKind::Weld { anchor: [0.0; 2] };
    assert_eq!(refused(&welded, 0), JointMotionError::NothingFree { joint: 0 });
}
