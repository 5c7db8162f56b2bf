//! Derivatives of smooth flows, slope by slope.
//!
//! ```text
//!  a_k = a(q_k, v_k)        q_k+1 = q + c_k h v_k        v_k+1 = v + c_k h a_k        c = ½, ½, 1
//!  q̃ = q + h Σ w_k v_k      ṽ = v + h Σ w_k a_k                                       w = 1/6, 1/3, 1/3, 1/6
//!
//!  backwards, from k = 4:   v̄_k = h (w_k q̃̄ + c_k q̄_k+1)        ā_k = h (w_k ṽ̄ + c_k v̄_k+1)
//!                           h̄  += w_k (q̃̄·v_k + ṽ̄·a_k) + c_k (q̄_k+1·v_k + v̄_k+1·a_k)
//!                           (q̄_k, v̄_k) += ∂a/∂(q, v)ᵀ ā_k          q̄ += q̄_k,  v̄ += v̄_k
//! ```
//!
//! Displacements and the impulses that meet what is held follow as in any step. The impulse of a row is
//! λ = h Σ w_k λ_k: ∂L/∂λ_k = h w_k λ̄.
//!
//! Velocities that break what the flow holds by δ are brought to it within O(δ): a contact that begins to slide
//! stops after |δ|/(μ g), one that opens lands after 2 δ/g, one that closes has an impact. At the limit
//! nothing moves meanwhile, and what they become obeys the flow's rows in their modes,
//!
//! ```text
//!  M v⁺ = M v + Jᵀ Λ       J v⁺ = 0 of what presses and sticks       Λt = ±μ Λn of what slides
//! ```
//!
//! with v⁺ = v and Λ = 0 at the state itself: a derivative that is none of the values. (Of a contact that opens
//! by δ friction misses μ m g 2 δ/g while it is in flight, and has μ m δ of that at its impact.)

use nalgebra::Vector3;
use tangency_core::row::RowContext;
use tangency_core::{
    IslandRecord, Motion, STEPS, Scene, Slope, SmoothRecord, State, StepRecord, WEIGHTS,
};

use crate::error::DiffError;
use crate::impulse::RowImpulse;
use crate::lcp::lcp_jvp;
use crate::report::GradientReport;
use crate::reverse::Reverse;
use crate::step::{bodies_with_rows, contact_changes, part_jvp, post_jvp, scatter};
use crate::vector::{Bars, Direction, SceneVector, StateVector};
use crate::{impulse, island, momentum};

impl Reverse {
    /// A smooth flow: as [`part`](Self::part).
    pub(crate) fn smooth(
        &mut self,
        scene: &Scene,
        record: &StepRecord,
        smooth: &SmoothRecord,
        bars: &mut Bars<'_>,
        report: &mut GradientReport,
    ) -> Result<(), DiffError> {
        if let Some(meeting) = &smooth.meeting {
            self.unseen(scene, &meeting.before, &meeting.record, bars)?;
        }
        for post in record.post.iter().rev() {
            self.displacement(scene, record, post, bars, report)?;
        }
        let (after, mut total) = (bars.state.clone(), bars.state.clone());
        let mut dt_bar = after.time;
        let mut next: Option<(f64, StateVector)> = None;
        for (k, slope) in smooth.slopes.iter().enumerate().rev() {
            let mut ways = vec![(WEIGHTS[k], &after)];
            ways.extend(next.as_ref().map(|(part, bar)| (*part, bar)));
            let mut own = StateVector::zeros(after.q.len());
            self.a_bar.clear();
            self.a_bar.resize(after.q.len(), Vector3::zeros());
            for (part, bar) in ways {
                dt_bar += part * (inner(&bar.q, &slope.at.v) + inner(&bar.v, &slope.accelerations));
                let part = part * record.dt;
                own.v.iter_mut().zip(&bar.q).for_each(|(to, q)| *to += q * part);
                self.a_bar.iter_mut().zip(&bar.v).for_each(|(to, v)| *to += v * part);
            }
            let by_length = bars.scene.dt;
            let Bars { control, scene: numbers, .. } = bars;
            let mut slope_bars = Bars { state: &mut own, control, scene: numbers };
            let mut unseen = GradientReport::default();
            let report = if k == 0 { &mut *report } else { &mut unseen };
            self.slope(scene, record, (slope, WEIGHTS[k] * record.dt), &mut slope_bars, report)?;
            bars.scene.dt = by_length;
            if self.impulses.any() {
                let along = slope.islands.iter().map(|island| self.impulses.along(island));
                dt_bar += WEIGHTS[k] * along.sum::<f64>();
            }
            total.add(&own);
            next = k.checked_sub(1).map(|before| (STEPS[before], own));
        }
        *bars.state = total;
        if let Some(start) = start(record, smooth) {
            self.unseen(scene, &start.after, &start, bars)?;
        }
        bars.scene.dt += dt_bar;
        Ok(())
    }

