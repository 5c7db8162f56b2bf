//! Other units of length, mass and time.
//!
//! An engine without constants of its own does the same to every bit when the unit of length, mass
//! or time becomes a power of two of what it was: each number only changes its exponent.

use nalgebra::Vector3;
use tangency_core::{
    BodyDef, BodyKind, ContactModel, ForceDef, JointDef, JointKind, Limits, Motor, Param, Scene,
    SceneDef, Shape, ShapeNumber, Softness, State,
};

use super::{Number, Retelling};

/// How many of the new units of length, mass and time make one of the old.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    /// Of length.
    pub length: f64,
    /// Of mass.
    pub mass: f64,
    /// Of time.
    pub time: f64,
}

/// Exponents of length, mass and time.
type Dimension = [i32; 3];

const NUMBER: Dimension = [0, 0, 0];
const LENGTH: Dimension = [1, 0, 0];
const TIME: Dimension = [0, 0, 1];
const RATE: Dimension = [0, 0, -1];
const SPEED: Dimension = [1, 0, -1];
const ACCELERATION: Dimension = [1, 0, -2];
const MASS: Dimension = [0, 1, 0];
const DENSITY: Dimension = [-2, 1, 0];
const INERTIA: Dimension = [2, 1, 0];
const FORCE: Dimension = [1, 1, -2];
const TORQUE: Dimension = [2, 1, -2];

/// Dimensions of a joint's free coordinate, of its rate, and of what drives it.
struct Free {
    value: Dimension,
    rate: Dimension,
    effort: Dimension,
}

const TURNS: Free = Free { value: NUMBER, rate: RATE, effort: TORQUE };
const SLIDES: Free = Free { value: LENGTH, rate: SPEED, effort: FORCE };

impl Units {
    /// The old units.
    pub const SAME: Self = Self { length: 1.0, mass: 1.0, time: 1.0 };

    /// Powers of a number, for length, mass and time.
    #[must_use]
    pub fn powers_of(number: f64, exponents: [i32; 3]) -> Self {
        let [length, mass, time] = exponents.map(|exponent| number.powi(exponent));
        Self { length, mass, time }
    }

    /// One of the old units of a quantity in the new ones.
    fn of(&self, [length, mass, time]: Dimension) -> f64 {
        self.length.powi(length) * self.mass.powi(mass) * self.time.powi(time)
    }

    fn change<'a>(&self, numbers: impl IntoIterator<Item = &'a mut f64>, dimension: Dimension) {
        numbers.into_iter().for_each(|number| *number *= self.of(dimension));
    }

    fn body(&self, body: &mut BodyDef) {
        let dense = body.mass.is_none() && !body.shapes.is_empty();
        if dense && body.kind == BodyKind::Dynamic {
            body.density.get_or_insert(1.0);
        }
        self.change(&mut body.position, LENGTH);
        self.change(&mut body.velocity, SPEED);
        self.change([&mut body.angular_velocity], RATE);
        self.change(&mut body.mass, MASS);
        self.change(&mut body.density, DENSITY);
        self.change(&mut body.inertia, INERTIA);
        body.shapes.iter_mut().for_each(|shape| self.shape(shape));
    }

    fn shape(&self, shape: &mut Shape) {
        let mut lengths: Vec<&mut f64> = Vec::new();
        match shape {
            Shape::Circle { radius, center } => {
                lengths.push(radius);
                lengths.extend(center);
            }
            Shape::Rectangle { width, height, center, .. } => {
                lengths.extend([width, height]);
                lengths.extend(center);
            }
            Shape::Polygon { points } => lengths.extend(points.iter_mut().flatten()),
            Shape::Capsule { a, b, radius } => {
                lengths.push(radius);
                lengths.extend(a.iter_mut().chain(b));
            }
            Shape::HalfPlane { offset, .. } => lengths.push(offset),
        }
        self.change(lengths, LENGTH);
    }

    fn joint(&self, joint: &mut JointDef) {
        if let Some(Softness { stiffness, damping }) = &mut joint.softness {
            self.soften(stiffness, damping, !holds_points(&joint.kind));
        }
        match &mut joint.kind {
            JointKind::Revolute { anchor, anchor_b, limits, motor } => {
                self.change(anchor.iter_mut().chain(anchor_b.iter_mut().flatten()), LENGTH);
                self.drive(limits, motor, &TURNS);
            }
            JointKind::Weld { anchor } => self.change(anchor, LENGTH),
            JointKind::Prismatic { anchor, limits, motor, .. }
            | JointKind::Slot { anchor, limits, motor, .. } => {
                self.change(anchor, LENGTH);
                self.drive(limits, motor, &SLIDES);
            }
            JointKind::Distance { anchor_a, anchor_b, length } => {
                self.change(anchor_a.iter_mut().chain(anchor_b).chain(length), LENGTH);
            }
            JointKind::Spring { anchor_a, anchor_b, length, stiffness, damping } => {
                self.change(anchor_a.iter_mut().chain(anchor_b).chain(length), LENGTH);
                self.soften(stiffness, damping, false);
            }
            JointKind::Lock { .. } => {}
        }
    }

    fn soften(&self, stiffness: &mut f64, damping: &mut f64, turns: bool) {
        self.change([stiffness], of_stiffness(turns));
        self.change([damping], of_damping(turns));
    }

    fn drive(&self, limits: &mut Limits, motor: &mut Option<Motor>, free: &Free) {
        self.change(limits.lower.iter_mut().chain(&mut limits.upper), free.value);
        if let Some(Motor { speed, max }) = motor {
            self.change([speed], free.rate);
            self.change(max, free.effort);
        }
    }

    fn force(&self, force: &mut ForceDef) {
        self.change(&mut force.force, FORCE);
        self.change([&mut force.torque], TORQUE);
        self.change(force.start.iter_mut().chain(&mut force.end), TIME);
    }
}

