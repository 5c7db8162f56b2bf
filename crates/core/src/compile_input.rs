//! From the definitions of forces, controls and pairs to indices.

use nalgebra::Vector3;

use crate::compile::{Names, conflict, finite, finite_point, non_negative, unit_interval};
use crate::model::{Control, Force, Pair};
use crate::{ControlDef, ControlInput, ForceDef, PairDef, Scene, SceneError};

pub(crate) fn compile_force(
    def: &ForceDef,
    path: &str,
    names: &Names,
    scene: &Scene,
) -> Result<Force, SceneError> {
    let body = names.find(&def.body, &format!("{path}.body"))?;
    if !scene.is_dynamic(body) {
        return conflict(format!("{path}.body"), "a force moves dynamic bodies only");
    }
    let force = finite_point(def.force, &format!("{path}.force"))?;
    finite(def.torque, &format!("{path}.torque"))?;
    let start = def.start.unwrap_or(f64::NEG_INFINITY);
    let end = def.end.unwrap_or(f64::INFINITY);
    for (time, field) in [(def.start, "start"), (def.end, "end")] {
        if let Some(value) = time.filter(|time| !time.is_finite()) {
            let (path, expected) =
                (format!("{path}.{field}"), "give a finite time, or leave it out");
            return Err(SceneError::Value { path, value, expected });
        }
    }
    if start > end {
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
    Ok(Pair { bodies: [a.min(b), a.max(b)], collide, friction, restitution })
}
