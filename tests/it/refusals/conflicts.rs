//! Constraints that contradict each other.

use tangency::{BodyDef, BodyKind, JointDef, JointKind, Limits, Motor, SceneDef, StepError, WORLD};
use tangency_bench::scenes::{block, fixed_block, hinge, pendulum, plane, rod};

use crate::engine::{backends, built};

/// V30: constraints that contradict each other are told from hard ones, and never accepted.
#[track_caller]
fn check_infeasible(def: &SceneDef, body: &str) {
    let scene = built(def);
    for solver in backends() {
        let result = tangency::simulate(&scene, &*solver, 5);
        match result.expect_err("conflicting constraints") {
            StepError::Lcp { bodies, source, .. } => {
                assert_eq!(bodies, body);
                assert!(
                    matches!(source, tangency::lcp::LcpError::Infeasible { residual } if residual > 1e-6),
                    "{source}"
                );
            }
            other => panic!("{other}"),
        }
    }
}

#[test]
fn v30_rod_pinned_at_two_points_too_far_apart() {
    let mut def = SceneDef {
        bodies: vec![rod("rod", 1.0, 1.0, [0.5, 0.0], 0.0)],
        joints: vec![
            hinge("left", WORLD, "rod", [0.0; 2]),
            hinge("right", WORLD, "rod", [1.5, 0.0]),
        ],
        ..SceneDef::default()
    };
    if let JointKind::Revolute { anchor_b, .. } = &mut def.joints[1].kind {
        *anchor_b = Some([1.0, 0.0]);
    }
    check_infeasible(&def, "rod");
}

#[test]
fn v30_piston_against_a_wall() {
    let piston = BodyDef {
        kind: BodyKind::Kinematic,
        velocity: [1.0, 0.0],
        ..block("piston", [0.2, 1.0], [-0.6, 0.5])
    };
    let bodies = vec![
        piston,
        block("box", [1.0, 1.0], [0.0, 0.5]),
        fixed_block("wall", [0.2, 2.0], [0.6, 0.5]),
        plane("floor", [0.0, 1.0], 0.0),
    ];
    check_infeasible(&SceneDef { bodies, ..SceneDef::default() }, "box");
}

#[test]
fn v30_motors_that_disagree() {
    let mut def = pendulum(1.0);
    let motor = |speed| Some(Motor { speed, max: None });
    let pin = |name: &str, speed| {
        let kind = JointKind::Revolute {
            anchor: [0.0; 2],
            anchor_b: None,
            limits: Limits::default(),
            motor: motor(speed),
        };
        JointDef { kind, ..hinge(name, WORLD, "rod", [0.0; 2]) }
    };
    def.joints = vec![pin("one", 1.0), pin("two", 2.0)];
    check_infeasible(&def, "rod");
}
