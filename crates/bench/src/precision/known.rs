//! What is known of a body at a time.

use nalgebra::Vector3;
use tangency_core::{Scene, SceneDef};

/// Pose and velocity of one body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    /// The body's index.
    pub body: usize,
    /// (m, m, rad).
    pub q: Vector3<f64>,
    /// (m/s, m/s, rad/s).
    pub v: Vector3<f64>,
}

impl Known {
    pub(super) fn new(body: usize, q: [f64; 3], v: [f64; 3]) -> Self {
        Self { body, q: q.into(), v: v.into() }
    }
}

/// A scene that stands: its dynamic bodies where they began.
pub(super) fn standing(def: &SceneDef) -> Vec<Known> {
    let scene = Scene::new(def).expect("a scene of this crate");
    let initial = scene.initial_state();
    let dynamic = (0..initial.q.len()).filter(|body| scene.is_dynamic(*body));
    dynamic.map(|body| Known { body, q: initial.q[body], v: Vector3::zeros() }).collect()
}