impl Retelling for Units {
    /// A body that leaves its density to the engine is given the one that it had. What a scene says
    /// with one number for two dimensions cannot be expressed when the unit of length changes: the
    /// stiffness of a joint that [holds both](has_own_units).
    fn scene(&self, def: &SceneDef) -> SceneDef {
        let mut def = def.clone();
        self.change(&mut def.gravity, ACCELERATION);
        self.change([&mut def.dt, &mut def.duration], TIME);
        self.change([&mut def.contact_reach], LENGTH);
        self.change([&mut def.recovery_speed], SPEED);
        self.change([&mut def.recovery_rate], RATE);
        if let ContactModel::Velocity { contact_distance } = &mut def.contact_model {
            self.change([contact_distance], LENGTH);
        }
        def.bodies.iter_mut().for_each(|body| self.body(body));
        def.joints.iter_mut().for_each(|joint| self.joint(joint));
        def.forces.iter_mut().for_each(|force| self.force(force));
        def
    }

    fn told_back(&self, state: &State) -> State {
        let back = |x: &Vector3<f64>, moves: Dimension, turns: Dimension| {
            let (along, about) = (self.of(moves), self.of(turns));
            Vector3::new(x.x / along, x.y / along, x.z / about)
        };
        State {
            time: state.time / self.of(TIME),
            q: state.q.iter().map(|q| back(q, LENGTH, NUMBER)).collect(),
            v: state.v.iter().map(|v| back(v, SPEED, RATE)).collect(),
        }
    }

    fn number(&self, _bodies: usize, number: Number) -> Vec<(Number, f64)> {
        let dimension = match number {
            Number::Pose(_, 2) => NUMBER,
            Number::Pose(..) => LENGTH,
            Number::Velocity(_, 2) => RATE,
            Number::Velocity(..) => SPEED,
        };
        vec![(number, 1.0 / self.of(dimension))]
    }

    fn param(&self, scene: &Scene, param: Param) -> Vec<(Param, f64)> {
        vec![(param, self.of(dimension(scene, param)))]
    }
}

/// Whether some joint holds points and angles with one stiffness, which no other unit of length
/// can express.
#[must_use]
pub fn has_own_units(def: &SceneDef) -> bool {
    let soft = def.joints.iter().filter(|joint| joint.softness.is_some());
    soft.map(|joint| &joint.kind).any(|kind| holds_points(kind) && holds_angles(kind))
}

fn holds_points(kind: &JointKind) -> bool {
    !matches!(kind, JointKind::Lock { x: false, y: false, .. })
}

fn holds_angles(kind: &JointKind) -> bool {
    let locked = matches!(kind, JointKind::Lock { rotation: true, .. });
    locked || matches!(kind, JointKind::Weld { .. } | JointKind::Prismatic { .. })
}

/// N/m, or N·m/rad.
fn of_stiffness(turns: bool) -> Dimension {
    if turns { TORQUE } else { [0, 1, -2] }
}

/// N·s/m, or N·m·s/rad.
fn of_damping(turns: bool) -> Dimension {
    if turns { [2, 1, -1] } else { [0, 1, -1] }
}

/// The dimension of a number of a scene.
fn dimension(scene: &Scene, param: Param) -> Dimension {
    let kind = |j: usize| &scene.def().joints[j].kind;
    let free = |j: usize| match kind(j) {
        JointKind::Prismatic { .. } | JointKind::Slot { .. } => SLIDES,
        _ => TURNS,
    };
    match param {
        Param::Mass(_) => MASS,
        Param::Density(_) => DENSITY,
        Param::Inertia(_) => INERTIA,
        Param::Friction(_)
        | Param::Restitution(_)
        | Param::Position(_, 2)
        | Param::Shape(_, _, ShapeNumber::Angle | ShapeNumber::Normal(_)) => NUMBER,
        Param::Radius(..)
        | Param::Shape(..)
        | Param::Position(..)
        | Param::AnchorA(..)
        | Param::AnchorB(..)
        | Param::Length(_) => LENGTH,
        Param::Velocity(_, 2) => RATE,
        Param::Velocity(..) => SPEED,
        Param::Gravity(_) => ACCELERATION,
        Param::Dt => TIME,
        Param::MotorSpeed(j) => free(j).rate,
        Param::MotorMax(j) => free(j).effort,
        Param::Lower(j) | Param::Upper(j) => free(j).value,
        Param::Stiffness(j) => of_stiffness(!holds_points(kind(j))),
        Param::Damping(j) => of_damping(!holds_points(kind(j))),
        Param::Force(_, 2) => TORQUE,
        Param::Force(..) => FORCE,
    }
}
