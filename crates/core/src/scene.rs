//! A scene: checked, compiled, and constant during a rollout.

use std::collections::BTreeSet;

use nalgebra::{Vector2, Vector3};
use tangency_collision::{Collider, pose};

use crate::compile::{Names, conflict, finite, positive};
use crate::compile_body::compile_body;
use crate::compile_input::{compile_control, compile_force, compile_pair};
use crate::compile_joint::compile_joint;
use crate::material::{self, Mixed};
use crate::model::{Body, Control, Force, Joint, Pair};
use crate::pair_rules::{PairRule, PairRules};
use crate::reach::JointGroups;
use crate::{
    BodyKind, ContactModel, Correction, SceneDef, SceneError, Stabilisation, State, Stepping,
};

/// A checked scene. Its numbers may be read freely and are changed through
/// [`Scene::set`](crate::Scene::set).
#[derive(Clone, Debug)]
pub struct Scene {
    pub(crate) def: SceneDef,
    pub(crate) gravity: Vector2<f64>,
    pub(crate) dt: f64,
    pub(crate) bodies: Vec<Body>,
    pub(crate) colliders: Vec<Collider>,
    pub(crate) joints: Vec<Joint>,
    pub(crate) forces: Vec<Force>,
    pub(crate) controls: Vec<Control>,
    /// What pairs of bodies do differently.
    pub(crate) rules: PairRules,
    /// Bodies that joints connect.
    pub(crate) joined: JointGroups,
    /// Which bodies are not dynamic.
    pub(crate) fixed: Vec<bool>,
    /// Whether any two bodies may touch.
    pub(crate) touches: bool,
    pub(crate) initial: State,
}

impl Scene {
    /// Checks and compiles a definition.
    ///
    /// # Errors
    /// A [`SceneError`] that names the field, its value and what to do.
    pub fn new(def: &SceneDef) -> Result<Self, SceneError> {
        check_settings(def)?;
        let names = Names::of_bodies(&def.bodies)?;
        let mut scene = Self {
            def: def.clone(),
            gravity: Vector2::from(def.gravity),
            dt: def.dt,
            bodies: Vec::new(),
            colliders: Vec::new(),
            joints: Vec::new(),
            forces: Vec::new(),
            controls: Vec::new(),
            rules: PairRules::default(),
            joined: JointGroups::default(),
            fixed: Vec::new(),
            touches: true,
            initial: State::default(),
        };
        for (i, body) in def.bodies.iter().enumerate() {
            let compiled = compile_body(body, &format!("bodies[{i}]"))?;
            scene.fixed.push(compiled.body.kind != BodyKind::Dynamic);
            scene.bodies.push(compiled.body);
            scene.colliders.push(compiled.collider);
            scene.initial.q.push(compiled.pose);
            scene.initial.v.push(compiled.velocity);
        }
        let joint_names = Names::of_joints(&def.joints)?;
        for (i, joint) in def.joints.iter().enumerate() {
            let compiled = compile_joint(joint, &format!("joints[{i}]"), &names, &scene)?;
            scene.joints.push(compiled);
        }
        for (i, force) in def.forces.iter().enumerate() {
            scene.forces.push(compile_force(force, &format!("forces[{i}]"), &names, &scene)?);
        }
        Names::check_controls(&def.controls)?;
        for (i, control) in def.controls.iter().enumerate() {
            let path = format!("controls[{i}].input");
            scene.controls.push(compile_control(control, &path, &names, &joint_names, &scene)?);
        }
        let silent = def.joints.iter().zip(&scene.joints).filter(|(def, _)| !def.collide);
        let jointed: Vec<&Joint> = silent.map(|(_, joint)| joint).collect();
        scene.rules = PairRules::new(scene.bodies.len(), &compile_pairs(def, &names)?, &jointed);
        scene.joined = JointGroups::new(&scene.joints, &scene.fixed);
        scene.touches = scene.may_touch();
        Ok(scene)
    }

