//! What is refused, word for word.

use tangency::{
    BodyDef, BodyKind, ContactModel, ControlDef, ControlInput, Correction, ForceDef, JointDef,
    JointKind, Limits, Motor, Param, Scene, SceneDef, Shape, Softness, StepError, StepScratch,
    WORLD, step,
};
use tangency_bench::scenes::{block, disc, fixed_block, floor, hinge, pendulum, plane, rod};

use crate::engine::{backends, built};

/// A good scene; each test spoils one thing.
fn good() -> SceneDef {
    let bodies = vec![floor(), block("box", [1.0, 1.0], [0.0, 0.5]), disc("ball", 0.2, [3.0, 1.0])];
    let joints = vec![hinge("pin", WORLD, "ball", [3.0, 2.0])];
    SceneDef { bodies, joints, ..SceneDef::default() }
}

#[track_caller]
fn check(spoil: impl FnOnce(&mut SceneDef), message: &str) {
    let mut def = good();
    Scene::new(&def).expect("the scene is good before it is spoilt");
    spoil(&mut def);
    let error = Scene::new(&def).expect_err("it must be refused");
    assert_eq!(error.to_string(), message);
    assert!(message.starts_with(error.path()), "path {}", error.path());
}

#[test]
fn settings() {
    check(|d| d.version = 7, "version is 7: this engine reads version 1");
    check(|d| d.dt = 0.0, "dt is 0: give a positive finite number");
    check(|d| d.dt = -0.01, "dt is -0.01: give a positive finite number");
    check(|d| d.dt = f64::NAN, "dt is NaN: give a positive finite number");
    check(|d| d.gravity[1] = f64::INFINITY, "gravity[1] is inf: give a finite number");
    check(|d| d.tolerance = 0.0, "tolerance is 0: give a positive finite number");
    check(|d| d.recovery_speed = -1.0, "recovery_speed is -1: give a positive finite number");
    check(|d| d.recovery_rate = 0.0, "recovery_rate is 0: give a positive finite number");
    check(
        |d| d.contact_model = ContactModel::Velocity { contact_distance: 0.0 },
        "contact_model.velocity.contact_distance is 0: give a positive finite number",
    );
    check(
        |d| d.stabilisation.joints = Correction::Baumgarte { fraction: 1.5 },
        "stabilisation.joints.baumgarte.fraction is 1.5: give a fraction in (0, 1]",
    );
}

#[test]
fn bodies() {
    let body = |f: fn(&mut BodyDef)| move |d: &mut SceneDef| f(&mut d.bodies[1]);
    check(body(|b| b.mass = Some(0.0)), "bodies[1].mass is 0: give a positive finite number");
    check(body(|b| b.mass = Some(-2.0)), "bodies[1].mass is -2: give a positive finite number");
    check(
        body(|b| b.mass = Some(f64::NAN)),
        "bodies[1].mass is NaN: give a positive finite number",
    );
    check(body(|b| b.inertia = Some(0.0)), "bodies[1].inertia is 0: give a positive finite number");
    check(body(|b| b.density = Some(0.0)), "bodies[1].density is 0: give a positive finite number");
    check(
        body(|b| (b.mass, b.density) = (Some(1.0), Some(1.0))),
        "bodies[1].density: give either mass or density, not both",
    );
    check(
        body(|b| b.friction = -0.1),
        "bodies[1].friction is -0.1: give a finite number of 0 or more",
    );
    check(body(|b| b.restitution = 1.5), "bodies[1].restitution is 1.5: give a number from 0 to 1");
    check(
        body(|b| b.restitution = -0.5),
        "bodies[1].restitution is -0.5: give a number from 0 to 1",
    );
    check(body(|b| b.position[0] = f64::NAN), "bodies[1].position[0] is NaN: give a finite number");
    check(body(|b| b.angle = f64::INFINITY), "bodies[1].angle is inf: give a finite number");
    check(body(|b| b.velocity[1] = f64::NAN), "bodies[1].velocity[1] is NaN: give a finite number");
    check(
        body(|b| b.angular_velocity = f64::NEG_INFINITY),
        "bodies[1].angular_velocity is -inf: give a finite number",
    );
    check(body(|b| b.name = String::new()), "bodies[1].name is \"\": give it a name");
    check(
        body(|b| b.name = "floor".into()),
        "bodies[1].name is \"floor\": this name is taken; choose another",
    );
    check(
        body(|b| b.name = WORLD.into()),
        "bodies[1].name is \"world\": this name stands for the immovable world; choose another",
    );
    check(
        body(|b| (b.kind, b.velocity) = (BodyKind::Static, [1.0, 0.0])),
        "bodies[1].velocity: a static body cannot move; make it kinematic",
    );
    check(body(|b| b.shapes.clear()), "bodies[1]: a body without shapes needs `mass`");
    check(
        body(|b| {
            b.shapes.clear();
            b.mass = Some(1.0);
        }),
        "bodies[1]: a body without shapes needs `inertia`",
    );
    check(
        |d| d.bodies[0].kind = BodyKind::Dynamic,
        "bodies[0].shapes[0]: a half plane has no mass; make the body static or kinematic",
    );
}

