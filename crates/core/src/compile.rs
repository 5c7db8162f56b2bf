//! From definitions to what the engine computes with; every refusal of bad input lives here.

use nalgebra::{Vector2, Vector3};
use tangency_collision::{Collider, MassProperties, Pose, Shape, pose};

use crate::joint::WORLD;
use crate::measure::Measure;
use crate::scene::{Body, Control, Force, Joint, JointRow, Pair};
use crate::{
    BodyDef, BodyKind, ControlDef, ControlInput, ForceDef, JointDef, JointKind, Limits, Motor,
    PairDef, Scene, SceneError, Softness,
};

/// Refuses what is not a finite number.
pub(crate) fn finite(value: f64, path: &str) -> Result<f64, SceneError> {
    check(value, value.is_finite(), path, "give a finite number")
}

/// Refuses what is not a positive finite number.
pub(crate) fn positive(value: f64, path: &str) -> Result<f64, SceneError> {
    check(value, value.is_finite() && value > 0.0, path, "give a positive finite number")
}

/// Refuses what is not a finite number of zero or more.
pub(crate) fn non_negative(value: f64, path: &str) -> Result<f64, SceneError> {
    check(value, value.is_finite() && value >= 0.0, path, "give a finite number of 0 or more")
}

/// Refuses what is not in [0, 1].
pub(crate) fn unit_interval(value: f64, path: &str) -> Result<f64, SceneError> {
    check(value, (0.0..=1.0).contains(&value), path, "give a number from 0 to 1")
}

fn check(value: f64, good: bool, path: &str, expected: &'static str) -> Result<f64, SceneError> {
    if good { Ok(value) } else { Err(SceneError::Value { path: path.into(), value, expected }) }
}

fn conflict<T>(path: String, reason: &'static str) -> Result<T, SceneError> {
    Err(SceneError::Conflict { path, reason })
}

fn finite_point(p: [f64; 2], path: &str) -> Result<Vector2<f64>, SceneError> {
    finite(p[0], &format!("{path}[0]"))?;
    finite(p[1], &format!("{path}[1]"))?;
    Ok(Vector2::from(p))
}

/// The names of one kind of thing, in order.
pub(crate) struct Names {
    names: Vec<String>,
    what: &'static str,
}

impl Names {
    pub(crate) fn of_bodies(bodies: &[BodyDef]) -> Result<Self, SceneError> {
        Self::new(bodies.iter().map(|b| &b.name), "bodies", "a body")
    }

    pub(crate) fn of_joints(joints: &[JointDef]) -> Result<Self, SceneError> {
        Self::new(joints.iter().map(|j| &j.name), "joints", "a joint")
    }

    pub(crate) fn check_controls(controls: &[ControlDef]) -> Result<Self, SceneError> {
        Self::new(controls.iter().map(|c| &c.name), "controls", "a control")
    }

    fn new<'a>(
        given: impl Iterator<Item = &'a String>,
        list: &str,
        what: &'static str,
    ) -> Result<Self, SceneError> {
        let mut names: Vec<String> = Vec::new();
        for (i, name) in given.enumerate() {
            let bad = |reason| {
                let path = format!("{list}[{i}].name");
                Err(SceneError::BadName { path, name: name.clone(), reason })
            };
            if name.is_empty() {
                return bad("give it a name");
            }
            if name == WORLD {
                return bad("this name stands for the immovable world; choose another");
            }
            if names.contains(name) {
                return bad("this name is taken; choose another");
            }
            names.push(name.clone());
        }
        Ok(Self { names, what })
    }

    fn find(&self, name: &str, path: &str) -> Result<usize, SceneError> {
        self.names.iter().position(|n| n == name).ok_or_else(|| SceneError::UnknownName {
            path: path.into(),
            name: name.into(),
            what: self.what,
            known: self.names.join(", "),
        })
    }
}

pub(crate) struct CompiledBody {
    pub(crate) body: Body,
    pub(crate) collider: Collider,
    pub(crate) pose: Pose,
    pub(crate) velocity: Vector3<f64>,
}