    /// The definition as it was given; [`Scene::set`](crate::Scene::set) does not change it.
    #[must_use]
    pub fn def(&self) -> &SceneDef {
        &self.def
    }

    /// Gravity, m/s².
    #[must_use]
    pub fn gravity(&self) -> Vector2<f64> {
        self.gravity
    }

    /// Time step, s.
    #[must_use]
    pub fn dt(&self) -> f64 {
        self.dt
    }

    /// Bodies.
    #[must_use]
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// Colliders of the bodies, in their centre-of-mass frames.
    #[must_use]
    pub fn colliders(&self) -> &[Collider] {
        &self.colliders
    }

    /// Joints and springs.
    #[must_use]
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Forces in time.
    #[must_use]
    pub fn forces(&self) -> &[Force] {
        &self.forces
    }

    /// Control channels.
    #[must_use]
    pub fn controls(&self) -> &[Control] {
        &self.controls
    }

    /// How steps treat impacts.
    #[must_use]
    pub fn stepping(&self) -> Stepping {
        self.def.stepping
    }

    /// What a contact constrains.
    #[must_use]
    pub fn contact_model(&self) -> ContactModel {
        self.def.contact_model
    }

    /// Contacts with gaps up to this are modelled, whether a step can close them or not, m.
    #[must_use]
    pub fn contact_reach(&self) -> f64 {
        self.def.contact_reach
    }

    /// How position errors are removed.
    #[must_use]
    pub fn stabilisation(&self) -> Stabilisation {
        self.def.stabilisation
    }

    /// Greatest speed of [`Correction::Post`], m/s.
    #[must_use]
    pub fn recovery_speed(&self) -> f64 {
        self.def.recovery_speed
    }

    /// Greatest rate of [`Correction::Post`], rad/s.
    #[must_use]
    pub fn recovery_rate(&self) -> f64 {
        self.def.recovery_rate
    }

    /// Greatest residual of an accepted step.
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        self.def.tolerance
    }

    /// The state at time 0.
    #[must_use]
    pub fn initial_state(&self) -> State {
        self.initial.clone()
    }

    /// Index of a body by its name.
    #[must_use]
    pub fn body_index(&self, name: &str) -> Option<usize> {
        self.bodies.iter().position(|b| b.name == name)
    }

    /// Index of a joint by its name.
    #[must_use]
    pub fn joint_index(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|j| j.name == name)
    }

    /// Whether a body's velocity is an unknown.
    #[must_use]
    pub fn is_dynamic(&self, body: usize) -> bool {
        self.bodies[body].kind == BodyKind::Dynamic
    }

    /// Friction of a pair of bodies.
    #[must_use]
    pub fn pair_friction(&self, a: usize, b: usize) -> Mixed {
        match self.rules.of(a, b).and_then(|p| p.friction) {
            Some(value) => Mixed { value, d: [0.0; 2] },
            None => material::friction(self.bodies[a].friction, self.bodies[b].friction),
        }
    }

    /// Restitution of a pair of bodies.
    #[must_use]
    pub fn pair_restitution(&self, a: usize, b: usize) -> Mixed {
        match self.rules.of(a, b).and_then(|p| p.restitution) {
            Some(value) => Mixed { value, d: [0.0; 2] },
            None => material::restitution(self.bodies[a].restitution, self.bodies[b].restitution),
        }
    }

    /// Whether any two bodies may touch; taken for granted where there are too many pairs to ask.
    fn may_touch(&self) -> bool {
        const MANY: usize = 2000;
        let shaped = |body: &usize| self.colliders[*body].radius() > 0.0;
        let shaped: Vec<usize> = (0..self.bodies.len()).filter(shaped).collect();
        let meets = |(k, a): (usize, &usize)| shaped[..k].iter().any(|b| self.collides(*a, *b));
        shaped.len() > MANY || shaped.iter().enumerate().any(meets)
    }

    /// Whether two bodies may touch.
    #[must_use]
    pub fn collides(&self, a: usize, b: usize) -> bool {
        if self.fixed[a] && self.fixed[b] {
            return false;
        }
        if let Some(collides) = self.rules.of(a, b).and_then(PairRule::collides) {
            return collides;
        }
        let (one, two) = (&self.bodies[a], &self.bodies[b]);
        one.category & two.mask != 0 && two.category & one.mask != 0
    }

    /// Pose of a joint's body in `q`; the world's is zero.
    #[must_use]
    pub fn joint_poses(&self, joint: usize, q: &[Vector3<f64>]) -> [Vector3<f64>; 2] {
        self.joints[joint].bodies.map(|b| b.map_or_else(Vector3::zeros, |b| q[b]))
    }

    /// Anchors of a joint in the world, m.
    #[must_use]
    pub fn joint_anchors(&self, joint: usize, state: &State) -> [Vector2<f64>; 2] {
        let poses = self.joint_poses(joint, &state.q);
        [0, 1].map(|i| pose::point(&poses[i], &self.joints[joint].anchors[i]))
    }
}

