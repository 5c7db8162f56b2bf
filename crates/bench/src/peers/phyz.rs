//! phyz: a spatial engine in reduced coordinates with an implicit adjoint.
//!
//! The plane's (x, y) becomes its (x, z); a rotation counter-clockwise in the plane is one about −y:
//!
//! ```text
//!  R = ⎡cos θ  0  −sin θ⎤      every body's frame is parallel to the world's at the start;
//!      ⎢  0    1     0  ⎥      a jointed body's frame is at its joint, its centre of mass at `com`
//!      ⎣sin θ  0   cos θ⎦
//! ```

use phyz::contact::{ContactMaterial, ContactSolverConfig};
use phyz::diff::{
    AdjointRollout, ConvexContactRollout, FinalStateObjective, adjoint_rollout_gradient,
    convex_adjoint_gradient,
};
use phyz::math::{DVec, Mat3, SpatialInertia, SpatialTransform, Vec3};
use phyz::model::{Body, Geometry, Joint, Model, ModelBuilder};
use phyz::{Simulator, forward_kinematics};
use tangency_core::{JointKind, Limits, Scene, SceneDef, Shape, State, WORLD};

use crate::engine::{Engine, Refusal, ValueAndGradient, World};

const NAME: &str = "phyz";

/// phyz with its defaults.
pub struct Phyz;

/// Most bodies that may touch: with 55 a step takes seconds, and beyond minutes.
const MOST: usize = 60;

impl Engine for Phyz {
    fn name(&self) -> String {
        NAME.into()
    }

    fn settings(&self) -> String {
        "defaults; three dimensions (discs are balls, boxes 1 m deep with four contacts a face), joints \
         in reduced coordinates, soft convex contacts with a margin; gradients by its adjoint"
            .into()
    }

    fn build(&self, def: &SceneDef) -> Result<Box<dyn World + '_>, Refusal> {
        Ok(Box::new(Translation::new(def)?.world()))
    }

    fn value_and_gradient(
        &self,
        def: &SceneDef,
        steps: usize,
    ) -> Result<Option<ValueAndGradient<'_>>, Refusal> {
        let translation = Translation::new(def)?;
        Ok(Some(Box::new(move || {
            if translation.touches {
                translation.through_contacts(steps)
            } else {
                Ok(translation.jointed(steps))
            }
        })))
    }
}

fn unsupported(what: &str) -> Refusal {
    Refusal::Unsupported { engine: NAME, what: what.into() }
}

/// A scene in phyz's terms.
struct Translation {
    model: Model,
    material: ContactMaterial,
    /// Whether anything can touch.
    touches: bool,
    /// Of every dynamic body, in the order of phyz: index in the scene, centre of mass in its frame.
    places: Vec<(usize, Vec3)>,
    /// Index of the x coordinate of the last body, or of its joint's.
    last: usize,
    q: DVec,
    v: DVec,
    initial: State,
}

