//! The rows of a step: where each comes from, its geometry, its right-hand side and its law.
//!
//! ```text
//!  contact at c, normal n from a to b, tangent t = ⊥n, arms ρ = c − p:
//!    Jₙ = [−n, −n·⊥ρ_a | n, n·⊥ρ_b]        Jₜ = [−t, −t·⊥ρ_a | t, t·⊥ρ_b]
//!  limit of a joint's free coordinate φ:   gap = φ − lower   or   upper − φ
//! ```

use nalgebra::{Vector2, Vector3};
use serde::{Deserialize, Serialize};
use tangency_collision::{Contact, Pose, pose};
use tangency_lcp::Law;

use crate::frames::Frames;
use crate::model::{Control, Joint, JointRow};
use crate::motion::Motion;
use crate::rhs::{self, Rhs, Unilateral};
use crate::scene::Scene;
pub use crate::stage::Stage;
use crate::{ContactModel, Correction, State};

/// Where a row comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum RowSource {
    /// A coordinate that a joint holds.
    Held {
        /// The joint.
        joint: u32,
        /// Which of its held rows.
        row: u32,
    },
    /// Lower limit of a joint's free coordinate.
    Lower {
        /// The joint.
        joint: u32,
    },
    /// Upper limit of a joint's free coordinate.
    Upper {
        /// The joint.
        joint: u32,
    },
    /// Motor of a joint.
    Motor {
        /// The joint.
        joint: u32,
    },
    /// A contact's normal row.
    Normal {
        /// Index into the step's contacts.
        contact: u32,
    },
    /// A contact's friction row.
    Tangent {
        /// Index into the step's contacts.
        contact: u32,
    },
}

/// Joint errors above this part of a body's size (or this many rad) do not give way.
const DRIFT: f64 = 0.1;

/// Value and gradient of a row, before its right-hand side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowGeometry {
    /// Bodies a and b; `None` is the world.
    pub bodies: [Option<usize>; 2],
    /// Position error or gap, m or rad; 0 for friction and motors.
    pub value: f64,
    /// Jacobian blocks, 1 × 3 each.
    pub jacobian: [Vector3<f64>; 2],
}

/// A row that a displacement moves at a bounded speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SlowRow {
    /// The row.
    pub source: RowSource,
    /// Greatest speed, m/s or rad/s: the recovery speed in a step's first displacement, and then 0.
    pub speed: f64,
}

/// What rows are evaluated from.
#[derive(Clone, Copy, Debug)]
pub struct RowContext<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Which problem.
    pub stage: Stage,
    /// How bodies move in this part of the step.
    pub motion: Motion,
    /// How long this part of the step lasts, s; 0 for impacts.
    pub dt: f64,
    /// Poses that the rows are evaluated at.
    pub q: &'a [Pose],
    /// Velocities before the step.
    pub v: &'a [Vector3<f64>],
    /// Control of the step.
    pub control: &'a [f64],
    /// Contacts, evaluated at `q`.
    pub contacts: &'a [Contact],
    /// Bodies whose position errors stayed in the step ([`Stage::drifts`]), so that the displacement
    /// after the move removes them; empty if there are none.
    pub loose: &'a [bool],
    /// Rows whose errors a displacement removes in part only, by source; all others at once.
    pub slow: &'a [SlowRow],
    /// Of an impact the contacts that bounce; of a displacement after a flow those that pressed and
    /// stay closed. Empty if there are none.
    pub marked: &'a [bool],
}

impl<'a> RowContext<'a> {
    /// The velocities of a step of length `dt` from a state, without contacts.
    pub(crate) fn of(scene: &'a Scene, state: &'a State, control: &'a [f64], dt: f64) -> Self {
        Self {
            scene,
            stage: Stage::Velocity,
            motion: Motion::Fixed,
            dt,
            q: &state.q,
            v: &state.v,
            control,
            contacts: &[],
            loose: &[],
            slow: &[],
            marked: &[],
        }
    }
}