/// What pairs of bodies do differently; each pair once.
fn compile_pairs(def: &SceneDef, names: &Names) -> Result<Vec<Pair>, SceneError> {
    let mut pairs: Vec<Pair> = Vec::new();
    let mut seen = BTreeSet::new();
    for (i, pair) in def.pairs.iter().enumerate() {
        let path = format!("pairs[{i}]");
        let pair = compile_pair(pair, &path, names)?;
        if !seen.insert(pair.bodies) {
            return conflict(format!("{path}.bodies"), "this pair is given twice; merge both");
        }
        pairs.push(pair);
    }
    Ok(pairs)
}

fn check_reach(def: &SceneDef) -> Result<(), SceneError> {
    let (path, value) = (String::from("contact_reach"), def.contact_reach);
    if !(value >= 0.0 && value.is_finite()) {
        let expected = "give a finite number of metres, 0 for none";
        return Err(SceneError::Value { path, value, expected });
    }
    if value > 0.0 && (def.contact_model != ContactModel::Gap || def.stepping != Stepping::Fixed) {
        return conflict(
            path,
            "contacts from afar need the contact model `gap` and stepping `fixed`",
        );
    }
    Ok(())
}

fn check_settings(def: &SceneDef) -> Result<(), SceneError> {
    if def.version != 1 {
        let (path, value) = ("version".into(), f64::from(def.version));
        return Err(SceneError::Value { path, value, expected: "this engine reads version 1" });
    }
    for (i, g) in def.gravity.iter().enumerate() {
        finite(*g, &format!("gravity[{i}]"))?;
    }
    positive(def.dt, "dt")?;
    positive(def.duration, "duration")?;
    positive(def.recovery_speed, "recovery_speed")?;
    positive(def.recovery_rate, "recovery_rate")?;
    positive(def.tolerance, "tolerance")?;
    if def.tolerance >= 1.0 {
        let (path, value) = ("tolerance".into(), def.tolerance);
        let expected = "a residual of 1 is no solution; give 1e-10 or so";
        return Err(SceneError::Value { path, value, expected });
    }
    if let ContactModel::Velocity { contact_distance } = def.contact_model {
        if def.stepping != Stepping::Fixed {
            return conflict("stepping".into(), "located impacts need the contact model `gap`");
        }
        positive(contact_distance, "contact_model.velocity.contact_distance")?;
    }
    check_reach(def)?;
    let corrections =
        [("joints", def.stabilisation.joints), ("contacts", def.stabilisation.contacts)];
    for (name, correction) in corrections {
        if let Correction::Baumgarte { fraction } = correction
            && !(fraction > 0.0 && fraction <= 1.0)
        {
            return Err(SceneError::Value {
                path: format!("stabilisation.{name}.baumgarte.fraction"),
                value: fraction,
                expected: "give a fraction in (0, 1]",
            });
        }
    }
    Ok(())
}
