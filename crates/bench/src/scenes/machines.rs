//! Small machines: between them they use every kind of joint, motor, limit, spring, force and
//! control.

use tangency_core::{
    BodyDef, BodyKind, ControlDef, ControlInput, ForceDef, JointDef, JointKind, Limits, Motor,
    SceneDef, Shape, Softness, WORLD,
};

use super::bodies::{block, disc, floor, hinge, material, rod};

fn joint(name: &str, a: &str, b: &str, kind: JointKind) -> JointDef {
    JointDef {
        name: name.into(),
        bodies: [a.into(), b.into()],
        kind,
        collide: false,
        softness: None,
    }
}

fn control(name: &str, input: ControlInput) -> ControlDef {
    ControlDef { name: name.into(), input }
}

/// Two rods on a driven shoulder and an elbow with a weak motor and a limit; torque and motor
/// speed are controls.
#[must_use]
pub fn motor_arm() -> SceneDef {
    let bodies =
        vec![rod("upper", 1.0, 1.0, [0.5, 0.0], 0.0), rod("lower", 0.8, 0.6, [1.4, 0.0], 0.0)];
    let motor = |speed, max| Some(Motor { speed, max });
    let limits = Limits { lower: None, upper: Some(0.15) };
    let revolute =
        |x, limits, motor| JointKind::Revolute { anchor: [x, 0.0], anchor_b: None, limits, motor };
    let joints = vec![
        joint("shoulder", WORLD, "upper", revolute(0.0, Limits::default(), motor(1.5, None))),
        joint("elbow", "upper", "lower", revolute(1.0, limits, motor(2.0, Some(0.3)))),
    ];
    let controls = vec![
        control("speed", ControlInput::MotorSpeed { joint: "shoulder".into() }),
        control("twist", ControlInput::JointForce { joint: "elbow".into() }),
        control("torque", ControlInput::Torque { body: "lower".into() }),
    ];
    SceneDef { name: "motor arm".into(), bodies, joints, controls, ..SceneDef::default() }
}

/// The [`motor_arm`] with its elbow 0.3 rad below a lower limit at the start.
#[must_use]
pub fn bent_arm() -> SceneDef {
    let mut def = motor_arm();
    if let JointKind::Revolute { limits, .. } = &mut def.joints[1].kind {
        *limits = Limits { lower: Some(0.3), upper: None };
    }
    SceneDef { name: "bent arm".into(), ..def }
}

/// A mass on a rail between spring and stop, another hung from it by a distance joint; pushed by
/// a force in a window of time.
#[must_use]
pub fn spring_cart() -> SceneDef {
    let bodies = vec![
        BodyDef { mass: Some(1.2), ..block("cart", [0.4, 0.2], [0.0, 0.0]) },
        BodyDef { mass: Some(0.5), ..disc("bob", 0.1, [0.3, -0.8]) },
    ];
    let limits = Limits { lower: Some(-0.05), upper: None };
    let joints = vec![
        joint(
            "rail",
            WORLD,
            "cart",
            JointKind::Prismatic { anchor: [0.0; 2], axis: [1.0, 0.1], limits, motor: None },
        ),
        joint(
            "spring",
            WORLD,
            "cart",
            JointKind::Spring {
                anchor_a: [-1.0, 0.0],
                anchor_b: [-0.2, 0.05],
                length: Some(0.7),
                stiffness: 40.0,
                damping: 1.5,
            },
        ),
        joint(
            "string",
            "cart",
            "bob",
            JointKind::Distance { anchor_a: [0.1, -0.1], anchor_b: [0.3, -0.75], length: None },
        ),
    ];
    let forces = vec![ForceDef {
        body: "bob".into(),
        force: [0.8, 0.4],
        torque: 0.02,
        start: Some(0.013),
        end: Some(0.147),
    }];
    let controls = vec![control("push", ControlInput::ForceX { body: "cart".into() })];
    SceneDef { name: "spring cart".into(), bodies, joints, forces, controls, ..SceneDef::default() }
}