impl Translation {
    fn new(def: &SceneDef) -> Result<Self, Refusal> {
        let scene = Scene::new(def)?;
        let initial = scene.initial_state();
        let mut builder =
            ModelBuilder::new().gravity(Vec3::new(def.gravity[0], 0.0, def.gravity[1])).dt(def.dt);
        let (mut places, mut frames, mut touches) = (Vec::new(), Vec::new(), false);
        let (mut q, mut v) = (Vec::new(), Vec::new());
        for (index, body) in scene.bodies().iter().enumerate() {
            if !scene.is_dynamic(index) {
                ground(scene.colliders()[index].shapes())?;
                touches = true;
                continue;
            }
            let Rooted { joint, parent, origin } = rooted(def, &scene, index, &places, &frames)?;
            let at = initial.q[index];
            let com = Vec3::new(at.x - origin.x, 0.0, at.y - origin.z);
            let inertia = Mat3::from_diagonal(&Vec3::new(body.mass.z, body.mass.z, body.mass.z));
            let inertia = SpatialInertia::new(body.mass.x, com, inertia);
            if joint.ndof() == 6 {
                let rate = initial.v[index];
                q.extend([0.0, -at.z, 0.0, at.x, 0.0, at.y]);
                let (sin, cos) = at.z.sin_cos();
                let along = [rate.x * cos + rate.y * sin, 0.0, rate.y * cos - rate.x * sin];
                v.extend([0.0, -rate.z, 0.0]);
                v.extend(along);
            } else {
                q.push(0.0);
                v.push(0.0);
            }
            let link = i32::try_from(places.len()).unwrap_or(i32::MAX);
            builder = builder.add_body(&body.name, parent, joint, inertia);
            places.push((index, com));
            frames.push((link, origin));
        }
        if touches && places.len() > MOST {
            return Err(unsupported("contact solve of so many bodies that ends within minutes"));
        }
        let mut model = builder.build();
        for ((index, _), body) in places.iter().zip(&mut model.bodies) {
            shape(scene.colliders()[*index].shapes(), body)?;
        }
        let surface = scene.bodies().first();
        let material = ContactMaterial {
            friction: surface.map_or(0.0, |body| body.friction),
            restitution: surface.map_or(0.0, |body| body.restitution),
            ..ContactMaterial::default()
        };
        let free = model.joints.last().is_some_and(|joint| joint.ndof() == 6);
        let last = if free { q.len() - 3 } else { q.len() - 1 };
        let (q, v) = (DVec::from_slice(&q), DVec::from_slice(&v));
        Ok(Self { model, material, touches, places, last, q, v, initial })
    }

    fn world(self) -> PhyzWorld {
        let mut state = self.model.default_state();
        (state.q, state.v) = (self.q.clone(), self.v.clone());
        PhyzWorld { simulator: Simulator::new(), state, translation: self }
    }

