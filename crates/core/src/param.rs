//! The numbers of a scene that may be read, changed, and differentiated by.

use serde::{Deserialize, Serialize};
use tangency_collision::{Collider, Shape, ShapeError, ShapeNumber};

use crate::compile::{conflict, derived, finite, non_negative, positive, unit_interval};
use crate::{BodyKind, Scene, SceneError};

/// One number of a scene. Bodies, joints and forces by index; axes 0, 1, 2 are x, y, angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Param {
    /// Mass of a body, kg. An inertia that was not given scales along.
    Mass(usize),
    /// Density of a body, kg/m². Mass and (unless given) inertia follow.
    Density(usize),
    /// Moment of inertia of a body, kg·m², its mass unchanged.
    Inertia(usize),
    /// Friction coefficient of a body.
    Friction(usize),
    /// Restitution of a body.
    Restitution(usize),
    /// Radius of a circle or capsule (body, shape), m; mass and inertia unchanged.
    Radius(usize, usize),
    /// Another number of a shape (body, shape), in the body's frame, whose origin is the centre of mass;
    /// mass, inertia and that origin unchanged.
    Shape(usize, usize, ShapeNumber),
    /// Initial pose of a body (axis 0, 1: m; 2: rad).
    Position(usize, usize),
    /// Initial velocity of a body (axis 0, 1: m/s; 2: rad/s).
    Velocity(usize, usize),
    /// Gravity (axis 0, 1), m/s².
    Gravity(usize),
    /// Time step, s.
    Dt,
    /// Anchor of a joint in a's frame (axis 0, 1), m.
    AnchorA(usize, usize),
    /// Anchor of a joint in b's frame (axis 0, 1), m.
    AnchorB(usize, usize),
    /// Length of a distance joint or spring, m.
    Length(usize),
    /// Target speed of a motor, rad/s or m/s.
    MotorSpeed(usize),
    /// Greatest torque or force of a motor, N·m or N.
    MotorMax(usize),
    /// Stiffness of a spring or soft joint, N/m.
    Stiffness(usize),
    /// Damping of a spring or soft joint, N·s/m.
    Damping(usize),
    /// Lower limit of a joint, rad or m.
    Lower(usize),
    /// Upper limit of a joint, rad or m.
    Upper(usize),
    /// A force's component (axis 0, 1: N; 2: N·m).
    Force(usize, usize),
}

impl Scene {
    /// Reads a number; `None` where the scene has no such number.
    #[must_use]
    pub fn get(&self, param: Param) -> Option<f64> {
        let joint = |j: usize| self.joints.get(j);
        match param {
            Param::Mass(i) => self.dynamic(i).map(|b| b.mass.x),
            Param::Density(i) => {
                self.dynamic(i).filter(|b| b.area > 0.0).map(|b| b.mass.x / b.area)
            }
            Param::Inertia(i) => self.dynamic(i).map(|b| b.mass.z),
            Param::Friction(i) => self.bodies.get(i).map(|b| b.friction),
            Param::Restitution(i) => self.bodies.get(i).map(|b| b.restitution),
            Param::Radius(i, k) => match self.colliders.get(i)?.shapes().get(k)? {
                Shape::Circle { radius, .. } | Shape::Capsule { radius, .. } => Some(*radius),
                _ => None,
            },
            Param::Shape(i, k, number) => self.colliders.get(i)?.shapes().get(k)?.number(number),
            Param::Position(i, axis) => self.initial.q.get(i)?.get(axis).copied(),
            Param::Velocity(i, axis) => self.initial.v.get(i)?.get(axis).copied(),
            Param::Gravity(axis) => self.gravity.get(axis).copied(),
            Param::Dt => Some(self.dt),
            Param::AnchorA(j, axis) => joint(j)?.anchors[0].get(axis).copied(),
            Param::AnchorB(j, axis) => joint(j)?.anchors[1].get(axis).copied(),
            Param::Length(j) => joint(j)?.length_row().map(|row| row.reference),
            Param::MotorSpeed(j) => joint(j)?.motor.map(|m| m.speed),
            Param::MotorMax(j) => joint(j)?.motor?.max,
            Param::Stiffness(j) => joint(j)?.softness.map(|s| s.stiffness),
            Param::Damping(j) => joint(j)?.softness.map(|s| s.damping),
            Param::Lower(j) => joint(j)?.limits.lower,
            Param::Upper(j) => joint(j)?.limits.upper,
            Param::Force(f, axis) => self.forces.get(f)?.wrench.get(axis).copied(),
        }
    }