impl RowContext<'_> {
    /// Value and gradient of a row.
    ///
    /// # Panics
    /// If the scene has no such row.
    #[must_use]
    pub fn geometry(&self, source: RowSource) -> RowGeometry {
        match self.joint_row(source) {
            Some((joint, row)) => self.turned(source, self.joint_geometry(joint, row)),
            None => self.contact_row_geometry(source),
        }
    }

    /// The same where the frames of the context's poses are at hand.
    pub(crate) fn geometry_in(&self, source: RowSource, frames: &Frames) -> RowGeometry {
        match self.joint_row(source) {
            Some((joint, row)) => self.turned(source, self.joint_geometry_in(joint, row, frames)),
            None => self.contact_row_geometry(source),
        }
    }

    /// The scalar of a joint that a row is about; `None` for contacts.
    fn joint_row(&self, source: RowSource) -> Option<(u32, JointRow)> {
        match source {
            RowSource::Held { joint, row } => Some((joint, self.joint(joint).held[row as usize])),
            RowSource::Lower { joint }
            | RowSource::Upper { joint }
            | RowSource::Motor { joint } => Some((joint, self.free(joint))),
            RowSource::Normal { .. } | RowSource::Tangent { .. } => None,
        }
    }

    /// A joint's scalar as the row sees it.
    fn turned(&self, source: RowSource, g: RowGeometry) -> RowGeometry {
        match source {
            RowSource::Lower { joint } => {
                let lower = self.joint(joint).limits.lower;
                let value = g.value - lower.expect("a lower row has a lower limit");
                RowGeometry { value, ..g }
            }
            RowSource::Upper { joint } => {
                let upper = self.joint(joint).limits.upper;
                let value = upper.expect("an upper row has an upper limit") - g.value;
                RowGeometry { value, jacobian: g.jacobian.map(|j| -j), ..g }
            }
            RowSource::Motor { .. } => RowGeometry { value: 0.0, ..g },
            _ => g,
        }
    }

    fn contact_row_geometry(&self, source: RowSource) -> RowGeometry {
        let of = |contact: u32| self.contact_geometries(&self.contacts[contact as usize]);
        match source {
            RowSource::Normal { contact } => of(contact)[0],
            RowSource::Tangent { contact } => of(contact)[1],
            _ => unreachable!("rows of joints have a joint"),
        }
    }

    /// Value and gradient of a contact's normal row and of its friction row.
    pub(crate) fn contact_geometries(&self, contact: &Contact) -> [RowGeometry; 2] {
        let bodies = contact.feature.id.bodies.map(|b| b as usize);
        let turned = bodies.map(|body| pose::perp(&(contact.point - self.q[body].xy())));
        let bodies = bodies.map(Some);
        let along = |d: &Vector2<f64>, value: f64| {
            let [a, b] = [d.dot(&turned[0]), d.dot(&turned[1])];
            let jacobian = [Vector3::new(-d.x, -d.y, -a), Vector3::new(d.x, d.y, b)];
            RowGeometry { bodies, value, jacobian }
        };
        [along(&contact.normal, contact.gap), along(&pose::perp(&contact.normal), 0.0)]
    }

    /// J v⁻ of a row over both its sides, m/s or rad/s.
    #[must_use]
    pub fn speed(&self, geometry: &RowGeometry) -> f64 {
        let sides = geometry.bodies.iter().zip(&geometry.jacobian);
        sides.filter_map(|(body, j)| body.map(|b| j.dot(&self.v[b]))).sum()
    }

    /// Right-hand side of a row, before the velocities of kinematic bodies are taken off.
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
            Motion::Impact => Rhs::default(),
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
            _ if self.motion == Motion::Flow => true,
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

    /// Bodies of a contact.
    #[must_use]
    pub fn contact_bodies(&self, contact: u32) -> [usize; 2] {
        self.contacts[contact as usize].feature.id.bodies.map(|b| b as usize)
    }

    /// A scalar of a joint at the context's poses.
    #[must_use]
    pub fn joint_geometry(&self, joint: u32, row: JointRow) -> RowGeometry {
        let Joint { bodies, anchors, .. } = self.joint(joint);
        let poses = self.scene.joint_poses(joint as usize, self.q);
        let m = row.measure.evaluate([&poses[0], &poses[1]], [&anchors[0], &anchors[1]]);
        RowGeometry { bodies: *bodies, value: m.value - row.reference, jacobian: m.jacobian }
    }

    pub(crate) fn joint_geometry_in(
        &self,
        joint: u32,
        row: JointRow,
        frames: &Frames,
    ) -> RowGeometry {
        let Joint { bodies, anchors, .. } = self.joint(joint);
        let sides = bodies.map(|body| frames.side(body));
        let m = row.measure.evaluate_in(sides, [&anchors[0], &anchors[1]]);
        RowGeometry { bodies: *bodies, value: m.value - row.reference, jacobian: m.jacobian }
    }

    fn unilateral(&self, slop: f64, correction: Correction) -> Unilateral {
        let (def, dt) = (&self.scene.def, self.dt);
        let recovery_speed = def.recovery_speed;
        // What may stay asks for nothing, not even below the slop.
        let (correction, slop) =
            if self.stage.drifts() { (Correction::None, 0.0) } else { (correction, slop) };
        Unilateral { model: def.contact_model, correction, dt, recovery_speed, slop }
    }

    pub(crate) fn joint(&self, joint: u32) -> &Joint {
        &self.scene.joints[joint as usize]
    }

    pub(crate) fn free(&self, joint: u32) -> JointRow {
        self.joint(joint).free.expect("only joints with a free coordinate have limits and motors")
    }
}