pub(crate) fn compile_body(def: &BodyDef, path: &str) -> Result<CompiledBody, SceneError> {
    for (i, shape) in def.shapes.iter().enumerate() {
        let at = |source| SceneError::Shape { path: format!("{path}.shapes[{i}]"), source };
        shape.validate().map_err(at)?;
        if matches!(shape, Shape::HalfPlane { .. }) && def.kind == BodyKind::Dynamic {
            let path = format!("{path}.shapes[{i}]");
            return conflict(path, "a half plane has no mass; make the body static or kinematic");
        }
    }
    non_negative(def.friction, &format!("{path}.friction"))?;
    unit_interval(def.restitution, &format!("{path}.restitution"))?;
    finite(def.gravity_scale, &format!("{path}.gravity_scale"))?;
    let position = finite_point(def.position, &format!("{path}.position"))?;
    finite(def.angle, &format!("{path}.angle"))?;
    let velocity = finite_point(def.velocity, &format!("{path}.velocity"))?;
    finite(def.angular_velocity, &format!("{path}.angular_velocity"))?;
    if def.kind == BodyKind::Static && (velocity != Vector2::zeros() || def.angular_velocity != 0.0)
    {
        return conflict(
            format!("{path}.velocity"),
            "a static body cannot move; make it kinematic",
        );
    }

    let properties = MassProperties::combined(
        def.shapes.iter().filter_map(Shape::mass_properties).collect::<Vec<_>>().into_iter(),
    );
    let centroid = properties.as_ref().map_or_else(Vector2::zeros, |p| p.centroid);
    let shapes: Vec<Shape> = def.shapes.iter().map(|s| s.translated(-centroid)).collect();
    let collider = Collider::new(&shapes)
        .map_err(|source| SceneError::Shape { path: format!("{path}.shapes"), source })?;
    let frame = Pose::new(position.x, position.y, def.angle);
    let center = pose::point(&frame, &centroid);
    let (mass, inertia_follows_mass) = mass_of(def, properties.as_ref(), path)?;
    let body = Body {
        name: def.name.clone(),
        kind: def.kind,
        mass,
        area: properties.as_ref().map_or(0.0, |p| p.area),
        inertia_follows_mass,
        friction: def.friction,
        restitution: def.restitution,
        gravity_scale: def.gravity_scale,
        groups: def.groups.clone(),
        category: def.category,
        mask: def.mask,
    };
    let velocity = Vector3::new(velocity.x, velocity.y, def.angular_velocity);
    Ok(CompiledBody { body, collider, pose: Pose::new(center.x, center.y, def.angle), velocity })
}

/// (m, m, I), and whether I follows from m.
fn mass_of(
    def: &BodyDef,
    properties: Option<&MassProperties>,
    path: &str,
) -> Result<(Vector3<f64>, bool), SceneError> {
    if let Some(mass) = def.mass {
        positive(mass, &format!("{path}.mass"))?;
    }
    if let Some(density) = def.density {
        positive(density, &format!("{path}.density"))?;
    }
    if let Some(inertia) = def.inertia {
        positive(inertia, &format!("{path}.inertia"))?;
    }
    if def.kind != BodyKind::Dynamic {
        return Ok((Vector3::zeros(), false));
    }
    let mass = match (def.mass, def.density, properties) {
        (Some(_), Some(_), _) => {
            return conflict(format!("{path}.density"), "give either mass or density, not both");
        }
        (Some(mass), None, _) => mass,
        (None, density, Some(p)) => density.unwrap_or(1.0) * p.area,
        (None, _, None) => return conflict(path.into(), "a body without shapes needs `mass`"),
    };
    let inertia = match (def.inertia, properties) {
        (Some(inertia), _) => inertia,
        (None, Some(p)) => mass * p.second_moment / p.area,
        (None, None) => return conflict(path.into(), "a body without shapes needs `inertia`"),
    };
    Ok((Vector3::new(mass, mass, inertia), def.inertia.is_none()))
}

