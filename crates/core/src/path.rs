//! Where a flow first closes a gap.
//!
//! Bodies move along `q(s) = q + s v⁻ + s² (v⁺ − v⁻)/2 h`, in smooth flows along the cubic with the poses and
//! velocities of both ends. A gap g of features that stay the same obeys
//! `g(s + δ) ≥ g + ġ δ − ½ G δ²` with a bound G of its second derivative, and cannot close before that is
//! zero: time advances by the least such δ of all contacts, found again at every stop, until one closes.

use nalgebra::Vector3;
use tangency_collision::{Contact, ContactFeature, Feature};

use crate::mend::pressed;
use crate::motion::Motion;
use crate::record::StepRecord;
use crate::row::{RowContext, RowSource};
use crate::scene::Scene;
use crate::scratch::StepScratch;
use crate::smooth::Slope;
use crate::touch::{Survey, limits};
use crate::{State, StepError};

/// Time advances by at least this part of the flow. What closes and opens again within less, so little
/// that the bound could not tell, passes.
const LEAST: f64 = 1.0 / 256.0;

/// Speeds below this part of those that add up to them do not close a gap.
const NOISE: f64 = 1e-10;

/// A gap that closes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hit {
    /// About when, s from the beginning of the flow.
    pub(crate) at: f64,
    /// Which.
    pub(crate) gap: Gap,
}

/// A gap of bodies or of a limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Gap {
    /// Between features.
    Contact(ContactFeature),
    /// Of a joint's free coordinate.
    Limit(RowSource),
}

impl Gap {
    /// Its value (m or rad) and how fast it grows at a state.
    pub(crate) fn evaluate(&self, scene: &Scene, state: &State) -> [f64; 2] {
        let context = RowContext::of(scene, state, &[], scene.dt);
        let row = match self {
            Self::Limit(source) => context.geometry(*source),
            Self::Contact(feature) => {
                let [a, b] = feature.id.bodies.map(|body| &state.q[body as usize]);
                context.contact_geometries(&feature.evaluate(a, b))[0]
            }
        };
        [row.value, context.speed(&row)]
    }
}

/// The motion of a flow, without what mends it.
pub(crate) struct Path<'a> {
    pub(crate) scene: &'a Scene,
    /// Where it begins.
    pub(crate) from: &'a State,
    /// The flow.
    pub(crate) flow: &'a StepRecord,
    /// Which of a smooth flow's contacts cannot open; empty of other flows, of which none can.
    held: Vec<bool>,
    /// Of a smooth flow how fast bodies accelerate, at least about.
    rates: Vec<Vector3<f64>>,
}

impl<'a> Path<'a> {
    pub(crate) fn new(scene: &'a Scene, from: &'a State, flow: &'a StepRecord) -> Self {
        let held = match flow.motion {
            Motion::Smooth => pressed(flow, Vec::new()),
            _ => Vec::new(),
        };
        let smooth = flow.smooth.as_ref();
        let rates = smooth.map_or_else(Vec::new, |smooth| smooth.slopes[0].rates());
        Self { scene, from, flow, held, rates }
    }
}

