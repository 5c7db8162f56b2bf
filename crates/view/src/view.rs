//! What part of the world is seen.

use tangency_collision::Pose;
use tangency_collision::pose::{Frame, point};
use tangency_core::{Scene, State};

use crate::ViewError;
use crate::joint_look::JointLook;
use crate::look::{BodyLook, Form};

/// A rectangle of the world, m. A picture of another aspect ratio shows more of the world beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Left and lower end, m.
    pub lower: [f64; 2],
    /// Right and upper end, m.
    pub upper: [f64; 2],
}

/// Part of the greater side that a fitted view leaves free all around.
const MARGIN: f64 = 0.04;
/// Parts of the greater side at the start: how far off what is fixed is still shown,
const NEAR: f64 = 0.5;
const NEAR_DISC: f64 = 2.0;
const NEAR_GROUND: f64 = 3.0;
/// how much of a half plane, and how far what moves may come from the start.
const GROUND: f64 = 0.04;
const SLACK: f64 = 0.6;

const NOTHING: View = View { lower: [f64::INFINITY; 2], upper: [f64::NEG_INFINITY; 2] };

impl View {
    /// A view of one state (`[&state]`) or of a run (`rollout.states()`), the first state being its start.
    ///
    /// It holds all bodies that move at the start, what is fixed near them, and where they move later
    /// within 0.6 of the size at the start; what flies farther leaves the view. Without a
    /// state it is that of the scene's initial one.
    ///
    /// # Errors
    /// [`ViewError::State`] for a state that does not fit the scene or is not finite.
    pub fn fit<'a>(
        scene: &Scene,
        states: impl IntoIterator<Item = &'a State>,
    ) -> Result<Self, ViewError> {
        let states: Vec<&State> = states.into_iter().collect();
        states.iter().try_for_each(|state| state.check(scene.bodies().len()))?;
        let looks = BodyLook::all(scene);
        Ok(Self::around(scene, &looks, &JointLook::all(scene), &states))
    }

    /// [`View::fit`] of states that fit the scene.
    pub(crate) fn around(
        scene: &Scene,
        looks: &[BodyLook],
        joints: &[JointLook],
        states: &[&State],
    ) -> Self {
        let initial = scene.initial_state();
        let first = states.first().map_or(&initial, |state| *state);
        let mut start = NOTHING;
        start.add_moving(looks, first);
        start.add_hooks(joints);
        start.fill_out();
        start.add_fixed(looks, first);
        let mut all = start;
        for state in states {
            all.add_moving(looks, state);
        }
        all.within(&start, SLACK * start.size()).with_margin()
    }

    /// Its greater side, m.
    fn size(&self) -> f64 {
        (self.upper[0] - self.lower[0]).max(self.upper[1] - self.lower[1])
    }

    /// Its centre, m.
    pub(crate) fn center(&self) -> [f64; 2] {
        [0, 1].map(|k| f64::midpoint(self.lower[k], self.upper[k]))
    }

    /// Grows to hold a disc.
    fn add(&mut self, center: [f64; 2], radius: f64) {
        for (k, x) in center.into_iter().enumerate() {
            self.lower[k] = self.lower[k].min(x - radius);
            self.upper[k] = self.upper[k].max(x + radius);
        }
    }

    fn add_moving(&mut self, looks: &[BodyLook], state: &State) {
        for (look, q) in looks.iter().zip(&state.q).filter(|(look, _)| look.moves()) {
            self.add([q.x, q.y], look.radius);
        }
    }

    /// The points where the world holds something.
    fn add_hooks(&mut self, joints: &[JointLook]) {
        for joint in joints {
            let held = (0..2).filter(|end| joint.bodies[*end].is_none());
            held.for_each(|end| self.add(joint.ends[end], 0.0));
        }
    }

    /// Nothing becomes the place about the origin; a point its surroundings.
    fn fill_out(&mut self) {
        if self.lower[0] > self.upper[0] {
            self.add([0.0; 2], 1.0);
        } else if self.size() == 0.0 {
            self.add(self.center(), 1.0);
        }
    }

    /// What is fixed and near what the view holds now.
    fn add_fixed(&mut self, looks: &[BodyLook], state: &State) {
        let core = *self;
        for (look, pose) in looks.iter().zip(&state.q).filter(|(look, _)| look.fixed) {
            look.forms.iter().for_each(|form| self.add_near(&core, look, form, pose));
        }
    }

    /// As much of a fixed form as is near `core`.
    fn add_near(&mut self, core: &Self, look: &BodyLook, form: &Form, pose: &Pose) {
        let (size, c) = (core.size(), core.center());
        match form {
            Form::HalfPlane { normal, offset } => {
                // The point of its edge that is nearest to the centre: c − d n.
                let (d, n) = above_ground(*normal, *offset, pose, c);
                if d < NEAR_GROUND * size {
                    self.add([c[0] - d * n[0], c[1] - d * n[1]], GROUND * size);
                }
            }
            Form::Polygon { points } => {
                let slack = NEAR * size;
                let near = |k: usize, x: f64| x.clamp(core.lower[k] - slack, core.upper[k] + slack);
                for local in points {
                    let p = point(pose, &(*local).into());
                    self.add([near(0, p.x), near(1, p.y)], 0.0);
                }
            }
            Form::Circle { .. } | Form::Capsule { .. } => {
                if look.radius < NEAR_DISC * size {
                    self.add([pose.x, pose.y], look.radius);
                }
            }
        }
    }

    /// No more than `slack` beyond another view.
    fn within(&self, other: &Self, slack: f64) -> Self {
        Self {
            lower: [0, 1].map(|k| self.lower[k].max(other.lower[k] - slack)),
            upper: [0, 1].map(|k| self.upper[k].min(other.upper[k] + slack)),
        }
    }

    fn with_margin(&self) -> Self {
        let margin = MARGIN * self.size();
        Self { lower: self.lower.map(|x| x - margin), upper: self.upper.map(|x| x + margin) }
    }
}

/// Distance of a point above the edge of a half plane of a body, and the edge's normal, in the world.
pub(crate) fn above_ground(
    normal: [f64; 2],
    offset: f64,
    pose: &Pose,
    [x, y]: [f64; 2],
) -> (f64, [f64; 2]) {
    let n = Frame::new(pose).direction(&normal.into());
    (n.x * (x - pose.x) + n.y * (y - pose.y) - offset, n.into())
}