/// Collects what every joint needs while its definition is read.
struct JointCompiler<'a> {
    path: &'a str,
    bodies: [Option<usize>; 2],
    poses: [Pose; 2],
}

pub(crate) fn compile_joint(
    def: &JointDef,
    path: &str,
    names: &Names,
    scene: &Scene,
) -> Result<Joint, SceneError> {
    let mut bodies = [None; 2];
    for (i, name) in def.bodies.iter().enumerate() {
        if name != WORLD {
            bodies[i] = Some(names.find(name, &format!("{path}.bodies[{i}]"))?);
        }
    }
    if bodies[0] == bodies[1] {
        return conflict(format!("{path}.bodies"), "a joint needs two different bodies");
    }
    if !bodies.iter().flatten().any(|b| scene.is_dynamic(*b)) {
        return conflict(format!("{path}.bodies"), "at least one of them must be dynamic");
    }
    let poses = bodies.map(|b| b.map_or_else(Pose::zeros, |b| scene.initial.q[b]));
    let compiler = JointCompiler { path, bodies, poses };
    let mut joint = compiler.kind(&def.kind)?;
    joint.name.clone_from(&def.name);
    if let Some(softness) = def.softness {
        if matches!(def.kind, JointKind::Spring { .. }) {
            let reason = "a spring has its own stiffness and damping; leave softness out";
            return conflict(format!("{path}.softness"), reason);
        }
        joint.softness = Some(compiler.softness(softness, "softness")?);
    }
    Ok(joint)
}

