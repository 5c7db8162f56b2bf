//! What touches at a state, and what it does.
//!
//! With u = J v⁻ the speed of a gap that is zero, and a dt the speed at which free bodies would close it
//! within a step,
//!
//! ```text
//!  u < 0               it closes: an impact       rebounds at −e u, or at 0 where −e u ≤ ½ (1 − e) a dt
//!  0 ≤ u ≤ ½ (1 − e) a dt                         it rests
//!  u above that        it leaves, and may come back within the step
//! ```
//!
//! (In smooth flows nothing rests that has a speed: u = 0, or it leaves.) A ball that leaves at u takes
//! 2 u/(a (1 − e)) for all the bounces that are left: what would come to rest within the length of a step
//! rests at once, so that none of infinitely many impacts is missed.

use nalgebra::Vector3;
use tangency_collision::Contact;

use crate::momentum::momentum_into;
use crate::path::Gap;
use crate::row::{RowContext, RowGeometry, RowSource};
use crate::scene::Scene;
use crate::scratch::StepScratch;
use crate::{JointRow, State, StepError};

/// Speeds below this part of those that add up to them are rounding.
pub(crate) const NOISE: f64 = 1e-10;

/// What is closing is located to this part of what counts as rounding of gaps.
const LOCATED: f64 = 1e-4;

/// What a pair of features does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Touch {
    /// It has a gap.
    Apart,
    /// It touches and stays.
    Resting,
    /// It touches and opens.
    Leaving,
    /// It touches and closes.
    Closing {
        /// Whether it opens again.
        bounces: bool,
    },
}

/// What is near at a state, and what of it touches.
#[derive(Debug)]
pub(crate) struct Survey {
    /// Contacts in reach of a whole step.
    pub(crate) contacts: Vec<Contact>,
    /// What each of them does.
    pub(crate) touches: Vec<Touch>,
    /// Whether each would open again if it closed now.
    bounces: Vec<bool>,
    /// Limits that are reached.
    pub(crate) reached: Vec<RowSource>,
    /// Those of them that are run into.
    pub(crate) closing: Vec<RowSource>,
    /// Whether velocities contradict a joint.
    pub(crate) disjointed: bool,
}

impl Survey {
    /// What is near and touches at `state`.
    pub(crate) fn new(
        scene: &Scene,
        state: &State,
        control: &[f64],
        smooth: bool,
        scratch: &mut StepScratch,
    ) -> Result<Self, StepError> {
        scratch.frames.place(&state.q);
        let context = RowContext::of(scene, state, control, scene.dt);
        let mut gains = scratch.vectors.take();
        momentum_into(&context, &scratch.frames, state.time, &mut gains);
        let mut contacts = scratch.contacts.take();
        scratch.detection.detect(scene, state, scratch.frames.bodies(), &gains, &mut contacts)?;
        for (i, gain) in gains.iter_mut().enumerate().filter(|(i, _)| scene.is_dynamic(*i)) {
            *gain = gain.component_div(&scene.bodies[i].mass) - state.v[i];
        }
        let context = RowContext { contacts: &contacts, ..context };
        let driven = if smooth { driven(&context) } else { Vec::new() };
        let look = Look { context, gains: &gains, smooth, driven: &driven };
        let (touches, bounces) =
            (0..contacts.len()).map(|index| look.contact(number(index))).unzip();
        let (reached, closing) = look.limits();
        let disjointed = look.disjointed();
        scratch.vectors.give(gains);
        Ok(Self { contacts, touches, bounces, reached, closing, disjointed })
    }

    /// Whether velocities must jump before anything moves on.
    pub(crate) fn jolts(&self) -> bool {
        self.closes() || self.disjointed
    }

    /// Whether a gap closes.
    pub(crate) fn closes(&self) -> bool {
        let closing = |touch: &Touch| matches!(touch, Touch::Closing { .. });
        self.touches.iter().any(closing) || !self.closing.is_empty()
    }

    /// What an impact has left closing, by rounding, rests.
    pub(crate) fn settle(&mut self) {
        for touch in &mut self.touches {
            if let Touch::Closing { .. } = touch {
                *touch = Touch::Resting;
            }
        }
        self.closing.clear();
    }

