//! What can go wrong, each cause with its numbers.

use tangency_collision::{CollisionError, ShapeError};
use tangency_lcp::LcpError;

/// A number without rows of zeros.
fn number(value: f64) -> String {
    let plain = value == 0.0 || !value.is_finite() || (1e-6..1e12).contains(&value.abs());
    if plain { value.to_string() } else { format!("{value:e}") }
}

/// A scene that cannot be built. Every variant knows the path of the field that is wrong, as in
/// `bodies[2].mass`.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A number is out of its range.
    #[error("{path} is {}: {expected}", number(*value))]
    Value {
        /// The field.
        path: String,
        /// The value given.
        value: f64,
        /// What it must be.
        expected: &'static str,
    },
    /// A mass that follows from density and shapes, and is out of range.
    #[error(
        "{path}: density and shapes make a mass of {mass:.1e} kg; from 1e-50 to 1e50 can be computed \
         with, give `mass`"
    )]
    DerivedMass {
        /// The body.
        path: String,
        /// The mass, kg.
        mass: f64,
    },
    /// A name that nothing has.
    #[error("{path} names {name:?}, which is not {what}; known: {known}")]
    UnknownName {
        /// The field.
        path: String,
        /// The name given.
        name: String,
        /// What was looked for.
        what: &'static str,
        /// The names there are.
        known: String,
    },
    /// A name given twice, or one that is reserved.
    #[error("{path} is {name:?}: {reason}")]
    BadName {
        /// The field.
        path: String,
        /// The name given.
        name: String,
        /// Why it cannot be used.
        reason: &'static str,
    },
    /// A shape that is not one.
    #[error("{path}: {source}")]
    Shape {
        /// The field.
        path: String,
        /// What is wrong with it.
        source: ShapeError,
    },
    /// Fields that contradict each other, or one that is missing.
    #[error("{path}: {reason}")]
    Conflict {
        /// The field.
        path: String,
        /// What to do.
        reason: &'static str,
    },
}

impl SceneError {
    /// The field that is wrong, as in `joints[0].kind.revolute.motor.max`.
    #[must_use]
    pub fn path(&self) -> &str {
        match self {
            Self::Value { path, .. }
            | Self::DerivedMass { path, .. }
            | Self::UnknownName { path, .. }
            | Self::BadName { path, .. }
            | Self::Shape { path, .. }
            | Self::Conflict { path, .. } => path,
        }
    }
}

/// A step that could not be taken. The state before it is untouched.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StepError {
    /// The state does not fit the scene.
    #[error("the state has {found} bodies, the scene {expected}")]
    StateSize {
        /// Bodies of the scene.
        expected: usize,
        /// Bodies of the state.
        found: usize,
    },
    /// The control does not fit the scene.
    #[error("the control has {found} numbers, the scene {expected} control channels")]
    ControlSize {
        /// Channels of the scene.
        expected: usize,
        /// Numbers given.
        found: usize,
    },
    /// Not a number, or infinite.
    #[error("{what} {index} is not finite; look for an earlier division by zero")]
    NotFinite {
        /// What kind of thing it is.
        what: &'static str,
        /// Which one.
        index: usize,
    },
    /// The state's time is not a number, or infinite.
    #[error("the time of the state is {time}; give a finite number of seconds")]
    TimeNotFinite {
        /// The time.
        time: f64,
    },
    /// A distance joint or spring whose anchors have met.
    #[error(
        "at time {time}: the anchors of joint {joint} coincide, so that their distance has no \
         direction; move one of its bodies or use a (soft) revolute joint"
    )]
    CoincidentAnchors {
        /// Time at the start of the step, s.
        time: f64,
        /// The joint's name.
        joint: String,
    },
    /// Contact detection failed.
    #[error("at time {time}: {source}")]
    Collision {
        /// Time at the start of the step, s.
        time: f64,
        /// Why.
        source: CollisionError,
    },
    /// The complementarity problem was not solved.
    #[error("at time {time}, bodies {bodies}: {source}")]
    Lcp {
        /// Time at the start of the step, s.
        time: f64,
        /// Names of the bodies of the island.
        bodies: String,
        /// Why.
        source: LcpError,
    },
}