    /// Changes a number. The definition that [`Scene::def`] returns stays as it was.
    ///
    /// # Errors
    /// [`SceneError`] where the scene has no such number or the value is out of its range.
    pub fn set(&mut self, param: Param, value: f64) -> Result<(), SceneError> {
        let path = format!("{param:?}");
        if self.get(param).is_none() {
            let reason = "the scene has no such number; check its index and kind";
            return Err(SceneError::Conflict { path, reason });
        }
        match param {
            Param::Mass(_)
            | Param::Density(_)
            | Param::Inertia(_)
            | Param::Radius(..)
            | Param::Dt
            | Param::Length(_)
            | Param::MotorMax(_) => positive(value, &path)?,
            Param::Friction(_) | Param::Stiffness(_) | Param::Damping(_) => {
                non_negative(value, &path)?
            }
            Param::Restitution(_) => unit_interval(value, &path)?,
            _ => finite(value, &path)?,
        };
        self.check_fits(param, value, &path)?;
        self.write(param, value).map_err(|source| SceneError::Shape { path, source })
    }

    /// Refuses a number in range that contradicts others of the scene.
    fn check_fits(&self, param: Param, value: f64, path: &str) -> Result<(), SceneError> {
        let limits = |j: usize| self.joints[j].limits;
        let refuse = |expected| {
            let path = path.into();
            Err(SceneError::Value { path, value, expected })
        };
        match param {
            Param::Density(i) => derived(value * self.bodies[i].area, path).map(drop),
            Param::Lower(j) if limits(j).upper.is_some_and(|upper| value > upper) => {
                refuse("give a lower limit that is not above the upper one")
            }
            Param::Upper(j) if limits(j).lower.is_some_and(|lower| value < lower) => {
                refuse("give an upper limit that is not below the lower one")
            }
            Param::Velocity(i, _) if self.bodies[i].kind == BodyKind::Static && value != 0.0 => {
                conflict(path.into(), "a static body cannot move; make it kinematic")
            }
            _ => Ok(()),
        }
    }

    /// Writes a number that is known to exist and to be in range; it may not fit its shape.
    fn write(&mut self, param: Param, value: f64) -> Result<(), ShapeError> {
        match param {
            Param::Mass(i) => self.write_mass(i, value),
            Param::Density(i) => self.write_mass(i, value * self.bodies[i].area),
            Param::Inertia(i) => self.bodies[i].mass.z = value,
            Param::Friction(i) => self.bodies[i].friction = value,
            Param::Restitution(i) => self.bodies[i].restitution = value,
            Param::Radius(i, k) => return self.write_radius(i, k, value),
            Param::Shape(i, k, number) => {
                let shape = self.colliders[i].shapes()[k].with_number(number, value)?;
                return self.write_shape(i, k, shape);
            }
            Param::Position(i, axis) => self.initial.q[i][axis] = value,
            Param::Velocity(i, axis) => self.initial.v[i][axis] = value,
            Param::Gravity(axis) => self.gravity[axis] = value,
            Param::Dt => self.dt = value,
            Param::AnchorA(j, axis) => self.joints[j].anchors[0][axis] = value,
            Param::AnchorB(j, axis) => self.joints[j].anchors[1][axis] = value,
            Param::Length(j) => self.joints[j].held[0].reference = value,
            Param::MotorSpeed(j) => self.joints[j].motor.iter_mut().for_each(|m| m.speed = value),
            Param::MotorMax(j) => self.joints[j].motor.iter_mut().for_each(|m| m.max = Some(value)),
            Param::Stiffness(j) => {
                self.joints[j].softness.iter_mut().for_each(|s| s.stiffness = value);
            }
            Param::Damping(j) => self.joints[j].softness.iter_mut().for_each(|s| s.damping = value),
            Param::Lower(j) => self.joints[j].limits.lower = Some(value),
            Param::Upper(j) => self.joints[j].limits.upper = Some(value),
            Param::Force(f, axis) => self.forces[f].wrench[axis] = value,
        }
        Ok(())
    }

    fn write_mass(&mut self, i: usize, mass: f64) {
        let body = &mut self.bodies[i];
        if body.inertia_follows_mass {
            body.mass.z *= mass / body.mass.x;
        }
        body.mass.x = mass;
        body.mass.y = mass;
    }

    fn write_radius(&mut self, i: usize, k: usize, value: f64) -> Result<(), ShapeError> {
        let mut shape = self.colliders[i].shapes()[k].clone();
        if let Shape::Circle { radius, .. } | Shape::Capsule { radius, .. } = &mut shape {
            *radius = value;
        }
        self.write_shape(i, k, shape)
    }

    fn write_shape(&mut self, i: usize, k: usize, shape: Shape) -> Result<(), ShapeError> {
        let mut shapes = self.colliders[i].shapes().to_vec();
        shapes[k] = shape;
        self.colliders[i] = Collider::new(&shapes)?;
        Ok(())
    }

    fn dynamic(&self, i: usize) -> Option<&crate::Body> {
        self.bodies.get(i).filter(|b| b.kind == BodyKind::Dynamic)
    }
}

impl crate::Joint {
    /// Whether it holds a distance.
    pub(crate) fn holds_length(&self) -> bool {
        self.length_row().is_some()
    }

    /// The row whose reference is a length.
    fn length_row(&self) -> Option<&crate::JointRow> {
        self.held.first().filter(|row| row.measure == crate::measure::Measure::Length)
    }
}
