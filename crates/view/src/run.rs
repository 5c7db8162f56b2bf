//! A run: the motion of a scene over time, as files and pages show it.

use tangency_collision::pose::perp;
use tangency_core::{Contact, Rollout, Scene, State, StepRecord};

/// A named motion.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// What a reader calls it: `true`, `learned`.
    pub name: String,
    /// Frames in time order: the initial state, then one per step.
    pub frames: Vec<Frame>,
}

/// The end of one step.
#[derive(Clone, Debug)]
pub struct Frame {
    /// The state.
    pub state: State,
    /// Mechanical energy, J.
    pub energy: f64,
    /// What contacts did in the step that led here.
    pub pushes: Vec<Push>,
}

/// An impulse at a point, on a body that can move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Push {
    /// Where, m.
    pub point: [f64; 2],
    /// Impulse, N·s.
    pub impulse: [f64; 2],
}

impl Run {
    /// A run of a rollout, a frame per state.
    #[must_use]
    pub fn from_rollout(name: &str, scene: &Scene, rollout: &Rollout) -> Self {
        let first = Frame::initial(scene, &rollout.initial);
        let steps = rollout.records.iter().map(|record| Frame::after(scene, record));
        Self { name: name.to_owned(), frames: std::iter::once(first).chain(steps).collect() }
    }
}

impl Frame {
    /// The frame before the first step.
    #[must_use]
    pub fn initial(scene: &Scene, state: &State) -> Self {
        Self { state: state.clone(), energy: scene.energy(state), pushes: Vec::new() }
    }

    /// The frame after a step.
    #[must_use]
    pub fn after(scene: &Scene, record: &StepRecord) -> Self {
        let state = record.after.clone();
        let energy = scene.energy(&state);
        Self { state, energy, pushes: pushes(scene, record) }
    }
}

fn pushes(scene: &Scene, record: &StepRecord) -> Vec<Push> {
    let parts = record.parts.iter().chain([record]);
    let impulses = parts
        .flat_map(|part| part.contact_impulses().into_iter().map(move |impulse| (part, impulse)));
    impulses
        .map(|(part, it)| {
            let [n, t] = [it.direction, perp(&it.direction)];
            let on_b = it.normal * n + it.tangent * t;
            let Contact { feature, .. } = &part.contacts[it.contact];
            let b = feature.id.bodies[1] as usize;
            let impulse = if scene.is_dynamic(b) { on_b } else { -on_b };
            Push { point: it.point.into(), impulse: impulse.into() }
        })
        .collect()
}
