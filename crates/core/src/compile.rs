//! Checks that every part of a definition goes through: numbers, points, names.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use crate::joint::WORLD;
use crate::{BodyDef, ControlDef, JointDef, SceneError};

/// Sizes outside this range are refused. With them the products that a step forms (a fourth power of
/// a length in an inertia, its inverse, the square of that) neither overflow nor vanish.
pub(crate) const LEAST: f64 = 1e-50;
const MOST: f64 = 1e50;

const UNITS: &str = "numbers from 1e-50 to 1e50 can be computed with, change units";

/// Refuses what is not a finite number, or too large to compute with.
pub(crate) fn finite(value: f64, path: &str) -> Result<f64, SceneError> {
    check(value, value.is_finite(), path, "give a finite number")?;
    check(value, value.abs() <= MOST, path, UNITS)
}

/// Refuses what is not a positive finite number, or too large or small to compute with.
pub(crate) fn positive(value: f64, path: &str) -> Result<f64, SceneError> {
    check(value, value.is_finite() && value > 0.0, path, "give a positive finite number")?;
    check(value, (LEAST..=MOST).contains(&value), path, UNITS)
}

/// Refuses what is neither zero nor a positive number to compute with.
pub(crate) fn non_negative(value: f64, path: &str) -> Result<f64, SceneError> {
    let good = value.is_finite() && value >= 0.0;
    check(value, good, path, "give a finite number of 0 or more")?;
    check(value, value == 0.0 || (LEAST..=MOST).contains(&value), path, UNITS)
}

/// Refuses what is not in [0, 1].
pub(crate) fn unit_interval(value: f64, path: &str) -> Result<f64, SceneError> {
    check(value, (0.0..=1.0).contains(&value), path, "give a number from 0 to 1")
}

/// Refuses a mass from density and shapes that is too large or small to compute with.
pub(crate) fn derived(mass: f64, path: &str) -> Result<f64, SceneError> {
    if (LEAST..=MOST).contains(&mass) {
        return Ok(mass);
    }
    Err(SceneError::DerivedMass { path: path.into(), mass })
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

/// Longer names are refused: every message would repeat them.
const LONGEST_NAME: usize = 200;
/// How many names a message lists.
const LISTED: usize = 12;

/// The names of one kind of thing.
pub(crate) struct Names {
    /// Index by name.
    index: BTreeMap<String, usize>,
    /// The first names, for messages.
    known: String,
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
        given: impl Iterator<Item = &'a String> + Clone,
        list: &str,
        what: &'static str,
    ) -> Result<Self, SceneError> {
        let mut index = BTreeMap::new();
        for (i, name) in given.clone().enumerate() {
            let taken = index.contains_key(name);
            if let Some(reason) = objection(name, taken) {
                let (path, name) = (format!("{list}[{i}].name"), shortened(name));
                return Err(SceneError::BadName { path, name, reason });
            }
            index.insert(name.clone(), i);
        }
        let mut known: Vec<&str> = given.take(LISTED).map(String::as_str).collect();
        let more = format!("and {} more", index.len().saturating_sub(LISTED));
        if index.len() > LISTED {
            known.push(&more);
        }
        Ok(Self { known: known.join(", "), index, what })
    }

    pub(crate) fn find(&self, name: &str, path: &str) -> Result<usize, SceneError> {
        self.index.get(name).copied().ok_or_else(|| SceneError::UnknownName {
            path: path.into(),
            name: shortened(name),
            what: self.what,
            known: if self.known.is_empty() { "none".into() } else { self.known.clone() },
        })
    }
}

/// Why a name cannot be used.
fn objection(name: &str, taken: bool) -> Option<&'static str> {
    match name {
        "" => Some("give it a name"),
        WORLD => Some("this name stands for the immovable world; choose another"),
        _ if taken => Some("this name is taken; choose another"),
        _ if name.len() > LONGEST_NAME => Some("this name is longer than 200 bytes; shorten it"),
        _ => None,
    }
}

/// A name as messages quote it.
fn shortened(name: &str) -> String {
    if name.len() <= LONGEST_NAME {
        return name.into();
    }
    name.chars().take(40).chain(['…']).collect()
}
