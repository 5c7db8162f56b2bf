//! What rows ask for: right-hand sides, laws, and how far they give way.

use tangency_lcp::Law;

use crate::model::Control;
use crate::motion::Motion;
use crate::rhs::{self, Rhs, Unilateral};
use crate::row::{RowContext, RowSource};
use crate::stage::Stage;
use crate::{ContactModel, Correction};

/// Joint errors above this part of a body's size (or this many rad) do not give way.
const DRIFT: f64 = 0.1;

impl RowContext<'_> {
    /// Whether rows ask for accelerations: their right-hand side is then −γ ([`bend`](Self::bend)).
    #[must_use]
    pub fn bends(&self) -> bool {
        self.motion == Motion::Smooth && self.stage.is_velocity()
    }

    /// Right-hand side of a row for velocities, before those of kinematic bodies are taken off.
    /// `speed` is J v⁻.
    #[must_use]
    pub fn rhs(&self, source: RowSource, value: f64, speed: f64) -> Rhs {
        match (self.stage, source) {
            (_, RowSource::Tangent { .. }) => Rhs::default(),
            (_, RowSource::Held { joint, row }) => self.held_rhs(joint, row, value, speed),
            (Stage::Post | Stage::SoftPost, _) => self.post_rhs(source, value),
            (stage, RowSource::Normal { contact }) if self.motion != Motion::Fixed => {
                let bounces = stage != Stage::Plastic && self.is_marked(contact);
                rhs::bounce(if bounces { self.restitution(contact) } else { 0.0 }, speed)
            }
            (_, RowSource::Lower { .. } | RowSource::Upper { .. })
                if self.motion != Motion::Fixed =>
            {
                Rhs::default()
            }
            (_, RowSource::Lower { joint } | RowSource::Upper { joint }) => {
                let rule = Unilateral {
                    model: ContactModel::Gap,
                    recovery_speed: self.recovery(source),
                    ..self.unilateral(self.limit_slop(joint), self.scene.def.stabilisation.joints)
                };
                rule.rhs(value, speed, 0.0)
            }
            (_, RowSource::Motor { joint }) => {
                Rhs { value: self.motor_speed(joint), ..Rhs::default() }
            }
            (stage, RowSource::Normal { contact }) => {
                let bounces = stage != Stage::Plastic;
                let e = if bounces { self.restitution(contact) } else { 0.0 };
                let correction = self.scene.def.stabilisation.contacts;
                self.unilateral(self.contact_slop(contact), correction).rhs(value, speed, e)
            }
        }
    }

    /// What the right-hand sides of all rows that a joint holds have in common, where that is all but
    /// their position errors φ: b = φ ∂b/∂φ.
    pub(crate) fn common_rhs(&self, joint: u32) -> Option<Rhs> {
        let linear = self.stage.is_velocity() && !self.stage.drifts();
        (linear && self.motion == Motion::Fixed).then(|| self.held_rhs(joint, 0, 0.0, 0.0))
    }

    /// Right-hand side of a row that a joint holds, as [`rhs`](Self::rhs).
    pub(crate) fn held_rhs(&self, joint: u32, row: u32, value: f64, speed: f64) -> Rhs {
        if !self.stage.is_velocity() {
            return self.post_rhs(RowSource::Held { joint, row }, value);
        }
        let dt = self.dt;
        if let Some(softness) = self.joint(joint).softness {
            return rhs::soft(softness, value, dt);
        }
        if self.stage.drifts() && self.is_drift(joint, row, value) {
            return Rhs::default();
        }
        match self.motion {
            Motion::Fixed => rhs::rigid(self.scene.def.stabilisation.joints, value, dt),
            Motion::Flow => rhs::midway(speed),
            Motion::Impact | Motion::Projection | Motion::Smooth => Rhs::default(),
        }
    }

    /// Greatest speed at which a displacement moves a row, m/s or rad/s.
    fn greatest_speed(&self, source: RowSource) -> f64 {
        let found = self.slow.binary_search_by_key(&source, |slow| slow.source);
        found.map_or(f64::INFINITY, |index| self.slow[index].speed)
    }

    /// Greatest speed at which a row's error is removed, m/s or rad/s.
    pub(crate) fn recovery(&self, source: RowSource) -> f64 {
        let def = &self.scene.def;
        let row = match source {
            RowSource::Held { joint, row } => self.joint(joint).held[row as usize],
            RowSource::Lower { joint }
            | RowSource::Upper { joint }
            | RowSource::Motor { joint } => self.free(joint),
            RowSource::Normal { .. } | RowSource::Tangent { .. } => return def.recovery_speed,
        };
        let turns = row.measure == crate::measure::Measure::Angle;
        if turns { def.recovery_rate } else { def.recovery_speed }
    }

    /// Whether a joint's error may stay for a step: it is drift, not a contradiction.
    fn is_drift(&self, joint: u32, row: u32, value: f64) -> bool {
        value.abs() <= DRIFT * self.joint_size(joint, self.joint(joint).held[row as usize])
    }

    fn post_rhs(&self, source: RowSource, value: f64) -> Rhs {
        let (dt, speed) = (self.dt, self.greatest_speed(source));
        let mends = match source {
            RowSource::Normal { contact } | RowSource::Tangent { contact } => {
                self.mends_contact(contact)
            }
            RowSource::Held { joint, .. }
            | RowSource::Lower { joint }
            | RowSource::Upper { joint }
            | RowSource::Motor { joint } => self.mends_joint(joint),
        };
        match source {
            RowSource::Held { .. } if mends => rhs::post_joint(value, dt, speed),
            RowSource::Held { .. } | RowSource::Motor { .. } => Rhs::default(),
            RowSource::Normal { contact } if self.is_marked(contact) => {
                rhs::post_joint(value, dt, f64::INFINITY)
            }
            _ if value > 0.0 || mends => rhs::post_gap(value, dt, speed),
            _ => Rhs::default(),
        }
    }

    /// Whether the displacement after the move closes a joint and brings it back to its limits.
    #[must_use]
    pub fn mends_joint(&self, joint: u32) -> bool {
        self.mends(self.scene.def.stabilisation.joints, self.joint(joint).bodies)
    }

    /// Whether the displacement after the move opens a penetration.
    #[must_use]
    pub fn mends_contact(&self, contact: u32) -> bool {
        self.mends(self.scene.def.stabilisation.contacts, self.contact_bodies(contact).map(Some))
    }

    fn mends(&self, correction: Correction, bodies: [Option<usize>; 2]) -> bool {
        match correction {
            _ if self.motion.flows() => true,
            Correction::None => false,
            Correction::Post => true,
            Correction::Baumgarte { .. } => {
                let loose = |body: &usize| self.loose.get(*body) == Some(&true);
                bodies.iter().flatten().any(loose)
            }
        }
    }

    /// Part of its own Wᵢᵢ by which a row of this stage gives way. Joints that are mended resist more
    /// than penetrations. Otherwise they only yield where they depend on each other up to their drift:
    /// two hinges of a body that are off by 10⁻⁸ of its size forbid it to turn.
    #[must_use]
    pub fn softness(&self, source: RowSource) -> f64 {
        match (self.stage, source) {
            (Stage::SoftPost, RowSource::Held { joint, .. }) if self.mends_joint(joint) => 1e-6,
            (stage, RowSource::Held { .. }) if stage.gives_way() => 1e-8,
            (Stage::SoftPost, _) => 1e-2,
            _ => 0.0,
        }
    }

    /// The law of a joint's motor row.
    pub(crate) fn motor_law(&self, joint: u32) -> Law {
        match self.joint(joint).motor.and_then(|m| m.max) {
            Some(max) => Law::Bounded { max: max * self.dt },
            None => Law::Equality,
        }
    }

    /// Restitution of a contact's bodies.
    fn restitution(&self, contact: u32) -> f64 {
        let [a, b] = self.contact_bodies(contact);
        self.scene.pair_restitution(a, b).value
    }

    /// Whether a contact is marked.
    fn is_marked(&self, contact: u32) -> bool {
        self.marked.get(contact as usize) == Some(&true)
    }

    /// Whether a displacement keeps a contact closed, rather than only from penetrating.
    pub(crate) fn stays_closed(&self, contact: u32) -> bool {
        !self.stage.is_velocity() && self.is_marked(contact)
    }

    /// Target speed of a joint's motor, controls included, rad/s or m/s.
    #[must_use]
    pub fn motor_speed(&self, joint: u32) -> f64 {
        let own = self.joint(joint).motor.map_or(0.0, |m| m.speed);
        let drives = Control::MotorSpeed { joint: joint as usize };
        let inputs = self.scene.controls.iter().zip(self.control);
        own + inputs.filter(|(c, _)| **c == drives).map(|(_, u)| u).sum::<f64>()
    }

    fn unilateral(&self, slop: f64, correction: Correction) -> Unilateral {
        let (def, dt) = (&self.scene.def, self.dt);
        let recovery_speed = def.recovery_speed;
        // What may stay asks for nothing, not even below the slop.
        let (correction, slop) =
            if self.stage.drifts() { (Correction::None, 0.0) } else { (correction, slop) };
        Unilateral { model: def.contact_model, correction, dt, recovery_speed, slop }
    }
}