#[test]
fn shapes() {
    let shape = |shape: Shape| move |d: &mut SceneDef| d.bodies[1].shapes = vec![shape];
    let polygon = |points: &[[f64; 2]]| Shape::Polygon { points: points.to_vec() };
    check(
        shape(Shape::Circle { radius: -1.0, center: [0.0; 2] }),
        "bodies[1].shapes[0]: radius is -1; it must be positive and finite",
    );
    check(
        shape(Shape::Rectangle { width: 0.0, height: 1.0, center: [0.0; 2], angle: 0.0 }),
        "bodies[1].shapes[0]: width is 0; it must be positive and finite",
    );
    check(
        shape(polygon(&[[0.0, 0.0], [1.0, 0.0]])),
        "bodies[1].shapes[0]: points has 2 entries; a polygon needs at least 3",
    );
    check(
        shape(polygon(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]])),
        "bodies[1].shapes[0]: points span an area of 0 m² over an extent of 2 m; move a point off \
         the line of the others",
    );
    check(
        shape(polygon(&[[0.0, f64::NAN], [1.0, 1.0], [2.0, 0.0]])),
        "bodies[1].shapes[0]: points is NaN; it must be finite",
    );
    check(
        shape(Shape::Capsule { a: [0.0; 2], b: [0.0; 2], radius: 0.5 }),
        "bodies[1].shapes[0]: a and b of the capsule are 0 m apart; use a circle of radius 0.5 \
         instead",
    );
    check(
        |d| d.bodies[0].shapes = vec![Shape::HalfPlane { normal: [0.0; 2], offset: 0.0 }],
        "bodies[0].shapes[0]: normal is [0, 0]; it must have a direction, give for example [0, 1]",
    );
}

fn joint(kind: JointKind) -> impl FnOnce(&mut SceneDef) {
    |d| d.joints[0].kind = kind
}

fn revolute(limits: Limits, motor: Option<Motor>) -> JointKind {
    JointKind::Revolute { anchor: [3.0, 2.0], anchor_b: None, limits, motor }
}

#[test]
fn joints() {
    let no = Limits::default();
    let bodies = |a: &'static str, b: &'static str| {
        move |d: &mut SceneDef| d.joints[0].bodies = [a.into(), b.into()]
    };
    check(bodies("ball", "ball"), "joints[0].bodies: a joint needs two different bodies");
    check(bodies("world", "world"), "joints[0].bodies: a joint needs two different bodies");
    check(bodies("world", "floor"), "joints[0].bodies: at least one of them must be dynamic");
    check(
        bodies("world", "bal"),
        "joints[0].bodies[1] names \"bal\", which is not a body; known: floor, box, ball",
    );
    check(
        joint(revolute(no, Some(Motor { speed: f64::NAN, max: None }))),
        "joints[0].kind.revolute.motor.speed is NaN: give a finite number",
    );
    check(
        joint(revolute(no, Some(Motor { speed: 1.0, max: Some(0.0) }))),
        "joints[0].kind.revolute.motor.max is 0: give a positive finite number",
    );
    check(
        joint(revolute(Limits { lower: Some(1.0), upper: Some(0.5) }, None)),
        "joints[0].kind.revolute.limits.upper is 0.5: give an upper limit that is not below the \
         lower one",
    );
    check(
        joint(JointKind::Slot { anchor: [0.0; 2], axis: [0.0; 2], limits: no, motor: None }),
        "joints[0].kind.slot.axis: an axis needs a direction",
    );
    check(
        joint(JointKind::Distance { anchor_a: [1.0; 2], anchor_b: [1.0; 2], length: None }),
        "joints[0].kind.distance.anchor_b: the anchors coincide, so their distance has no \
         direction; use a (soft) revolute joint",
    );
    check(
        joint(JointKind::Lock { x: false, y: false, rotation: false }),
        "joints[0].kind.lock: lock at least one of x, y and rotation",
    );
    check(
        |d| {
            d.joints[0].bodies = ["ball".into(), WORLD.into()];
            d.joints[0].kind = JointKind::Lock { x: true, y: false, rotation: false };
        },
        "joints[0].bodies: a lock holds a body in the world: name `world` first",
    );
    check(
        |d| d.joints[0].softness = Some(Softness { stiffness: -1.0, damping: 0.0 }),
        "joints[0].softness.stiffness is -1: give a finite number of 0 or more",
    );
    check(
        |d| d.joints[0].softness = Some(Softness { stiffness: 0.0, damping: 0.0 }),
        "joints[0].softness.stiffness: with neither stiffness nor damping it does nothing",
    );
    check(
        |d| {
            let twin: JointDef = d.joints[0].clone();
            d.joints.push(twin);
        },
        "joints[1].name is \"pin\": this name is taken; choose another",
    );
}