    fn objective<R>(&self, work: impl FnOnce(&FinalStateObjective<'_>) -> R) -> R {
        let last = self.last;
        work(&FinalStateObjective {
            value: &move |q: &[f64], _: &[f64]| q[last],
            gradient: &move |q: &[f64], v: &[f64]| {
                let mut by = vec![0.0; q.len()];
                by[last] = 1.0;
                (by, vec![0.0; v.len()])
            },
        })
    }

    fn through_contacts(&self, steps: usize) -> Result<f64, Refusal> {
        let dof = self.model.nv;
        let rollout = ConvexContactRollout {
            model: &self.model,
            ground_height: 0.0,
            material: self.material.clone(),
            config: ContactSolverConfig::simulation(),
            q0: self.q.clone(),
            v0: self.v.clone(),
            steps,
            ctrl: &move |_| DVec::zeros(dof),
        };
        let found = self.objective(|objective| convex_adjoint_gradient(&rollout, objective));
        match found {
            Ok(found) => Ok(found.objective),
            Err(error) => Err(Refusal::Peer { engine: NAME, message: error.to_string() }),
        }
    }

    fn jointed(&self, steps: usize) -> f64 {
        let dof = self.model.nv;
        let rollout = AdjointRollout {
            model: &self.model,
            contact: None,
            q0: self.q.as_slice().to_vec(),
            v0: self.v.as_slice().to_vec(),
            steps,
            ctrl: &move |_| DVec::zeros(dof),
        };
        self.objective(|objective| adjoint_rollout_gradient(&rollout, objective)).objective
    }
}

/// Its ground is the half space z ≤ 0.
fn ground(shapes: &[Shape]) -> Result<(), Refusal> {
    match shapes {
        [Shape::HalfPlane { normal: [0.0, up], offset: 0.0 }] if *up > 0.0 => Ok(()),
        _ => Err(unsupported("ground but a level one at height 0")),
    }
}

fn shape(shapes: &[Shape], body: &mut Body) -> Result<(), Refusal> {
    body.geometry = match shapes {
        [] => None,
        [Shape::Circle { radius, center: [0.0, 0.0] }] => {
            Some(Geometry::Sphere { radius: *radius })
        }
        [Shape::Rectangle { width, height, center: [0.0, 0.0], angle: 0.0 }] => {
            let half_extents = Vec3::new(0.5 * width, 0.5, 0.5 * height);
            Some(Geometry::Box { half_extents })
        }
        _ => return Err(unsupported("such shape here")),
    };
    Ok(())
}

/// How a body hangs in the tree.
struct Rooted {
    joint: Joint,
    parent: i32,
    /// Where its frame is at the start.
    origin: Vec3,
}

/// The one joint that has the body as its second: free bodies have none.
fn rooted(
    def: &SceneDef,
    scene: &Scene,
    index: usize,
    places: &[(usize, Vec3)],
    frames: &[(i32, Vec3)],
) -> Result<Rooted, Refusal> {
    let name = &scene.bodies()[index].name;
    let mut holding = def.joints.iter().filter(|joint| joint.bodies[1] == *name);
    let Some(joint) = holding.next() else {
        let at = scene.initial_state().q[index];
        let origin = Vec3::new(at.x, 0.0, at.y);
        let joint = Joint::free(SpatialTransform::identity());
        return Ok(Rooted { joint, parent: -1, origin });
    };
    let moves = scene.initial_state().v[index].norm() > 0.0;
    if holding.next().is_some() || joint.softness.is_some() || moves {
        return Err(unsupported("loop, soft joint or moving start of a jointed body here"));
    }
    let (parent, from) = match scene.body_index(&joint.bodies[0]) {
        Some(parent) if joint.bodies[0] != WORLD => {
            let known = places.iter().position(|(place, _)| *place == parent);
            frames[known.ok_or_else(|| unsupported("body that hangs from a later one"))?]
        }
        _ => (-1, Vec3::zeros()),
    };
    let free = |limits: &Limits| *limits == Limits::default();
    let translated = |[x, y]: [f64; 2]| {
        let origin = Vec3::new(x, 0.0, y);
        (SpatialTransform::from_translation(origin - from), origin)
    };
    let (joint, origin) = match &joint.kind {
        JointKind::Revolute { anchor, anchor_b: None, limits, motor: None } if free(limits) => {
            let (place, origin) = translated(*anchor);
            (Joint { axis: Vec3::new(0.0, -1.0, 0.0), ..Joint::revolute(place) }, origin)
        }
        JointKind::Prismatic { anchor, axis, limits, motor: None } if free(limits) => {
            let (place, origin) = translated(*anchor);
            (Joint::prismatic(place, Vec3::new(axis[0], 0.0, axis[1])), origin)
        }
        _ => return Err(unsupported("counterpart of such a joint here")),
    };
    Ok(Rooted { joint, parent, origin })
}

struct PhyzWorld {
    simulator: Simulator,
    state: phyz::model::State,
    translation: Translation,
}

impl World for PhyzWorld {
    fn step(&mut self) -> Result<(), Refusal> {
        let Translation { model, material, touches, .. } = &self.translation;
        if *touches {
            self.simulator.step_with_contacts(model, &mut self.state, 0.0, material);
        } else {
            self.simulator.step(model, &mut self.state);
        }
        Ok(())
    }

    fn state(&self) -> State {
        let Translation { model, places, initial, .. } = &self.translation;
        let (frames, rates) = forward_kinematics(model, &self.state);
        let mut found = State { time: self.state.time, ..initial.clone() };
        for (((index, com), frame), rate) in places.iter().zip(&frames).zip(&rates) {
            let turn = frame.rot.transpose();
            let at = frame.pos + turn * *com;
            let v = turn * (rate.linear + rate.angular.cross(*com));
            let start = if model.joints[model.bodies.len() - 1].ndof() == 6 {
                0.0
            } else {
                initial.q[*index].z
            };
            let angle = turn[(2, 0)].atan2(turn[(0, 0)]);
            found.q[*index] = [at.x, at.z, start + angle].into();
            found.v[*index] = [v.x, v.z, -rate.angular.y].into();
        }
        found
    }
}
