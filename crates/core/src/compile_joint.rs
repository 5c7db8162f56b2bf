//! From a joint's definition to the scalars that it holds and leaves free.

use nalgebra::Vector2;
use tangency_collision::{Pose, pose};
use tangency_lcp::NO_BODY;

use crate::compile::{LEAST, Names, conflict, finite, finite_point, non_negative, positive};
use crate::joint::WORLD;
use crate::measure::Measure;
use crate::model::{Joint, JointRow};
use crate::{BodyKind, JointDef, JointKind, Limits, Motor, Scene, SceneError, Softness};

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
    let index = |b: usize| u32::try_from(b).expect("fewer bodies than u32 counts");
    let unknown = |body: Option<usize>| body.filter(|b| scene.is_dynamic(*b));
    joint.unknowns = bodies.map(|body| unknown(body).map_or(NO_BODY, index));
    let kinematic = |b: &usize| scene.bodies[*b].kind == BodyKind::Kinematic;
    joint.driven = bodies.iter().flatten().any(kinematic);
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
        let (softness, unknowns, driven) = (None, [NO_BODY; 2], false);
        Ok(Joint { name, bodies, anchors, held, free, limits, motor, softness, unknowns, driven })
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
        let Some(axis) = axis.try_normalize(LEAST) else {
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
        if distance < LEAST {
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
