//! Parameters: one number that sets one or many numbers of a scene.
//!
//! ```text
//!  name                 sets
//!  mass:links           the mass of every body of the group `links` (one shared number)
//!  total_mass:links     the same, each getting an equal part of it
//!  friction:*           the friction of every body
//!  width:box            the width of the body's rectangles (height, shape_angle; center.x, as of circles)
//!  vertex.2.x:wedge     a component of point 2 of the body's polygons (of a capsule: 0 or 1)
//!  normal.x:floor       of the body's half-planes (offset)
//!  velocity.x:ball      a component of an initial velocity (x, y, angle)
//!  anchor_b.y:hinge     a joint's anchor in b's frame
//!  gravity.y, dt        numbers of the scene itself
//! ```

use tangency_core::{BodyKind, Param, Scene, SceneError, ShapeNumber};

use crate::vector::RolloutVector;

/// A named number, and what it sets: `param = scale · value` for every target.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// The name it was given by.
    pub name: String,
    /// The scene's numbers with their scales.
    pub targets: Vec<(Param, f64)>,
}

/// A parameter that a scene does not have.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ParameterError {
    /// The quantity is not one of those that can be differentiated by.
    #[error("{name:?}: no quantity {quantity:?}; known: {known}")]
    UnknownQuantity {
        /// The parameter's name.
        name: String,
        /// Its quantity.
        quantity: String,
        /// Those there are.
        known: String,
    },
    /// No body, group, joint or force of this name.
    #[error("{name:?}: the scene has no {what} {target:?}")]
    UnknownTarget {
        /// The parameter's name.
        name: String,
        /// What was looked for.
        what: &'static str,
        /// The target.
        target: String,
    },
    /// A component is missing, wrong or superfluous.
    #[error("{name:?}: {expected}")]
    Axis {
        /// The parameter's name.
        name: String,
        /// What it should look like.
        expected: &'static str,
    },
    /// The targets are there but lack this number.
    #[error("{name:?}: {target:?} has no {quantity}")]
    NoSuchNumber {
        /// The parameter's name.
        name: String,
        /// The target.
        target: String,
        /// The quantity.
        quantity: String,
    },
}

const OF_BODIES: [&str; 16] = [
    "mass",
    "total_mass",
    "density",
    "inertia",
    "friction",
    "restitution",
    "radius",
    "width",
    "height",
    "center",
    "shape_angle",
    "vertex",
    "offset",
    "normal",
    "position",
    "velocity",
];
const OF_JOINTS: [&str; 9] = [
    "anchor_a",
    "anchor_b",
    "length",
    "motor_speed",
    "motor_max",
    "stiffness",
    "damping",
    "lower",
    "upper",
];
const OF_SCENE: [&str; 3] = ["gravity", "dt", "force"];

impl Parameter {
    /// Reads a parameter's name for a scene.
    ///
    /// # Errors
    /// [`ParameterError`] that says which part of the name the scene does not have.
    pub fn parse(scene: &Scene, name: &str) -> Result<Self, ParameterError> {
        let (head, target) = name.split_once(':').map_or((name, None), |(h, t)| (h, Some(t)));
        let (quantity, axis) = head.split_once('.').map_or((head, None), |(q, a)| (q, Some(a)));
        let parts = Parts { scene, name, quantity, axis, target };
        let targets = if OF_BODIES.contains(&quantity) {
            parts.of_bodies()?
        } else if OF_JOINTS.contains(&quantity) {
            parts.of_joints()?
        } else {
            parts.of_scene()?
        };
        if targets.is_empty() {
            return Err(parts.no_such_number());
        }
        Ok(Self { name: name.into(), targets })
    }

    /// Reads several names.
    ///
    /// # Errors
    /// As [`Parameter::parse`].
    pub fn parse_all<S: AsRef<str>>(
        scene: &Scene,
        names: &[S],
    ) -> Result<Vec<Self>, ParameterError> {
        names.iter().map(|name| Self::parse(scene, name.as_ref())).collect()
    }

    /// The value that the scene has now (that of the first target).
    ///
    /// # Panics
    /// If the parameter belongs to another scene.
    #[must_use]
    pub fn value(&self, scene: &Scene) -> f64 {
        let (param, scale) = self.targets[0];
        scene.get(param).expect("the parameter was made for this scene") / scale
    }