    /// A change of velocities that takes no time, whose impulses are nobody's.
    fn unseen(
        &mut self,
        scene: &Scene,
        before: &State,
        record: &StepRecord,
        bars: &mut Bars<'_>,
    ) -> Result<(), DiffError> {
        let (by_length, impulses) = (bars.scene.dt, std::mem::take(&mut self.impulses));
        self.part(scene, before, record, bars, &mut GradientReport::default())?;
        self.impulses = impulses;
        bars.scene.dt = by_length;
        Ok(())
    }

    /// From `a_bar`, the gradient by the accelerations of a slope, which stands for so much time, to all that
    /// they depend on.
    fn slope(
        &mut self,
        scene: &Scene,
        record: &StepRecord,
        (slope, time): (&Slope, f64),
        bars: &mut Bars<'_>,
        report: &mut GradientReport,
    ) -> Result<(), DiffError> {
        let context = record.slope_context(scene, slope);
        let bound = bodies_with_rows(scene, &slope.islands);
        self.p_bar.clear();
        self.p_bar.resize(bound.len(), Vector3::zeros());
        for i in (0..bound.len()).filter(|i| scene.is_dynamic(*i) && !bound[*i]) {
            self.p_bar[i] = self.a_bar[i].component_div(&scene.bodies()[i].mass);
            bars.scene.bodies[i].mass -= self.p_bar[i].component_mul(&slope.accelerations[i]);
        }
        self.rotations.renew(bound.len());
        for island in &slope.islands {
            self.seed.clear();
            self.seed.extend(island.bodies.iter().map(|body| self.a_bar[*body as usize]));
            self.island(&context, island, Some(time), bars, report)?;
            for (body, bar) in island.bodies.iter().zip(self.adjoint.momentum()) {
                self.p_bar[*body as usize] = *bar;
            }
        }
        let p_bar = std::mem::take(&mut self.p_bar);
        momentum::vjp(&context, record.middle(), &p_bar, &mut self.rotations, bars);
        self.p_bar = p_bar;
        Ok(())
    }
}

/// The change of the state after a smooth flow along a direction; `along.scene.dt` is that of its length. Adds
/// the changes of its impulses to `impulses`.
pub(crate) fn jvp(
    scene: &Scene,
    record: &StepRecord,
    smooth: &SmoothRecord,
    along: &Direction<'_>,
    part: Option<usize>,
    impulses: &mut Vec<RowImpulse>,
) -> Result<StateVector, DiffError> {
    let (h, dh) = (record.dt, along.scene.dt);
    let first = impulses.len();
    let numbers = SceneVector { dt: 0.0, ..along.scene.clone() };
    let mut before = along.state.clone();
    if let Some(start) = start(record, smooth) {
        let direction = Direction { scene: &numbers, ..*along };
        before = part_jvp(scene, &start.after, &start, &direction, part, &mut Vec::new())?;
    }
    let mut d_after = before.clone();
    d_after.time += dh;
    let mut at = before.clone();
    for (k, slope) in smooth.slopes.iter().enumerate() {
        let direction = Direction { state: &at, control: along.control, scene: &numbers };
        let context = record.slope_context(scene, slope);
        let (da, forces) = slope_jvp(&context, record.middle(), slope, &direction)?;
        let own = impulse_changes(part, slope, &forces, WEIGHTS[k] * dh, WEIGHTS[k] * h);
        if k == 0 {
            impulses.extend(own);
        } else {
            impulses[first..].iter_mut().zip(own).for_each(|(all, own)| all.value += own.value);
        }
        let rate = Rate { h, dh, slope, dv: &at.v, da: &da };
        rate.add(WEIGHTS[k], &mut d_after);
        if let Some(part) = STEPS.get(k) {
            let mut next = before.clone();
            rate.add(*part, &mut next);
            at = next;
        }
    }
    for post in &record.post {
        post_jvp(scene, record, post, &mut d_after, along.scene)?;
    }
    let Some(meeting) = &smooth.meeting else { return Ok(d_after) };
    let direction = Direction { state: &d_after, control: along.control, scene: &numbers };
    part_jvp(scene, &meeting.before, &meeting.record, &direction, part, &mut Vec::new())
}