impl JointCompiler<'_> {
    fn at(&self, field: &str) -> String {
        format!("{}.{field}", self.path)
    }

    fn kind(&self, kind: &JointKind) -> Result<Joint, SceneError> {
        match kind {
            JointKind::Revolute { anchor, anchor_b, limits, motor } => {
                let a = self.point(*anchor, "kind.revolute.anchor")?;
                let b = self.point(anchor_b.unwrap_or(*anchor), "kind.revolute.anchor_b")?;
                let free = Some(self.angle());
                self.joint([a, b], coincide(), free, "revolute", *limits, *motor)
            }
            JointKind::Weld { anchor } => {
                let p = self.point(*anchor, "kind.weld.anchor")?;
                let held = [coincide(), vec![self.angle()]].concat();
                self.joint([p, p], held, None, "weld", Limits::default(), None)
            }
            JointKind::Prismatic { anchor, axis, limits, motor } => {
                let (p, [across, along]) = self.rail(*anchor, *axis, "prismatic")?;
                let held = vec![across, self.angle()];
                self.joint([p, p], held, Some(along), "prismatic", *limits, *motor)
            }
            JointKind::Slot { anchor, axis, limits, motor } => {
                let (p, [across, along]) = self.rail(*anchor, *axis, "slot")?;
                self.joint([p, p], vec![across], Some(along), "slot", *limits, *motor)
            }
            JointKind::Distance { anchor_a, anchor_b, length } => {
                let (points, held) = self.length(*anchor_a, *anchor_b, *length, "distance")?;
                self.joint(points, vec![held], None, "distance", Limits::default(), None)
            }
            JointKind::Spring { anchor_a, anchor_b, length, stiffness, damping } => {
                let (points, held) = self.length(*anchor_a, *anchor_b, *length, "spring")?;
                let softness = Softness { stiffness: *stiffness, damping: *damping };
                let mut joint =
                    self.joint(points, vec![held], None, "spring", Limits::default(), None)?;
                joint.softness = Some(self.softness(softness, "kind.spring")?);
                Ok(joint)
            }
            JointKind::Lock { x, y, rotation } => self.lock([*x, *y, *rotation]),
        }
    }

    fn lock(&self, [x, y, rotation]: [bool; 3]) -> Result<Joint, SceneError> {
        if self.bodies[0].is_some() || self.bodies[1].is_none() {
            return conflict(
                self.at("bodies"),
                "a lock holds a body in the world: name `world` first",
            );
        }
        if !(x || y || rotation) {
            return conflict(self.at("kind.lock"), "lock at least one of x, y and rotation");
        }
        let [along_x, along_y] = <[JointRow; 2]>::try_from(coincide()).expect("two rows");
        let rows = [(x, along_x), (y, along_y), (rotation, self.angle())];
        let held = rows.iter().filter(|(locked, _)| *locked).map(|(_, row)| *row).collect();
        let center = self.poses[1].xy();
        self.joint([center, center], held, None, "lock", Limits::default(), None)
    }

    /// Puts together a joint from world points.
    fn joint(
        &self,
        points: [Vector2<f64>; 2],
        held: Vec<JointRow>,
        free: Option<JointRow>,
        kind: &str,
        limits: Limits,
        motor: Option<Motor>,
    ) -> Result<Joint, SceneError> {
        self.check_limits(limits, kind)?;
        if let Some(motor) = motor {
            finite(motor.speed, &self.at(&format!("kind.{kind}.motor.speed")))?;
            if let Some(max) = motor.max {
                positive(max, &self.at(&format!("kind.{kind}.motor.max")))?;
            }
        }
        let anchors = [0, 1].map(|i| pose::local_point(&self.poses[i], &points[i]));
        let (name, bodies) = (String::new(), self.bodies);
        Ok(Joint { name, bodies, anchors, held, free, limits, motor, softness: None })
    }

    fn check_limits(&self, limits: Limits, kind: &str) -> Result<(), SceneError> {
        let path = |end: &str| self.at(&format!("kind.{kind}.limits.{end}"));
        if let Some(lower) = limits.lower {
            finite(lower, &path("lower"))?;
        }
        let Some(upper) = limits.upper else { return Ok(()) };
        finite(upper, &path("upper"))?;
        if limits.lower.is_some_and(|lower| lower > upper) {
            let expected = "give an upper limit that is not below the lower one";
            return Err(SceneError::Value { path: path("upper"), value: upper, expected });
        }
        Ok(())
    }

    fn softness(&self, s: Softness, field: &str) -> Result<Softness, SceneError> {
        non_negative(s.stiffness, &self.at(&format!("{field}.stiffness")))?;
        non_negative(s.damping, &self.at(&format!("{field}.damping")))?;
        if s.stiffness == 0.0 && s.damping == 0.0 {
            let path = self.at(&format!("{field}.stiffness"));
            return conflict(path, "with neither stiffness nor damping it does nothing");
        }
        Ok(s)
    }

    fn point(&self, p: [f64; 2], field: &str) -> Result<Vector2<f64>, SceneError> {
        finite_point(p, &self.at(field))
    }

    /// Anchor, and the rows across and along an axis fixed in a.
    fn rail(
        &self,
        anchor: [f64; 2],
        axis: [f64; 2],
        kind: &str,
    ) -> Result<(Vector2<f64>, [JointRow; 2]), SceneError> {
        let p = self.point(anchor, &format!("kind.{kind}.anchor"))?;
        let axis = self.point(axis, &format!("kind.{kind}.axis"))?;
        let Some(axis) = axis.try_normalize(0.0) else {
            return conflict(self.at(&format!("kind.{kind}.axis")), "an axis needs a direction");
        };
        let along = pose::local_direction(&self.poses[0], &axis);
        let row = |axis_local| JointRow { measure: Measure::OnA { axis_local }, reference: 0.0 };
        Ok((p, [row(pose::perp(&along)), row(along)]))
    }

    fn length(
        &self,
        anchor_a: [f64; 2],
        anchor_b: [f64; 2],
        length: Option<f64>,
        kind: &str,
    ) -> Result<([Vector2<f64>; 2], JointRow), SceneError> {
        let a = self.point(anchor_a, &format!("kind.{kind}.anchor_a"))?;
        let b = self.point(anchor_b, &format!("kind.{kind}.anchor_b"))?;
        let distance = (b - a).norm();
        if distance == 0.0 {
            let reason = "the anchors coincide, so their distance has no direction; \
                          use a (soft) revolute joint";
            return conflict(self.at(&format!("kind.{kind}.anchor_b")), reason);
        }
        let reference = match length {
            Some(length) => positive(length, &self.at(&format!("kind.{kind}.length")))?,
            None => distance,
        };
        Ok(([a, b], JointRow { measure: Measure::Length, reference }))
    }

    /// The relative angle, zero at the start.
    fn angle(&self) -> JointRow {
        JointRow { measure: Measure::Angle, reference: self.poses[1].z - self.poses[0].z }
    }
}