#[test]
fn forces_controls_and_pairs() {
    let force = |force: ForceDef| move |d: &mut SceneDef| d.forces = vec![force];
    let control = |input: ControlInput| {
        move |d: &mut SceneDef| d.controls = vec![ControlDef { name: "u".into(), input }]
    };
    check(
        force(ForceDef { body: "nobody".into(), ..ForceDef::default() }),
        "forces[0].body names \"nobody\", which is not a body; known: floor, box, ball",
    );
    check(
        force(ForceDef { body: "box".into(), force: [f64::NAN, 0.0], ..ForceDef::default() }),
        "forces[0].force[0] is NaN: give a finite number",
    );
    check(
        force(ForceDef {
            body: "box".into(),
            start: Some(2.0),
            end: Some(1.0),
            ..ForceDef::default()
        }),
        "forces[0].end is 1: give an end that is not before the start",
    );
    check(
        control(ControlInput::ForceX { body: "floor".into() }),
        "controls[0].input.force_x.body: a force moves dynamic bodies only",
    );
    check(
        control(ControlInput::MotorSpeed { joint: "pin".into() }),
        "controls[0].input.motor_speed.joint: the joint has no motor; give it one",
    );
    check(
        control(ControlInput::JointForce { joint: "nut".into() }),
        "controls[0].input.joint_force.joint names \"nut\", which is not a joint; known: pin",
    );
    let pair = |bodies: [&str; 2], friction| {
        let bodies = bodies.map(String::from);
        tangency::PairDef { bodies, friction, ..tangency::PairDef::default() }
    };
    let (same, rough) = (pair(["box", "box"], None), pair(["box", "ball"], Some(-1.0)));
    check(|d| d.pairs = vec![same], "pairs[0].bodies: a pair needs two different bodies");
    check(|d| d.pairs = vec![rough], "pairs[0].friction is -1: give a finite number of 0 or more");
}

#[test]
fn numbers_set_later() {
    let mut scene = built(&good());
    let mut refusal = |param, value| scene.set(param, value).expect_err("refused").to_string();
    assert_eq!(refusal(Param::Mass(1), -1.0), "Mass(1) is -1: give a positive finite number");
    assert_eq!(
        refusal(Param::Mass(9), 1.0),
        "Mass(9): the scene has no such number; check its index and kind"
    );
    assert_eq!(
        refusal(Param::Restitution(1), 2.0),
        "Restitution(1) is 2: give a number from 0 to 1"
    );
}

/// The error of the first step from a spoilt state or control.
#[track_caller]
fn check_step(def: &SceneDef, spoil: impl Fn(&mut tangency::State, &mut Vec<f64>), message: &str) {
    let scene = built(def);
    for solver in backends() {
        let (mut state, mut control) = (scene.initial_state(), vec![0.0; scene.controls().len()]);
        spoil(&mut state, &mut control);
        let mut scratch = StepScratch::default();
        let result = step(&scene, &*solver, &state, &control, &mut scratch);
        assert_eq!(result.expect_err("it must be refused").to_string(), message);
    }
}

#[test]
fn states_and_controls() {
    let mut def = good();
    let input = ControlInput::ForceX { body: "box".into() };
    def.controls = vec![ControlDef { name: "push".into(), input }];
    check_step(
        &def,
        |state, _| state.q[1].x = f64::NAN,
        "pose of body 1 is not finite; look for an earlier division by zero",
    );
    check_step(
        &def,
        |state, _| state.v[2].z = f64::INFINITY,
        "velocity of body 2 is not finite; look for an earlier division by zero",
    );
    check_step(
        &def,
        |_, control| control[0] = f64::NAN,
        "control 0 is not finite; look for an earlier division by zero",
    );
    check_step(&def, |_, u| u.clear(), "the control has 0 numbers, the scene 1 control channels");
    check_step(&def, |state, _| state.q.truncate(2), "the state has 2 bodies, the scene 3");
}

#[test]
fn coincident_centres() {
    let bodies = vec![disc("a", 0.2, [1.0, 1.0]), disc("b", 0.3, [1.0, 1.0])];
    check_step(
        &SceneDef { bodies, ..SceneDef::default() },
        |_, _| {},
        "at time 0: the centres of touching round features of bodies 0 and 1 coincide, so that \
         their contact has no normal; move one of the bodies",
    );
}

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
