//! rapier2d in double precision: impulses by Gauss–Seidel over soft constraints, in substeps.

use rapier2d_f64::parry::math::Rot2;
use rapier2d_f64::prelude::{
    ColliderBuilder, GenericJoint, MassProperties, PhysicsWorld, PrismaticJointBuilder,
    RevoluteJointBuilder, RigidBodyBuilder, RigidBodyHandle, SharedShape, Vector,
};
use tangency_core::{BodyKind, JointDef, JointKind, Limits, Scene, SceneDef, Shape, State, WORLD};

use crate::engine::{Engine, Refusal, World};

const NAME: &str = "rapier2d-f64";

/// rapier with its defaults but for the number of iterations, and without sleeping.
pub struct Rapier {
    /// Solver iterations, each a substep; 4 by default.
    pub iterations: usize,
}

impl Engine for Rapier {
    fn name(&self) -> String {
        format!("{NAME}, {} it.", self.iterations)
    }

    fn settings(&self) -> String {
        format!(
            "{} solver iterations (default 4), no sleeping, else defaults: soft contacts of 30 Hz and \
             joints of 10⁶ Hz, contacts predicted 2 mm ahead, warm starts; one thread, no SIMD; no \
             gradient",
            self.iterations
        )
    }

    fn build(&self, def: &SceneDef) -> Result<Box<dyn World + '_>, Refusal> {
        if !def.forces.is_empty() {
            return Err(unsupported("force in time"));
        }
        let scene = Scene::new(def)?;
        let mut world = PhysicsWorld::new();
        world.gravity = vector(def.gravity);
        world.integration_parameters.dt = def.dt;
        world.integration_parameters.num_solver_iterations = self.iterations;
        let mut bodies = Vec::new();
        for index in 0..def.bodies.len() {
            bodies.push(add_body(&mut world, &scene, index)?);
        }
        let ground = world.insert_body(RigidBodyBuilder::fixed());
        for joint in &def.joints {
            add_joint(&mut world, &scene, &bodies, ground, joint)?;
        }
        Ok(Box::new(RapierWorld { world, bodies, dt: def.dt, steps: 0 }))
    }
}

fn unsupported(what: &str) -> Refusal {
    Refusal::Unsupported { engine: NAME, what: what.into() }
}

fn vector([x, y]: [f64; 2]) -> Vector {
    Vector::new(x, y)
}

/// The body's frame is at its centre of mass, as in our states.
fn add_body(
    world: &mut PhysicsWorld,
    scene: &Scene,
    index: usize,
) -> Result<RigidBodyHandle, Refusal> {
    let (body, state) = (&scene.bodies()[index], scene.initial_state());
    let (q, v) = (state.q[index], state.v[index]);
    let builder = match body.kind {
        BodyKind::Dynamic => RigidBodyBuilder::dynamic(),
        BodyKind::Static => RigidBodyBuilder::fixed(),
        BodyKind::Kinematic => RigidBodyBuilder::kinematic_velocity_based(),
    };
    let mass = MassProperties::new(Vector::ZERO, body.mass.x, body.mass.z);
    let handle = world.insert_body(
        builder
            .translation(Vector::new(q.x, q.y))
            .rotation(q.z)
            .linvel(Vector::new(v.x, v.y))
            .angvel(v.z)
            .gravity_scale(body.gravity_scale)
            .additional_mass_properties(mass)
            .can_sleep(false),
    );
    for shape in scene.colliders()[index].shapes() {
        let collider =
            collider(shape)?.density(0.0).friction(body.friction).restitution(body.restitution);
        world.colliders.insert_with_parent(collider, handle, &mut world.bodies);
    }
    Ok(handle)
}

fn collider(shape: &Shape) -> Result<ColliderBuilder, Refusal> {
    Ok(match shape {
        Shape::Circle { radius, center } => {
            ColliderBuilder::ball(*radius).translation(vector(*center))
        }
        Shape::Rectangle { width, height, center, angle } => {
            let at = ColliderBuilder::cuboid(0.5 * width, 0.5 * height).rotation(*angle);
            at.translation(vector(*center))
        }
        Shape::Polygon { points } => {
            let points: Vec<Vector> = points.iter().copied().map(vector).collect();
            ColliderBuilder::convex_hull(&points).ok_or_else(|| unsupported("such polygon"))?
        }
        Shape::Capsule { a, b, radius } => {
            ColliderBuilder::capsule_from_endpoints(vector(*a), vector(*b), *radius)
        }
        Shape::HalfPlane { normal, offset } => {
            let normal = vector(*normal).normalize();
            ColliderBuilder::new(SharedShape::halfspace(normal)).translation(normal * *offset)
        }
    })
}

fn add_joint(
    world: &mut PhysicsWorld,
    scene: &Scene,
    bodies: &[RigidBodyHandle],
    ground: RigidBodyHandle,
    def: &JointDef,
) -> Result<(), Refusal> {
    if def.softness.is_some() {
        return Err(unsupported("counterpart of a soft joint here"));
    }
    let handle = |name: &str| match scene.body_index(name) {
        Some(index) if name != WORLD => bodies[index],
        _ => ground,
    };
    let [a, b] = [handle(&def.bodies[0]), handle(&def.bodies[1])];
    let local = |handle: RigidBodyHandle, point: [f64; 2]| {
        world.bodies[handle].position().inverse_transform_point(vector(point))
    };
    let free = |limits: &Limits| *limits == Limits::default();
    let joint: GenericJoint = match &def.kind {
        JointKind::Revolute { anchor, anchor_b, limits, motor: None } if free(limits) => {
            let end = anchor_b.unwrap_or(*anchor);
            RevoluteJointBuilder::new()
                .local_anchor1(local(a, *anchor))
                .local_anchor2(local(b, end))
                .contacts_enabled(def.collide)
                .into()
        }
        JointKind::Prismatic { anchor, axis, limits, motor: None } if free(limits) => {
            let axis = vector(*axis).normalize();
            let turned = |handle: RigidBodyHandle| {
                Rot2::from_angle(-world.bodies[handle].rotation().angle()) * axis
            };
            PrismaticJointBuilder::new(axis)
                .local_axis1(turned(a))
                .local_axis2(turned(b))
                .local_anchor1(local(a, *anchor))
                .local_anchor2(local(b, *anchor))
                .contacts_enabled(def.collide)
                .into()
        }
        _ => return Err(unsupported("counterpart of such a joint here")),
    };
    world.impulse_joints.insert(a, b, joint, true);
    Ok(())
}

struct RapierWorld {
    world: PhysicsWorld,
    bodies: Vec<RigidBodyHandle>,
    dt: f64,
    steps: u32,
}

impl World for RapierWorld {
    fn step(&mut self) -> Result<(), Refusal> {
        self.world.step();
        self.steps += 1;
        Ok(())
    }

    fn state(&self) -> State {
        let mut state = State { time: self.dt * f64::from(self.steps), ..State::default() };
        for handle in &self.bodies {
            let body = &self.world.bodies[*handle];
            let (at, v) = (body.translation(), body.linvel());
            state.q.push([at.x, at.y, body.rotation().angle()].into());
            state.v.push([v.x, v.y, body.angvel()].into());
        }
        state
    }
}