/// Both coordinates of the anchors' offset are zero.
fn coincide() -> Vec<JointRow> {
    let row = |axis| JointRow { measure: Measure::World { axis }, reference: 0.0 };
    vec![row(Vector2::x()), row(Vector2::y())]
}

pub(crate) fn compile_force(
    def: &ForceDef,
    path: &str,
    names: &Names,
) -> Result<Force, SceneError> {
    let body = names.find(&def.body, &format!("{path}.body"))?;
    let force = finite_point(def.force, &format!("{path}.force"))?;
    finite(def.torque, &format!("{path}.torque"))?;
    let start = def.start.unwrap_or(f64::NEG_INFINITY);
    let end = def.end.unwrap_or(f64::INFINITY);
    if start.is_nan() || end.is_nan() || start > end {
        let expected = "give an end that is not before the start";
        return Err(SceneError::Value { path: format!("{path}.end"), value: end, expected });
    }
    Ok(Force { body, wrench: Vector3::new(force.x, force.y, def.torque), start, end })
}

pub(crate) fn compile_control(
    def: &ControlDef,
    path: &str,
    bodies: &Names,
    joints: &Names,
    scene: &Scene,
) -> Result<Control, SceneError> {
    let wrench = |name: &str, kind: &str, component| {
        let path = format!("{path}.{kind}.body");
        let body = bodies.find(name, &path)?;
        if !scene.is_dynamic(body) {
            return conflict(path, "a force moves dynamic bodies only");
        }
        Ok(Control::Wrench { body, component })
    };
    match &def.input {
        ControlInput::ForceX { body } => wrench(body, "force_x", 0),
        ControlInput::ForceY { body } => wrench(body, "force_y", 1),
        ControlInput::Torque { body } => wrench(body, "torque", 2),
        ControlInput::MotorSpeed { joint } => {
            let path = format!("{path}.motor_speed.joint");
            let joint = joints.find(joint, &path)?;
            if scene.joints[joint].motor.is_none() {
                return conflict(path, "the joint has no motor; give it one");
            }
            Ok(Control::MotorSpeed { joint })
        }
        ControlInput::JointForce { joint } => {
            let path = format!("{path}.joint_force.joint");
            let joint = joints.find(joint, &path)?;
            if scene.joints[joint].free.is_none() {
                return conflict(path, "the joint has no free coordinate to push along");
            }
            Ok(Control::JointForce { joint })
        }
    }
}

pub(crate) fn compile_pair(def: &PairDef, path: &str, names: &Names) -> Result<Pair, SceneError> {
    let a = names.find(&def.bodies[0], &format!("{path}.bodies[0]"))?;
    let b = names.find(&def.bodies[1], &format!("{path}.bodies[1]"))?;
    if a == b {
        return conflict(format!("{path}.bodies"), "a pair needs two different bodies");
    }
    if let Some(mu) = def.friction {
        non_negative(mu, &format!("{path}.friction"))?;
    }
    if let Some(e) = def.restitution {
        unit_interval(e, &format!("{path}.restitution"))?;
    }
    let (collide, friction, restitution) = (def.collide, def.friction, def.restitution);
    Ok(Pair { bodies: [a, b], collide, friction, restitution })
}
