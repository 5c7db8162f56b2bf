//! Random scenes from seeds: any shapes, joints and materials, overlapping or not.

use tangency_core::{
    BodyDef, BodyKind, ContactModel, JointDef, JointKind, Limits, Motor, SceneDef, Shape, Softness,
    WORLD,
};

use crate::problems::Random;
use crate::scenes::floor;

/// A scene of `bodies` bodies over a floor or free, from a seed. Masses span eight decades, friction
/// goes up to 10, shapes overlap as they fall; joints of all kinds tie some of the bodies, loops
/// included. The first bodies of a seed are the same for every number of bodies.
///
/// One in five is [driven](is_driven): it has kinematic bodies and motors without a greatest force,
/// which may drive rows against each other. All others have a solution at every step.
#[must_use]
pub fn random_scene(seed: u64, bodies: usize) -> SceneDef {
    let mut random = Random(seed);
    let kind = Kind::new(&mut random, is_driven(seed));
    let mut def = SceneDef {
        name: format!("random scene {seed} of {bodies} bodies"),
        gravity: [0.0, random.pick(&[0.0, -9.81, -9.81, -9.81])],
        dt: random.pick(&[1e-3, 1e-2, 1.0 / 60.0]),
        contact_model: random.pick(&[
            ContactModel::Gap,
            ContactModel::Gap,
            ContactModel::Gap,
            ContactModel::Velocity { contact_distance: 1e-3 },
        ]),
        ..SceneDef::default()
    };
    let width = 0.7 * (bodies as f64).sqrt();
    for i in 0..bodies {
        let mut random = Random(seed ^ (0x5bd1_e995 * (i as u64 + 1)));
        let place = [random.between(-width, width), random.between(0.3, 0.3 + 2.0 * width)];
        def.bodies.push(body(&mut random, &kind, i, place));
    }
    let mut random = Random(seed ^ 0xabcd_ef01);
    let joints = if kind.jointed { bodies / 2 } else { 0 };
    for j in 0..joints {
        def.joints.extend(joint(&mut random, &kind, j, &def.bodies));
    }
    if kind.floor {
        def.bodies.push(BodyDef { friction: kind.friction, ..floor() });
    }
    def
}

/// Whether the random scene of a seed may contradict itself.
#[must_use]
pub fn is_driven(seed: u64) -> bool {
    seed.is_multiple_of(5)
}

/// What the bodies of a scene have in common.
struct Kind {
    driven: bool,
    friction: f64,
    restitution: f64,
    decades: f64,
    jointed: bool,
    floor: bool,
}

impl Kind {
    fn new(random: &mut Random, driven: bool) -> Self {
        Self {
            driven,
            friction: random.pick(&[0.0, 0.3, 0.6, 1.0, 3.0, 10.0]),
            restitution: random.pick(&[0.0, 0.0, 0.3, 1.0]),
            decades: random.pick(&[0.0, 1.0, 4.0]),
            jointed: random.index(2) == 0,
            floor: random.index(4) > 0,
        }
    }
}

fn body(random: &mut Random, kind: &Kind, i: usize, position: [f64; 2]) -> BodyDef {
    let moves = random.index(20);
    let shapes = (0..random.pick(&[1, 1, 1, 2])).map(|_| shape(random)).collect();
    let angle = if random.index(3) == 0 { 0.0 } else { random.between(-3.0, 3.0) };
    let speed = random.pick(&[0.0, 1.0, 3.0]);
    let velocity = [random.between(-speed, speed), random.between(-speed, speed)];
    let angular_velocity = random.between(-speed, speed);
    let decades = random.between(-kind.decades, kind.decades);
    let mut body = BodyDef {
        name: format!("b{i}"),
        position,
        angle,
        velocity,
        angular_velocity,
        shapes,
        mass: Some(10.0_f64.powf(decades)),
        friction: random.pick(&[kind.friction, kind.friction, 0.0, 0.5]),
        restitution: random.pick(&[kind.restitution, kind.restitution, 0.0]),
        ..BodyDef::default()
    };
    if moves == 0 && kind.driven {
        (body.kind, body.mass) = (BodyKind::Kinematic, None);
    } else if moves < 3 {
        (body.kind, body.mass) = (BodyKind::Static, None);
        (body.velocity, body.angular_velocity) = ([0.0; 2], 0.0);
    }
    body
}