    /// The gap that was located closes, however it is rounded.
    pub(crate) fn add(&mut self, hit: Option<Gap>) {
        match hit {
            Some(Gap::Contact(feature)) => {
                let same = |contact: &Contact| contact.feature.id == feature.id;
                if let Some(index) = self.contacts.iter().position(same)
                    && !matches!(self.touches[index], Touch::Closing { .. })
                {
                    self.touches[index] = Touch::Closing { bounces: self.bounces[index] };
                }
            }
            Some(Gap::Limit(source)) if !self.reached.contains(&source) => {
                self.reached.push(source);
                self.closing.push(source);
            }
            _ => {}
        }
    }

    /// The row of an impact that tells its time: that of the located gap, or the first that closes. Rows
    /// of contacts count those that touch.
    pub(crate) fn cause(&self, hit: Option<Gap>) -> Option<RowSource> {
        let located = |contact: &Contact| match hit {
            Some(Gap::Contact(feature)) => contact.feature.id == feature.id,
            _ => false,
        };
        let touching: Vec<_> = self.with(|_, touch| touch != Touch::Apart).collect();
        let closes = |(_, touch): &(&Contact, Touch)| matches!(touch, Touch::Closing { .. });
        let index = touching.iter().position(|(contact, _)| located(contact));
        match (hit, index) {
            (Some(Gap::Limit(source)), _) => Some(source),
            (_, Some(index)) => Some(RowSource::Normal { contact: number(index) }),
            _ => {
                let first = touching.iter().position(closes);
                let contact = first.map(|index| RowSource::Normal { contact: number(index) });
                contact.or(self.closing.first().copied())
            }
        }
    }

    /// Contacts of which something is true, with what they do.
    pub(crate) fn with(
        &self,
        holds: impl Fn(&Contact, Touch) -> bool,
    ) -> impl Iterator<Item = (&Contact, Touch)> {
        let all = self.contacts.iter().zip(self.touches.iter().copied());
        all.filter(move |(contact, touch)| holds(contact, *touch))
    }
}

/// A state that is looked at.
struct Look<'a> {
    context: RowContext<'a>,
    /// What free bodies gain within a step, m/s and rad/s.
    gains: &'a [Vector3<f64>],
    /// Whether what follows is a smooth flow.
    smooth: bool,
    /// What motors at their maximum give bodies within a step, m/s and rad/s; empty where it is not asked.
    driven: &'a [Vector3<f64>],
}

impl Look<'_> {
    /// What a contact does, and whether it would open again if it closed.
    fn contact(&self, index: u32) -> (Touch, bool) {
        let contact = &self.context.contacts[index as usize];
        let (gap, slop) = (contact.gap, self.context.contact_slop(index));
        let row = self.context.geometry(RowSource::Normal { contact: index });
        let [a, b] = self.context.contact_bodies(index);
        let (u, e) = (self.context.speed(&row), self.context.scene.pair_restitution(a, b).value);
        let (noise, rest) = (self.noise(&row), 0.5 * (1.0 - e) * self.pull(&row));
        let bounces = -e * u > rest.max(noise);
        let stays = if self.smooth { noise } else { rest.max(noise) };
        let touch = if gap > slop || (u < -noise && gap > LOCATED * slop) {
            Touch::Apart
        } else if u < -noise {
            Touch::Closing { bounces }
        } else if u <= stays {
            Touch::Resting
        } else {
            Touch::Leaving
        };
        (touch, bounces)
    }

    /// Speed at which free bodies would close a gap within a step if either of them, or none, were held,
    /// m/s.
    fn pull(&self, row: &RowGeometry) -> f64 {
        let side = |k: usize| row.bodies[k].map_or(0.0, |b| -row.jacobian[k].dot(&self.gains[b]));
        let [a, b] = [side(0), side(1)];
        a.max(b).max(a + b).max(0.0)
    }

    /// What of a row's speed may be rounding.
    fn noise(&self, row: &RowGeometry) -> f64 {
        let driven = |body: usize| self.driven.get(body).copied().unwrap_or_default();
        noise(&self.context, row, |body| self.gains[body].abs() + driven(body))
    }

    /// Limits that are reached, and which of them are run into.
    fn limits(&self) -> (Vec<RowSource>, Vec<RowSource>) {
        let (mut reached, mut closing) = (Vec::new(), Vec::new());
        for source in limits(self.context.scene) {
            let row = self.context.geometry(source);
            let slop = self.context.slop(source);
            let (speed, noise) = (self.context.speed(&row), self.noise(&row));
            let closes = speed < -noise;
            let leaves = self.smooth && speed > noise;
            if !leaves && row.value <= if closes { LOCATED * slop } else { slop } {
                reached.push(source);
                closing.extend(closes.then_some(source));
            }
        }
        (reached, closing)
    }

    fn disjointed(&self) -> bool {
        let off = |index: u32, row: &JointRow| {
            let row = self.context.joint_geometry(index, *row);
            self.context.speed(&row).abs() > self.noise(&row)
        };
        let joints = (0_u32..).zip(&self.context.scene.joints);
        let mut rigid = joints.filter(|(_, joint)| joint.softness.is_none());
        rigid.any(|(index, joint)| {
            joint.held.iter().any(|row| off(index, row))
                || (self.smooth && self.is_driven_off(index))
        })
    }

    /// Whether a motor without a maximum is not at its speed.
    fn is_driven_off(&self, joint: u32) -> bool {
        let motor = self.context.joint(joint).motor;
        motor.is_some_and(|motor| motor.max.is_none()) && {
            let row = self.context.geometry(RowSource::Motor { joint });
            let (speed, target) = (self.context.speed(&row), self.context.motor_speed(joint));
            (speed - target).abs() > self.noise(&row) + NOISE * target.abs()
        }
    }
}

