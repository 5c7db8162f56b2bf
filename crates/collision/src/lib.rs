//! Planar shapes, which of their features can touch, and the smooth geometry of each contact.
//!
//! A contact is found in two stages that never mix:
//!
//! 1. *Selection* looks at the placed shapes and names the features that can touch: vertex 2 of this
//!    polygon, edge 0 of that one. It is discrete and never differentiated.
//! 2. *Evaluation* turns a feature pair and two poses into point, normal and gap. It is smooth, and
//!    [`ContactFeature::jet`] gives its derivative beside its value.
//!
//! The crate does not know mass, velocity (except as the motion asked about in
//! [`time_of_impact`]), time steps or complementarity problems, and never which bodies are static.
//!
//! Conventions: world frame and SI units unless a name says `local`; the normal points from body a to
//! body b; the gap is positive when apart; angles are counter-clockwise in radians.
//!
//! Reading order: [`pose`], `shape`, `mass`, `hull`, `outline` and `collider` say what bodies look
//! like; `feature`, `evaluate` and `jet` what a contact is; `world`, `sweep`, `select` and `detect`
//! how contacts are found; `impact` when moving bodies first touch.

pub mod pose;

mod error;
mod shape;

mod hull;
mod mass;
mod outline;

mod collider;

mod feature;

mod evaluate;

mod jet;

mod world;

mod sweep;

mod select;

mod detect;

mod impact;

pub use collider::Collider;
pub use detect::{Placed, contacts};
pub use error::{CollisionError, ShapeError};
pub use evaluate::Contact;
pub use feature::{ContactFeature, ContactId, Feature, Part};
pub use hull::convex_hull;
pub use impact::time_of_impact;
pub use jet::ContactJet;
pub use mass::MassProperties;
pub use pose::Pose;
pub use shape::Shape;
