//! Checks that every part of a definition goes through: numbers, points, names.

use nalgebra::Vector2;

use crate::joint::WORLD;
use crate::{BodyDef, ControlDef, JointDef, SceneError};

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

pub(crate) fn conflict<T>(path: String, reason: &'static str) -> Result<T, SceneError> {
    Err(SceneError::Conflict { path, reason })
}

pub(crate) fn finite_point(p: [f64; 2], path: &str) -> Result<Vector2<f64>, SceneError> {
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

    pub(crate) fn find(&self, name: &str, path: &str) -> Result<usize, SceneError> {
        self.names.iter().position(|n| n == name).ok_or_else(|| SceneError::UnknownName {
            path: path.into(),
            name: name.into(),
            what: self.what,
            known: self.names.join(", "),
        })
    }
}