impl Path<'_> {
    /// The first gap that closes; contacts and limits that have rows in the flow do not.
    pub(crate) fn first_hit(
        &self,
        survey: &Survey,
        scratch: &mut StepScratch,
    ) -> Result<Option<Hit>, StepError> {
        let (h, mut found) = (self.flow.dt, scratch.contacts.take());
        let reach = scratch.detection.groups().greatest();
        let (mut s, mut hit) = (0.0, None);
        loop {
            let state = self.state(s);
            hit = hit.or(self.limit_hit(&state, survey, s));
            let mut step = f64::INFINITY;
            if self.scene.touches {
                scratch.frames.place(&state.q);
                let frames = scratch.frames.bodies();
                scratch.detection.within(self.scene, state.time, frames, reach, &mut found)?;
                for contact in &found {
                    match self.ahead(&state, contact) {
                        Ahead::Closed { within } => hit = Some(earlier(hit, contact, s + within)),
                        Ahead::Free { within } => step = step.min(within),
                    }
                }
            }
            if hit.is_some() || s >= h {
                scratch.contacts.give(found);
                return Ok(hit);
            }
            s = (s + step.max(LEAST * h)).min(h);
        }
    }

    /// Poses and velocities after a time s.
    pub(crate) fn state(&self, s: f64) -> State {
        let (mut state, part) = (self.from.clone(), s / self.flow.dt);
        if self.flow.motion == Motion::Smooth {
            self.bend_to(part, &mut state);
            return state;
        }
        for (i, after) in self.flow.after.v.iter().enumerate() {
            let gain = after - self.from.v[i];
            state.q[i] += s * (self.from.v[i] + 0.5 * part * gain);
            state.v[i] += part * gain;
        }
        state
    }

    /// The cubic of a smooth flow at the part θ of it:
    ///
    /// ```text
    ///  q = q₀ + θ h v₀ + θ² (3 Δ − h (2 v₀ + v₁)) + θ³ (h (v₀ + v₁) − 2 Δ)        Δ = q₁ − q₀
    /// ```
    fn bend_to(&self, part: f64, state: &mut State) {
        let (h, after) = (self.flow.dt, &self.flow.after);
        for (i, (q, v)) in state.q.iter_mut().zip(&mut state.v).enumerate() {
            let (way, first, last) = (after.q[i] - *q, *v, after.v[i]);
            let (square, cube) =
                (3.0 * way - h * (2.0 * first + last), h * (first + last) - 2.0 * way);
            *q += part * (h * first + part * (square + part * cube));
            *v += part * (2.0 * square + 3.0 * part * cube) / h;
        }
    }

    /// A limit that is passed.
    fn limit_hit(&self, state: &State, survey: &Survey, at: f64) -> Option<Hit> {
        let free = limits(self.scene).filter(|source| !survey.reached.contains(source));
        let mut gaps = free.map(Gap::Limit);
        let gap = gaps.find(|gap| {
            let [value, rate] = gap.evaluate(self.scene, state);
            value <= 0.0 && rate < 0.0
        })?;
        Some(Hit { at, gap })
    }

    /// For how long a contact cannot close.
    fn ahead(&self, state: &State, contact: &Contact) -> Ahead {
        const NEVER: Ahead = Ahead::Free { within: f64::INFINITY };
        let id = contact.feature.id;
        let resting = self.flow.contacts.iter().position(|resting| resting.feature.id == id);
        if resting.is_some_and(|index| self.held.get(index).is_none_or(|held| *held)) {
            return NEVER;
        }
        let context = RowContext::of(self.scene, state, &[], self.scene.dt);
        let row = context.contact_geometries(contact)[0];
        let (gap, rate) = (contact.gap, context.speed(&row));
        let bodies = id.bodies.map(|body| body as usize);
        let sides = bodies.iter().zip(&row.jacobian);
        let speeds: f64 = sides.map(|(body, j)| j.abs().dot(&state.v[*body].abs())).sum();
        let [a, b] = bodies.map(|body| self.scene.size(body));
        let gains = bodies.iter().zip(&row.jacobian).map(|(body, j)| {
            let rate = self.rates.get(*body).map_or(0.0, Vector3::norm);
            j.amax() * rate * self.scene.dt
        });
        let (touches, noise) = (gap <= SLOP * a.min(b), NOISE * (speeds + gains.sum::<f64>()));
        if touches && rate < -noise {
            return Ahead::Closed { within: gap / -rate };
        }
        if touches && rate <= noise {
            return NEVER;
        }
        Ahead::Free { within: first_zero(gap.max(0.0), rate, self.bend(contact, state)) }
    }

    /// A bound of |g̈| from now on. Of a line on body l and a point x, with y = x − p_l,
    ///
    /// ```text
    ///  g = n·y + const        |g̈| ≤ (α + ω²) |y| + 2 ω |ẏ| + |ÿ|          α, ω of l
    ///  |ÿ| ≤ |a_rel| + (α + ω²) |ρ|                                       α, ω of the point's body
    /// ```
    fn bend(&self, contact: &Contact, state: &State) -> f64 {
        let [a, b] = contact.feature.id.bodies.map(|body| body as usize);
        let [turn_a, turn_b] = [self.turn(a), self.turn(b)];
        let apart = self.apart(a, b);
        let spin = |[rate, change]: [f64; 2], arm: f64| (change + rate * rate) * arm;
        let line = |l: usize, x: usize, arm: f64| {
            let ([rate, _], way) =
                (self.turn(l), self.speed(l) + self.speed(x) + self.turn(x)[0] * arm);
            let far = (contact.point - state.q[l].xy()).norm() + way * self.flow.dt;
            if rate == 0.0 {
                0.0
            } else {
                spin(self.turn(l), far) + 2.0 * rate * (way + rate * far)
            }
        };
        apart
            + match contact.feature.feature {
                Feature::Points { a, b } => spin(turn_a, a.norm()) + spin(turn_b, b.norm()),
                Feature::LineA { b: x, .. } => spin(turn_b, x.norm()) + line(a, b, x.norm()),
                Feature::LineB { a: x, .. } => spin(turn_a, x.norm()) + line(b, a, x.norm()),
            }
    }

    fn acceleration(&self, body: usize) -> Vector3<f64> {
        (self.flow.after.v[body] - self.from.v[body]) / self.flow.dt
    }

    /// How fast two bodies accelerate apart, at most, m/s².
    fn apart(&self, a: usize, b: usize) -> f64 {
        let apart = |of: &dyn Fn(usize) -> Vector3<f64>| (of(a) - of(b)).xy().norm();
        self.most(|slope| apart(&|body| slope.accelerations[body]))
            .unwrap_or_else(|| apart(&|body| self.acceleration(body)))
    }

    /// The most of what a smooth flow's slopes show, with room for what lies between them.
    fn most(&self, of: impl Fn(&Slope) -> f64) -> Option<f64> {
        let smooth = self.flow.smooth.as_ref()?;
        Some(2.0 * smooth.slopes.iter().map(of).fold(0.0, f64::max))
    }

    /// Greatest speed of a body, m/s.
    fn speed(&self, body: usize) -> f64 {
        self.from.v[body].xy().norm().max(self.flow.after.v[body].xy().norm())
    }

    /// ω and α of a body, at most, rad/s and rad/s².
    fn turn(&self, body: usize) -> [f64; 2] {
        let rate = self.from.v[body].z.abs().max(self.flow.after.v[body].z.abs());
        let change = self.most(|slope| slope.accelerations[body].z.abs());
        [rate, change.unwrap_or_else(|| self.acceleration(body).z.abs())]
    }
}

/// What part of a body's size is rounding of a gap.
const SLOP: f64 = 1e-9;

/// What a contact does next.
enum Ahead {
    /// It closes, about after this time, s.
    Closed { within: f64 },
    /// It does not before this time, s.
    Free { within: f64 },
}

/// The earlier of what was found and another contact.
fn earlier(hit: Option<Hit>, contact: &Contact, at: f64) -> Hit {
    let new = Hit { at, gap: Gap::Contact(contact.feature) };
    hit.filter(|hit| hit.at <= at).unwrap_or(new)
}

/// The first positive zero of g + r δ − ½ G δ², which is at or above zero at first.
fn first_zero(g: f64, r: f64, bend: f64) -> f64 {
    let root = (r * r + 2.0 * bend * g).sqrt();
    if r < 0.0 { 2.0 * g / (root - r) } else { (r + root) / bend }
}