    /// Sets all targets, or none.
    ///
    /// # Errors
    /// [`SceneError`] where the value is out of range; the scene is then as it was.
    pub fn set(&self, scene: &mut Scene, value: f64) -> Result<(), SceneError> {
        if let [(param, scale)] = self.targets[..] {
            return scene.set(param, scale * value);
        }
        let mut changed = scene.clone();
        self.targets.iter().try_for_each(|(param, scale)| changed.set(*param, scale * value))?;
        *scene = changed;
        Ok(())
    }

    /// ∂L/∂value from the gradient by everything.
    #[must_use]
    pub fn gradient(&self, scene: &Scene, by: &RolloutVector) -> f64 {
        self.targets.iter().map(|(param, scale)| scale * by.by(scene, *param)).sum()
    }

    /// The direction in which a rollout's inputs change with the value.
    #[must_use]
    pub fn direction(&self, scene: &Scene, steps: usize) -> RolloutVector {
        let mut along = RolloutVector::zeros(scene, steps);
        self.targets.iter().for_each(|(param, scale)| along.add(scene, *param, *scale));
        along
    }
}

/// A name taken apart.
struct Parts<'a> {
    scene: &'a Scene,
    name: &'a str,
    quantity: &'a str,
    axis: Option<&'a str>,
    target: Option<&'a str>,
}

