//! A scene as a person describes it: plain data, every field public, read and written by serde.

use serde::{Deserialize, Serialize};

use crate::{BodyDef, ControlDef, ForceDef, JointDef};

/// Everything that a scene file says. [`Scene::new`](crate::Scene::new) checks and compiles it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SceneDef {
    /// Version of the schema; 1.
    pub version: u32,
    /// Title.
    pub name: String,
    /// What happens in it, for people.
    pub description: String,
    /// Gravity, m/s².
    pub gravity: [f64; 2],
    /// Time step, s.
    pub dt: f64,
    /// How long a run lasts unless told otherwise, s.
    pub duration: f64,
    /// How steps treat impacts.
    pub stepping: Stepping,
    /// What a contact constrains.
    pub contact_model: ContactModel,
    /// Contacts with gaps up to this are modelled, whether a step can close them or not, m. They change no
    /// motion, and cost time; smoothed derivatives feel them. 0: only those that a step can close. Needs
    /// [`ContactModel::Gap`] and [`Stepping::Fixed`].
    pub contact_reach: f64,
    /// How position errors are removed.
    pub stabilisation: Stabilisation,
    /// Greatest speed at which [`Correction::Post`], and `Baumgarte` of contacts and limits, remove
    /// errors of places, m/s.
    pub recovery_speed: f64,
    /// Greatest rate at which it removes errors of angles, rad/s.
    pub recovery_rate: f64,
    /// Greatest scaled residual of an accepted step.
    pub tolerance: f64,
    /// Bodies.
    pub bodies: Vec<BodyDef>,
    /// Joints and springs.
    pub joints: Vec<JointDef>,
    /// Forces in time.
    pub forces: Vec<ForceDef>,
    /// Control channels, in the order of the control array.
    pub controls: Vec<ControlDef>,
    /// What particular pairs of bodies do differently.
    pub pairs: Vec<PairDef>,
}

impl Default for SceneDef {
    fn default() -> Self {
        Self {
            version: 1,
            name: String::new(),
            description: String::new(),
            gravity: [0.0, -9.81],
            dt: 0.01,
            duration: 1.0,
            stepping: Stepping::Fixed,
            contact_model: ContactModel::Gap,
            contact_reach: 0.0,
            stabilisation: Stabilisation::default(),
            recovery_speed: 1.0,
            recovery_rate: 1.0,
            tolerance: 1e-10,
            bodies: Vec::new(),
            joints: Vec::new(),
            forces: Vec::new(),
            controls: Vec::new(),
            pairs: Vec::new(),
        }
    }
}

/// How steps treat impacts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Stepping {
    /// Every step is one of length dt (semi-implicit Euler): what closes within it bounces at its
    /// beginning. The fastest.
    #[default]
    Fixed,
    /// Steps are divided where a gap or a limit closes: the time is located, and the impact solved
    /// there. Free flight is exact for constant forces, and derivatives through bounces are those of
    /// the motion.
    ImpactResolved {
        /// Impacts that divide one step; after these, the rest of the step is one of fixed length.
        #[serde(default = "most_impacts")]
        max_impacts: u32,
    },
    /// Between impacts and all else at which forces jump or change their law (a contact opens, begins or
    /// ends to slide, a motor reaches its speed or its maximum, a force begins) the motion is integrated to
    /// order 4, with joints and contacts closed to rounding. The most accurate, and recommended for
    /// gradients.
    Accurate {
        /// Events that divide one step; after these, the rest of the step is one of fixed length.
        #[serde(default = "most_events")]
        max_events: u32,
    },
}

fn most_impacts() -> u32 {
    8
}

fn most_events() -> u32 {
    32
}

/// What a contact constrains. Both use Newton's law of restitution, for all contacts of a step at
/// once: a row of touching discs obeys the *simultaneous* law, not a chain of single impacts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ContactModel {
    /// Every pair that can touch within the step: `Jₙ v⁺ ≥ −gap/dt`, so that nothing penetrates to
    /// first order and nothing acts at a distance. Restitution only where the gap would close.
    #[default]
    Gap,
    /// The paper's: pairs within a distance of touching are constrained on velocity alone.
    Velocity {
        /// Largest gap that counts as touching, m.
        contact_distance: f64,
    },
}

/// How position errors are removed, for joints and for penetrations each.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Stabilisation {
    /// Joint errors; by default `Baumgarte` with fraction 1.
    pub joints: Correction,
    /// Penetrations; by default `Post`.
    pub contacts: Correction,
}

impl Default for Stabilisation {
    fn default() -> Self {
        Self { joints: Correction::Baumgarte { fraction: 1.0 }, contacts: Correction::Post }
    }
}

/// How one kind of position error is removed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Correction {
    /// Not at all: errors stay and add up.
    None,
    /// This fraction of the error per step, through the velocity (Baumgarte 1972). With fraction 1
    /// a joint meets its position at the end of the step to first order.
    Baumgarte {
        /// In (0, 1].
        fraction: f64,
    },
    /// After the move, by the smallest mass-weighted displacements that remove the error to rounding;
    /// velocities are left alone (Cline & Pai 2003). Penetrations, and joints that were open before the
    /// move, move at most at the recovery speed.
    Post,
}

/// What a pair of bodies does differently from the mixing rules.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PairDef {
    /// The two bodies.
    pub bodies: [String; 2],
    /// Whether they collide; overrides masks and joints.
    pub collide: Option<bool>,
    /// Friction coefficient of the pair.
    pub friction: Option<f64>,
    /// Restitution of the pair.
    pub restitution: Option<f64>,
}