fn shape(random: &mut Random) -> Shape {
    let mut place = || [random.between(-0.2, 0.2), random.between(-0.2, 0.2)];
    let (a, b, c, d) = (place(), place(), place(), place());
    match random.index(4) {
        0 => Shape::Circle { radius: random.between(0.05, 0.5), center: a },
        1 => {
            let (width, height) = (random.between(0.05, 1.0), random.between(0.05, 1.0));
            let (center, angle) = ([0.0; 2], random.pick(&[0.0, 0.0, 0.7]));
            Shape::Rectangle { width, height, center, angle }
        }
        2 => {
            let far = |p: [f64; 2], x: f64, y: f64| [p[0] + x, p[1] + y];
            let points = vec![far(a, -0.4, -0.3), far(b, 0.4, -0.3), far(c, 0.3, 0.4), d];
            Shape::Polygon { points }
        }
        _ => Shape::Capsule { a, b: [b[0] + 0.3, b[1]], radius: random.between(0.05, 0.3) },
    }
}

/// A joint between two bodies or a body and the world; none if neither would move.
fn joint(random: &mut Random, kind: &Kind, j: usize, bodies: &[BodyDef]) -> Option<JointDef> {
    let (a, b) = (random.index(bodies.len() + 1), random.index(bodies.len()));
    let moves = |i: usize| bodies.get(i).is_some_and(|b| b.kind == BodyKind::Dynamic);
    let ends = [bodies.get(a).unwrap_or(&bodies[b]), &bodies[b]];
    let kind = joint_kind(random, kind.driven, ends);
    let softness = match random.index(6) {
        0 if !matches!(kind, JointKind::Spring { .. }) => {
            let (stiffness, damping) = (random.between(1.0, 1e4), random.between(0.0, 10.0));
            Some(Softness { stiffness, damping })
        }
        _ => None,
    };
    let name_a = bodies.get(a).map_or(WORLD.into(), |a| a.name.clone());
    let (name, bodies) = (format!("j{j}"), [name_a, bodies[b].name.clone()]);
    let collide = random.index(3) == 0;
    let fits = a != b && (moves(a) || moves(b)) && !(is_lock(&kind) && bodies[0] != WORLD);
    fits.then_some(JointDef { name, bodies, kind, collide, softness })
}

fn is_lock(kind: &JointKind) -> bool {
    matches!(kind, JointKind::Lock { .. })
}

fn joint_kind(random: &mut Random, driven: bool, [a, b]: [&BodyDef; 2]) -> JointKind {
    let at = [
        random.between(0.2, 0.8) * (b.position[0] - a.position[0]) + a.position[0],
        random.between(0.2, 0.8) * (b.position[1] - a.position[1]) + a.position[1],
    ];
    let near = |p: [f64; 2], x: f64, y: f64| [p[0] + x, p[1] + y];
    let mut limits = Limits::default();
    if random.index(3) == 0 {
        limits.lower = Some(random.between(-0.5, 0.0));
        limits.upper = Some(random.between(0.0, 0.5));
    }
    let speed = random.between(-3.0, 3.0);
    let motor = match random.index(6) {
        0 => Some(Motor { speed, max: Some(random.between(0.1, 100.0)) }),
        1 if driven => Some(Motor { speed, max: None }),
        _ => None,
    };
    let axis = [random.between(-1.0, 1.0), random.between(0.1, 1.0)];
    let (anchor_a, anchor_b) = (near(a.position, 0.1, 0.05), near(b.position, -0.1, 0.15));
    match random.index(8) {
        0 | 1 => JointKind::Revolute { anchor: at, anchor_b: None, limits, motor },
        2 => JointKind::Weld { anchor: at },
        3 => JointKind::Prismatic { anchor: at, axis, limits, motor },
        4 => JointKind::Slot { anchor: at, axis, limits, motor },
        5 => JointKind::Distance { anchor_a, anchor_b, length: None },
        6 => {
            let (x, y, rotation) = (random.index(2) == 0, random.index(2) == 0, true);
            JointKind::Lock { x, y, rotation }
        }
        _ => {
            let (stiffness, damping) = (random.between(1.0, 1e3), random.between(0.0, 5.0));
            JointKind::Spring { anchor_a, anchor_b, length: None, stiffness, damping }
        }
    }
}