impl Parts<'_> {
    fn of_bodies(&self) -> Result<Vec<(Param, f64)>, ParameterError> {
        let bodies = self.bodies()?;
        let scale = if self.quantity == "total_mass" { 1.0 / bodies.len() as f64 } else { 1.0 };
        let mut targets = Vec::new();
        for body in bodies {
            let params = match self.quantity {
                "mass" | "total_mass" => vec![Param::Mass(body)],
                "density" => vec![Param::Density(body)],
                "inertia" => vec![Param::Inertia(body)],
                "friction" => vec![Param::Friction(body)],
                "restitution" => vec![Param::Restitution(body)],
                "position" => vec![Param::Position(body, self.axis(3)?)],
                "velocity" => vec![Param::Velocity(body, self.axis(3)?)],
                _ => self.of_shapes(body)?,
            };
            let exists = |p: &Param| self.scene.get(*p).is_some();
            targets.extend(params.into_iter().filter(exists).map(|p| (p, scale)));
        }
        if !matches!(self.quantity, "position" | "velocity" | "center" | "vertex" | "normal") {
            self.no_axis()?;
        }
        Ok(targets)
    }

    /// The number of each shape of a body.
    fn of_shapes(&self, body: usize) -> Result<Vec<Param>, ParameterError> {
        let number = match self.quantity {
            "width" => ShapeNumber::Size(0),
            "height" => ShapeNumber::Size(1),
            "center" => ShapeNumber::Center(self.axis(2)?),
            "shape_angle" => ShapeNumber::Angle,
            "vertex" => self.vertex()?,
            "offset" => ShapeNumber::Offset,
            "normal" => ShapeNumber::Normal(self.axis(2)?),
            _ => {
                let shapes = 0..self.scene.colliders()[body].shapes().len();
                return Ok(shapes.map(|shape| Param::Radius(body, shape)).collect());
            }
        };
        let shapes = 0..self.scene.colliders()[body].shapes().len();
        Ok(shapes.map(|shape| Param::Shape(body, shape, number)).collect())
    }

    /// `2.x` of `vertex.2.x:wedge`.
    fn vertex(&self) -> Result<ShapeNumber, ParameterError> {
        let parts = self.axis.and_then(|axis| axis.split_once('.'));
        let read = |(k, axis): (&str, &str)| {
            let axis = ["x", "y"].iter().position(|name| *name == axis)?;
            Some(ShapeNumber::Vertex(k.parse().ok()?, axis))
        };
        let expected = "name a point and a component, as in `vertex.2.x:wedge`";
        let wrong = || ParameterError::Axis { name: self.name.into(), expected };
        parts.and_then(read).ok_or_else(wrong)
    }

    fn of_joints(&self) -> Result<Vec<(Param, f64)>, ParameterError> {
        let joints = self.joints()?;
        let mut targets = Vec::new();
        for joint in joints {
            let param = match self.quantity {
                "anchor_a" => Param::AnchorA(joint, self.axis(2)?),
                "anchor_b" => Param::AnchorB(joint, self.axis(2)?),
                "length" => Param::Length(joint),
                "motor_speed" => Param::MotorSpeed(joint),
                "motor_max" => Param::MotorMax(joint),
                "stiffness" => Param::Stiffness(joint),
                "damping" => Param::Damping(joint),
                "lower" => Param::Lower(joint),
                _ => Param::Upper(joint),
            };
            if self.scene.get(param).is_some() {
                targets.push((param, 1.0));
            }
        }
        if !self.quantity.starts_with("anchor") {
            self.no_axis()?;
        }
        Ok(targets)
    }

    fn of_scene(&self) -> Result<Vec<(Param, f64)>, ParameterError> {
        let param = match self.quantity {
            "gravity" => Param::Gravity(self.axis(2)?),
            "dt" => {
                self.no_axis()?;
                Param::Dt
            }
            "force" => {
                let index = self.target.unwrap_or_default();
                let unknown = || self.unknown_target("force", index);
                let force = index.parse().map_err(|_| unknown())?;
                let param = Param::Force(force, self.axis(3)?);
                self.scene.get(param).ok_or_else(unknown)?;
                return Ok(vec![(param, 1.0)]);
            }
            _ => return Err(self.unknown_quantity()),
        };
        if self.target.is_some() {
            let expected = "this quantity belongs to the scene itself; leave out what follows `:`";
            return Err(ParameterError::Axis { name: self.name.into(), expected });
        }
        Ok(vec![(param, 1.0)])
    }

    /// Bodies by name, by group, or all dynamic ones.
    fn bodies(&self) -> Result<Vec<usize>, ParameterError> {
        let target = self.target.unwrap_or_default();
        let matches = |b: &&tangency_core::Body| match target {
            "*" => b.kind == BodyKind::Dynamic || self.quantity == "friction",
            _ => b.name == target || b.groups.iter().any(|g| g == target),
        };
        let all = self.scene.bodies();
        let found: Vec<usize> = (0..all.len()).filter(|i| matches(&&all[*i])).collect();
        if found.is_empty() { Err(self.unknown_target("body or group", target)) } else { Ok(found) }
    }

    fn joints(&self) -> Result<Vec<usize>, ParameterError> {
        let target = self.target.unwrap_or_default();
        let all = self.scene.joints();
        let found: Vec<usize> =
            (0..all.len()).filter(|j| target == "*" || all[*j].name == target).collect();
        if found.is_empty() { Err(self.unknown_target("joint", target)) } else { Ok(found) }
    }

    fn axis(&self, axes: usize) -> Result<usize, ParameterError> {
        let found = ["x", "y", "angle"].iter().take(axes).position(|a| Some(*a) == self.axis);
        let expected = match axes {
            2 => "name a component, as in `gravity.y` (x or y)",
            _ => "name a component, as in `velocity.x:ball` (x, y or angle)",
        };
        found.ok_or_else(|| ParameterError::Axis { name: self.name.into(), expected })
    }

    fn no_axis(&self) -> Result<(), ParameterError> {
        if self.axis.is_none() {
            return Ok(());
        }
        let expected = "this quantity has no components; leave out what follows `.`";
        Err(ParameterError::Axis { name: self.name.into(), expected })
    }

    fn unknown_quantity(&self) -> ParameterError {
        let known = [&OF_BODIES[..], &OF_JOINTS, &OF_SCENE].concat().join(", ");
        let (name, quantity) = (self.name.into(), self.quantity.into());
        ParameterError::UnknownQuantity { name, quantity, known }
    }

    fn unknown_target(&self, what: &'static str, target: &str) -> ParameterError {
        ParameterError::UnknownTarget { name: self.name.into(), what, target: target.into() }
    }

    fn no_such_number(&self) -> ParameterError {
        let target = self.target.unwrap_or_default().into();
        let (name, quantity) = (self.name.into(), self.quantity.into());
        ParameterError::NoSuchNumber { name, target, quantity }
    }
}
