//! Other engines in the same process, on worlds made from our own scene definitions.
//!
//! Where an engine has no exact counterpart for a part of a scene, it refuses the scene; what is
//! modelled otherwise by nature is in its [`settings`](crate::engine::Engine::settings).

mod phyz;
mod rapier;

pub use phyz::Phyz;
pub use rapier::Rapier;