/// What of a row's speed may be rounding, for what bodies gain within a step. The speeds of a body come out
/// of the same sums in all directions, so that what is rounding beside one is rounding beside all of them: with
/// its size ℓ and gains g,
///
/// ```text
///  Σ (|J_xy| + |J_θ|/ℓ) (|v| + |g| + ℓ (|ω| + |g_θ|)) · 10⁻¹⁰
/// ```
///
/// (A body that rests against a wall under its weight has no speed at all towards the wall but rounding.) Bodies
/// that move as they are told have no such sums.
pub(crate) fn noise(
    context: &RowContext<'_>,
    row: &RowGeometry,
    gain: impl Fn(usize) -> Vector3<f64>,
) -> f64 {
    let side = |k: usize| {
        let Some(body) = row.bodies[k] else { return 0.0 };
        let (j, v, gain) = (row.jacobian[k].abs(), context.v[body].abs(), gain(body).abs());
        if !context.scene.is_dynamic(body) {
            return j.dot(&(v + gain));
        }
        let size = context.scene.size(body);
        let speed = v.xy().norm() + gain.xy().norm() + size * (v.z + gain.z);
        (j.xy().norm() + j.z / size) * speed
    };
    NOISE * (side(0) + side(1))
}

/// What motors at their maximum give bodies within a step, m/s and rad/s.
fn driven(context: &RowContext<'_>) -> Vec<Vector3<f64>> {
    let scene = context.scene;
    let mut driven = vec![Vector3::zeros(); scene.bodies.len()];
    for (joint, it) in (0_u32..).zip(&scene.joints) {
        let Some(max) = it.motor.and_then(|motor| motor.max) else { continue };
        let row = context.geometry(RowSource::Motor { joint });
        for (body, j) in row.bodies.iter().zip(&row.jacobian) {
            if let Some(body) = body.filter(|body| scene.is_dynamic(*body)) {
                driven[body] += j.abs().component_div(&scene.bodies[body].mass) * (max * scene.dt);
            }
        }
    }
    driven
}

/// All limits of a scene's joints.
pub(crate) fn limits(scene: &Scene) -> impl Iterator<Item = RowSource> {
    (0_u32..).zip(&scene.joints).flat_map(|(joint, it)| {
        let lower = it.limits.lower.map(|_| RowSource::Lower { joint });
        let upper = it.limits.upper.map(|_| RowSource::Upper { joint });
        lower.into_iter().chain(upper)
    })
}

fn number(index: usize) -> u32 {
    u32::try_from(index).expect("fewer contacts than u32 counts")
}
