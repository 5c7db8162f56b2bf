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
//! ```
//! use tangency_collision::{Collider, Placed, Pose, Shape, contacts};
//!
//! let ball = Collider::new(&[Shape::Circle { radius: 0.5, center: [0.0, 0.0] }])?;
//! let floor = Collider::new(&[Shape::HalfPlane { normal: [0.0, 1.0], offset: 0.0 }])?;
//! let (a, b) = (Pose::new(0.0, 0.0, 0.0), Pose::new(3.0, 0.75, 0.0));
//! let bodies = [Placed { collider: &floor, pose: a }, Placed { collider: &ball, pose: b }];
//!
//! let found = contacts(&bodies, 0.3, &|_, _| true)?;
//! assert_eq!(found[0].gap, 0.25);
//! // Lifting the ball opens the gap, turning it does not.
//! let jet = found[0].feature.jet(&a, &b);
//! assert_eq!((jet.pose[(3, 4)], jet.pose[(3, 5)]), (1.0, 0.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Reading order: `pose`; `shape`, `shape_number`, `hull`, `mass`, `outline` and `collider` say what bodies look
//! like; `feature`, `evaluate` and `jet` what a contact is; `detect` and `detector` how contacts are
//! found: `world` places the bodies, `broad_phase` (`bounds`, `sweep`, `settled`) finds which are near
//! each other, `select`, `pairing` and `edge` what of them touches; `impact` when moving bodies first
//! touch.
//!
//! Parry keeps the tree of bodies that do not move, and is the tests' second opinion on distances and
//! impacts; `select` and `impact` say why their work is not left to it.

pub mod pose;

// What bodies look like,
mod collider;
mod hull;
mod mass;
mod outline;
mod shape;
mod shape_number;
// what a contact is,
mod evaluate;
mod feature;
mod jet;
// how contacts and impacts are found,
mod bounds;
mod broad_phase;
mod detect;
mod detector;
mod edge;
mod impact;
mod pairing;
mod select;
mod settled;
mod sweep;
mod world;
// and what can be wrong.
mod error;

pub use broad_phase::Near;
pub use collider::Collider;
pub use detect::{Placed, contacts};
pub use detector::Detector;
pub use error::{CollisionError, ShapeError};
pub use evaluate::Contact;
pub use feature::{ContactFeature, ContactId, Feature, Part};
pub use hull::convex_hull;
pub use impact::time_of_impact;
pub use jet::ContactJet;
pub use mass::MassProperties;
pub use pose::{Frame, Pose};
pub use shape::Shape;
pub use shape_number::{OutlineChange, ShapeNumber};
