//! Vectors that stand beside states and scenes: gradients and directions have the same shape.

use nalgebra::{Vector2, Vector3};
use serde::{Deserialize, Serialize};
use tangency_core::{Param, Scene, State};

/// A gradient by, or a direction of, a [`State`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StateVector {
    /// By time.
    pub time: f64,
    /// By poses (x, y, θ), one per body.
    pub q: Vec<Vector3<f64>>,
    /// By velocities (v_x, v_y, ω), one per body.
    pub v: Vec<Vector3<f64>>,
}

impl StateVector {
    /// Zero, for a number of bodies.
    #[must_use]
    pub fn zeros(bodies: usize) -> Self {
        Self { time: 0.0, q: vec![Vector3::zeros(); bodies], v: vec![Vector3::zeros(); bodies] }
    }

    /// Zero, of the size of a state.
    #[must_use]
    pub fn like(state: &State) -> Self {
        Self::zeros(state.q.len())
    }

    /// Adds another.
    pub fn add(&mut self, other: &Self) {
        self.time += other.time;
        self.q.iter_mut().zip(&other.q).for_each(|(a, b)| *a += b);
        self.v.iter_mut().zip(&other.v).for_each(|(a, b)| *a += b);
    }

    /// Adds a multiple of another.
    pub fn add_scaled(&mut self, factor: f64, other: &Self) {
        self.time += factor * other.time;
        self.q.iter_mut().zip(&other.q).for_each(|(a, b)| *a += b * factor);
        self.v.iter_mut().zip(&other.v).for_each(|(a, b)| *a += b * factor);
    }

    /// Inner product.
    #[must_use]
    pub fn dot(&self, other: &Self) -> f64 {
        let inner = |a: &[Vector3<f64>], b: &[Vector3<f64>]| -> f64 {
            a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
        };
        self.time * other.time + inner(&self.q, &other.q) + inner(&self.v, &other.v)
    }
}

/// By the numbers of one body.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BodyVector {
    /// By the diagonal of the mass matrix (m, m, I), each entry by itself.
    pub mass: Vector3<f64>,
    /// By friction.
    pub friction: f64,
    /// By restitution.
    pub restitution: f64,
    /// By the radii of its circles and capsules, one per shape.
    pub radii: Vec<f64>,
    /// By the vertices of its shapes in the body's frame, one shape after the other, numbered as
    /// [`Part::Vertex`](tangency_collision::Part::Vertex); of a half-plane by the point of its line that is
    /// nearest to the origin.
    pub vertices: Vec<Vector2<f64>>,
    /// By the directions of the normals of its half-planes, rad, one per shape.
    pub turns: Vec<f64>,
}

/// By the numbers of one joint.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JointVector {
    /// By the anchors in the bodies' frames.
    pub anchors: [Vector2<f64>; 2],
    /// By the reference of the first held row: the length of distance joints and springs.
    pub length: f64,
    /// By the motor's target speed.
    pub motor_speed: f64,
    /// By the motor's greatest torque or force.
    pub motor_max: f64,
    /// By the stiffness.
    pub stiffness: f64,
    /// By the damping.
    pub damping: f64,
    /// By the lower limit.
    pub lower: f64,
    /// By the upper limit.
    pub upper: f64,
}

/// A gradient by, or a direction of, the numbers of a [`Scene`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SceneVector {
    /// By gravity.
    pub gravity: Vector2<f64>,
    /// By the time step.
    pub dt: f64,
    /// Per body.
    pub bodies: Vec<BodyVector>,
    /// Per joint.
    pub joints: Vec<JointVector>,
    /// By the wrenches of the scene's forces.
    pub forces: Vec<Vector3<f64>>,
}

impl SceneVector {
    /// Zero, of the size of a scene.
    #[must_use]
    pub fn like(scene: &Scene) -> Self {
        let body = |i: usize| {
            let collider = &scene.colliders()[i];
            let shapes = collider.shapes().len();
            BodyVector {
                radii: vec![0.0; shapes],
                vertices: vec![Vector2::zeros(); collider.vertex_count()],
                turns: vec![0.0; shapes],
                ..BodyVector::default()
            }
        };
        Self {
            gravity: Vector2::zeros(),
            dt: 0.0,
            bodies: (0..scene.bodies().len()).map(body).collect(),
            joints: vec![JointVector::default(); scene.joints().len()],
            forces: vec![Vector3::zeros(); scene.forces().len()],
        }
    }
}

/// Where the gradient by what one step depends on is collected.
#[derive(Debug)]
pub(crate) struct Bars<'a> {
    /// By the state before the step.
    pub(crate) state: &'a mut StateVector,
    /// By the control of the step, one number per channel.
    pub(crate) control: &'a mut [f64],
    /// By the scene's numbers.
    pub(crate) scene: &'a mut SceneVector,
}

/// A direction of what one step depends on.
#[derive(Clone, Copy, Debug)]
pub struct Direction<'a> {
    /// Of the state before the step.
    pub state: &'a StateVector,
    /// Of the control of the step, one number per channel.
    pub control: &'a [f64],
    /// Of the scene's numbers.
    pub scene: &'a SceneVector,
}

/// By everything that a rollout depends on.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RolloutVector {
    /// By the initial state.
    pub initial: StateVector,
    /// By the controls, steps × channels.
    pub controls: Vec<Vec<f64>>,
    /// By the scene's numbers.
    pub scene: SceneVector,
}