/// Planks hinged softly between two posts, a disc rolling over them.
#[must_use]
pub fn soft_bridge(planks: usize) -> SceneDef {
    let length = 0.5;
    let mut bodies = Vec::new();
    let mut joints = Vec::new();
    for i in 0..planks {
        let x = (i as f64 + 0.5) * length;
        let plank = block(&format!("plank{i}"), [length - 0.02, 0.06], [x, 0.0]);
        bodies.push(BodyDef { mass: Some(0.8), groups: vec!["planks".into()], ..plank });
    }
    for i in 0..=planks {
        let (a, b) = match i {
            0 => (WORLD.to_owned(), "plank0".to_owned()),
            i if i == planks => (WORLD.to_owned(), format!("plank{}", i - 1)),
            i => (format!("plank{}", i - 1), format!("plank{i}")),
        };
        let softness = Some(Softness { stiffness: 4e3, damping: 30.0 });
        let pin = hinge(&format!("pin{i}"), &a, &b, [i as f64 * length, 0.0]);
        joints.push(JointDef { softness, ..pin });
    }
    let ball = disc("ball", 0.15, [0.3, 0.1805]);
    bodies.push(BodyDef { mass: Some(1.0), velocity: [1.5, 0.0], ..ball });
    let name = "soft bridge".into();
    material(SceneDef { name, bodies, joints, ..SceneDef::default() }, 0.6, 0.0)
}

/// V15 (b): box at rest on a belt that moves at 2 m/s, μ = 0.4.
#[must_use]
pub fn conveyor() -> SceneDef {
    let belt = BodyDef {
        kind: BodyKind::Kinematic,
        velocity: [2.0, 0.0],
        ..block("belt", [40.0, 0.5], [0.0, -0.25])
    };
    let parcel = BodyDef { mass: Some(1.0), ..block("box", [0.4, 0.2], [0.0, 0.1]) };
    let bodies = vec![belt, parcel];
    let def = SceneDef { name: "conveyor".into(), bodies, ..SceneDef::default() };
    material(def, 0.4, 0.0)
}

/// A crank drives a piston in a slot; a welded weight and a lock take part.
#[must_use]
pub fn piston() -> SceneDef {
    let bodies = vec![
        rod("crank", 0.6, 1.0, [0.0; 2], 0.4),
        rod("weight", 0.2, 0.5, [-0.3 * 0.4_f64.cos(), -0.3 * 0.4_f64.sin()], 1.0),
        BodyDef { mass: Some(1.5), ..block("slider", [0.2, 0.1], [1.2, 0.0]) },
    ];
    let tip = [0.3 * 0.4_f64.cos(), 0.3 * 0.4_f64.sin()];
    let motor = Some(Motor { speed: 3.0, max: Some(40.0) });
    let (limits, no) = (Limits::default(), None);
    let revolute = JointKind::Revolute { anchor: [0.0; 2], anchor_b: None, limits, motor };
    let slot = JointKind::Slot { anchor: [1.2, 0.0], axis: [1.0, 0.0], limits, motor: no };
    let joints = vec![
        joint("axle", WORLD, "crank", revolute),
        joint(
            "bolt",
            "crank",
            "weight",
            JointKind::Weld { anchor: [-0.3 * 0.4_f64.cos(), -0.3 * 0.4_f64.sin()] },
        ),
        joint("rail", WORLD, "slider", slot),
        joint("level", WORLD, "slider", JointKind::Lock { x: false, y: false, rotation: true }),
        joint(
            "rod",
            "crank",
            "slider",
            JointKind::Distance { anchor_a: tip, anchor_b: [1.1, 0.0], length: None },
        ),
    ];
    let controls = vec![control("load", ControlInput::ForceX { body: "slider".into() })];
    SceneDef { name: "piston".into(), bodies, joints, controls, ..SceneDef::default() }
}

/// A compound of circle, capsule and polygon tumbles onto the floor.
#[must_use]
pub fn compound_tumble() -> SceneDef {
    let dumbbell = BodyDef {
        name: "dumbbell".into(),
        position: [0.0, 0.5],
        angle: 0.5,
        velocity: [1.0, -1.0],
        angular_velocity: -2.0,
        density: Some(3.0),
        shapes: vec![
            Shape::Circle { radius: 0.2, center: [0.4, 0.0] },
            Shape::Capsule { a: [-0.4, 0.0], b: [0.4, 0.0], radius: 0.05 },
            Shape::Polygon { points: vec![[-0.6, -0.2], [-0.3, -0.15], [-0.4, 0.25]] },
        ],
        ..BodyDef::default()
    };
    let bodies = vec![floor(), dumbbell];
    let def = SceneDef { name: "compound tumble".into(), bodies, ..SceneDef::default() };
    material(def, 0.4, 0.0)
}
