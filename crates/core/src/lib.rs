//! The engine: scenes, the problem of a time step, stepping, rollouts.
//!
//! A step is [`step`], and reads:
//!
//! ```text
//!  contacts = detect(scene, state)            which features are in reach
//!  islands  = assemble(rows(contacts))        one mixed complementarity problem per island
//!  solved   = solve_checked(solver, islands)  accepted by residual, whichever backend answered
//!  next     = integrate(state, solved)        v⁺, then q⁺ = q + dt v⁺
//! ```
//!
//! It returns its own [`StepRecord`]; the list of records is the tape that `tangency-diff` reads.
//! This crate names no backend and computes no gradient of a step; the derivatives of the formulas
//! that it evaluates (joint coordinates, right-hand sides) stand beside them.
//!
//! Conventions: world frame and SI units unless a name ends in `_local`; the normal points from
//! body a to body b; gaps are positive apart; angles are counter-clockwise.

// In reading order: what a person describes,
mod body;
mod force;
mod joint;
mod scene_def;
// what it compiles to,
mod compile;
mod compile_body;
mod compile_input;
mod compile_joint;
mod error;
pub mod material;
pub mod measure;
mod model;
mod motion;
mod pair_rules;
mod param;
mod scene;
mod state;
// and how it moves.
pub mod bend;
mod checkpoints;
mod detect;
mod event;
mod flow;
mod frames;
mod guess;
mod inspect;
mod island;
mod margin;
mod mend;
pub mod momentum;
mod obey;
mod path;
mod progress;
mod reach;
mod record;
mod resolve;
pub mod rhs;
mod right_side;
mod rollout;
pub mod row;
mod rows;
mod scratch;
mod search;
#[cfg(feature = "parallel")]
mod shares;
mod simulator;
mod slop;
mod smooth;
mod solve;
mod stage;
mod step;
mod touch;

pub use body::{BodyDef, BodyKind};
pub use checkpoints::{Checkpoints, checkpointed_rollout, checkpointed_rollout_in};
pub use error::{SceneError, StepError};
pub use force::{ControlDef, ControlInput, ForceDef};
pub use inspect::{Inspection, IslandInspection, inspect};
pub use joint::{JointDef, JointKind, Limits, Motor, Softness, WORLD};
pub use model::{Body, Control, Force, Joint, JointRow};
pub use motion::Motion;
pub use param::Param;
pub use record::{ContactImpulse, Counts, IslandRecord, Path, PostRecord, StepRecord};
pub use rollout::{Rollout, rollout, rollout_in, simulate};
pub use row::RowSource;
pub use scene::Scene;
pub use scene_def::{ContactModel, Correction, PairDef, SceneDef, Stabilisation, Stepping};
pub use scratch::StepScratch;
pub use simulator::Simulator;
pub use smooth::{End, Meeting, STEPS, Slope, SmoothRecord, WEIGHTS};
pub use stage::Stage;
pub use state::State;
pub use step::{next_step, step};
pub use tangency_collision::{Contact, ContactId, Pose, Shape, ShapeNumber};
pub use tangency_lcp as lcp;