impl RolloutVector {
    /// Zero, for a scene and a number of steps.
    #[must_use]
    pub fn zeros(scene: &Scene, steps: usize) -> Self {
        Self {
            initial: StateVector::zeros(scene.bodies().len()),
            controls: vec![vec![0.0; scene.controls().len()]; steps],
            scene: SceneVector::like(scene),
        }
    }

    /// The derivative by one number of the scene: what depends on it (an inertia that follows the
    /// mass, say) is taken along.
    ///
    /// ```text
    ///  m ↦ (m, m, I m/m₀):  ∂/∂m = ḡ_x + ḡ_y + ḡ_I I/m        ρ ↦ m = ρ A:  ∂/∂ρ = A ∂/∂m
    /// ```
    #[must_use]
    pub fn by(&self, scene: &Scene, param: Param) -> f64 {
        let joint = |j: usize| &self.scene.joints[j];
        match param {
            Param::Mass(i) => self.scene.bodies[i].mass.dot(&mass_direction(scene, i)),
            Param::Density(i) => self.by(scene, Param::Mass(i)) * scene.bodies()[i].area,
            Param::Inertia(i) => self.scene.bodies[i].mass.z,
            Param::Friction(i) => self.scene.bodies[i].friction,
            Param::Restitution(i) => self.scene.bodies[i].restitution,
            Param::Radius(i, k) => self.scene.bodies[i].radii[k],
            Param::Shape(i, k, number) => {
                let change = scene.colliders()[i].shapes()[k].outline_change(number);
                let body = &self.scene.bodies[i];
                let vertices = &body.vertices[scene.colliders()[i].first_vertex(k)..];
                let moved: f64 = change.vertices.iter().zip(vertices).map(|(c, v)| c.dot(v)).sum();
                moved + change.turn * body.turns[k]
            }
            Param::Position(i, axis) => self.initial.q[i][axis],
            Param::Velocity(i, axis) => self.initial.v[i][axis],
            Param::Gravity(axis) => self.scene.gravity[axis],
            Param::Dt => self.scene.dt,
            Param::AnchorA(j, axis) => joint(j).anchors[0][axis],
            Param::AnchorB(j, axis) => joint(j).anchors[1][axis],
            Param::Length(j) => joint(j).length,
            Param::MotorSpeed(j) => joint(j).motor_speed,
            Param::MotorMax(j) => joint(j).motor_max,
            Param::Stiffness(j) => joint(j).stiffness,
            Param::Damping(j) => joint(j).damping,
            Param::Lower(j) => joint(j).lower,
            Param::Upper(j) => joint(j).upper,
            Param::Force(f, axis) => self.scene.forces[f][axis],
        }
    }

    /// Adds to a direction what changing one number of the scene at a rate does: the transpose of
    /// [`by`](Self::by).
    pub fn add(&mut self, scene: &Scene, param: Param, rate: f64) {
        let joints = &mut self.scene.joints;
        match param {
            Param::Mass(i) => self.scene.bodies[i].mass += rate * mass_direction(scene, i),
            Param::Density(i) => self.add(scene, Param::Mass(i), rate * scene.bodies()[i].area),
            Param::Inertia(i) => self.scene.bodies[i].mass.z += rate,
            Param::Friction(i) => self.scene.bodies[i].friction += rate,
            Param::Restitution(i) => self.scene.bodies[i].restitution += rate,
            Param::Radius(i, k) => self.scene.bodies[i].radii[k] += rate,
            Param::Shape(i, k, number) => {
                let change = scene.colliders()[i].shapes()[k].outline_change(number);
                let body = &mut self.scene.bodies[i];
                let vertices = &mut body.vertices[scene.colliders()[i].first_vertex(k)..];
                vertices.iter_mut().zip(&change.vertices).for_each(|(v, c)| *v += rate * c);
                body.turns[k] += rate * change.turn;
            }
            Param::Position(i, axis) => self.initial.q[i][axis] += rate,
            Param::Velocity(i, axis) => self.initial.v[i][axis] += rate,
            Param::Gravity(axis) => self.scene.gravity[axis] += rate,
            Param::Dt => self.scene.dt += rate,
            Param::AnchorA(j, axis) => joints[j].anchors[0][axis] += rate,
            Param::AnchorB(j, axis) => joints[j].anchors[1][axis] += rate,
            Param::Length(j) => joints[j].length += rate,
            Param::MotorSpeed(j) => joints[j].motor_speed += rate,
            Param::MotorMax(j) => joints[j].motor_max += rate,
            Param::Stiffness(j) => joints[j].stiffness += rate,
            Param::Damping(j) => joints[j].damping += rate,
            Param::Lower(j) => joints[j].lower += rate,
            Param::Upper(j) => joints[j].upper += rate,
            Param::Force(f, axis) => self.scene.forces[f][axis] += rate,
        }
    }
}

/// How (m, m, I) changes with the mass.
fn mass_direction(scene: &Scene, i: usize) -> Vector3<f64> {
    let body = &scene.bodies()[i];
    let inertia = if body.inertia_follows_mass { body.mass.z / body.mass.x } else { 0.0 };
    Vector3::new(1.0, 1.0, inertia)
}