/// What brings velocities to what a flow holds from its beginning: those of the state obey it already.
fn start(record: &StepRecord, smooth: &SmoothRecord) -> Option<StepRecord> {
    let slope = smooth.slopes.first().filter(|slope| !slope.islands.is_empty())?;
    let mut islands = slope.islands.clone();
    for IslandRecord { bodies, problem, solution, .. } in &mut islands {
        solution.impulses.fill(0.0);
        for (k, body) in bodies.iter().enumerate() {
            solution.velocities[k] = slope.at.v[*body as usize];
            problem.momentum[k] = problem.mass[k].component_mul(&solution.velocities[k]);
        }
    }
    (record.dt > 0.0).then(|| StepRecord {
        control: record.control.clone(),
        motion: Motion::Projection,
        dt: 0.0,
        parts: Vec::new(),
        hit: None,
        midway: Vec::new(),
        bounces: Vec::new(),
        contacts: slope.contacts.clone(),
        islands,
        smooth: None,
        fell_back: false,
        post: Vec::new(),
        after: slope.at.clone(),
    })
}

/// d(h w λ) of the rows of a slope, given dλ of its islands, d(h w) and h w.
fn impulse_changes(
    part: Option<usize>,
    slope: &Slope,
    forces: &[Vec<f64>],
    d_time: f64,
    time: f64,
) -> Vec<RowImpulse> {
    let mut list = Vec::new();
    for (island, changes) in slope.islands.iter().zip(forces) {
        let both = island.solution.impulses.iter().zip(changes);
        let all: Vec<f64> = both.map(|(force, change)| d_time * force + time * change).collect();
        impulse::list(part, island, &all, &mut list);
    }
    list
}

/// h (v_k, a_k) and its change.
struct Rate<'a> {
    h: f64,
    dh: f64,
    slope: &'a Slope,
    dv: &'a [Vector3<f64>],
    da: &'a [Vector3<f64>],
}

impl Rate<'_> {
    /// Adds the change of a part of it.
    fn add(&self, part: f64, to: &mut StateVector) {
        let (h, dh, State { v, .. }) = (part * self.h, part * self.dh, &self.slope.at);
        for (i, (q, dv)) in to.q.iter_mut().zip(&mut to.v).enumerate() {
            *q += self.dv[i] * h + v[i] * dh;
            *dv += self.da[i] * h + self.slope.accelerations[i] * dh;
        }
    }
}

/// The change of the accelerations of a slope, and of the forces of its islands' rows.
type SlopeChange = (Vec<Vector3<f64>>, Vec<Vec<f64>>);

/// The change of a slope along a direction.
fn slope_jvp(
    context: &RowContext<'_>,
    middle: f64,
    slope: &Slope,
    along: &Direction<'_>,
) -> Result<SlopeChange, DiffError> {
    let scene = context.scene;
    let force = momentum::jvp(context, middle, along);
    let bound = bodies_with_rows(scene, &slope.islands);
    let mut change = vec![Vector3::zeros(); bound.len()];
    for i in (0..bound.len()).filter(|i| scene.is_dynamic(*i) && !bound[*i]) {
        let dm = along.scene.bodies[i].mass.component_mul(&slope.accelerations[i]);
        change[i] = (force[i] - dm).component_div(&scene.bodies()[i].mass);
    }
    let contacts = contact_changes(context, along);
    let mut forces = Vec::with_capacity(slope.islands.len());
    for island in &slope.islands {
        let d_problem = island::jvp(context, island, &contacts, &force, along);
        let (da, pushed) = lcp_jvp(&island.problem, &island.solution, &d_problem)?;
        scatter(&island.bodies, &da, &mut change);
        forces.push(pushed);
    }
    Ok((change, forces))
}

fn inner(a: &[Vector3<f64>], b: &[Vector3<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}
