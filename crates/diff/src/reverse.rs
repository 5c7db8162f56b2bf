//! One step after the other read backwards, in memory that every step uses again.

use nalgebra::Vector3;
use tangency_core::row::RowContext;
use tangency_core::{IslandRecord, Motion, PostRecord, Scene, State, StepRecord};

use crate::error::DiffError;
use crate::impulse::ImpulseSeeds;
use crate::lcp::LcpAdjoint;
use crate::report::GradientReport;
use crate::rotations::Rotations;
use crate::vector::Bars;
use crate::{island, momentum, sizes};

/// The reverse pass of a step, and its memory.
#[derive(Debug, Default)]
pub(crate) struct Reverse {
    pub(crate) adjoint: LcpAdjoint,
    pub(crate) rotations: Rotations,
    /// ∂L/∂λ of the step.
    pub(crate) impulses: ImpulseSeeds,
    /// ∂L/∂v⁺, or by the displacement, per body of an island.
    pub(crate) seed: Vec<Vector3<f64>>,
    /// ∂L/∂v⁺ per body.
    v_bar: Vec<Vector3<f64>>,
    /// ∂L/∂p per body.
    pub(crate) p_bar: Vec<Vector3<f64>>,
    /// ∂L/∂a per body, of one slope of a smooth flow.
    pub(crate) a_bar: Vec<Vector3<f64>>,
    /// Which bodies have rows.
    bound: Vec<bool>,
    /// ∂L/∂q⁺ of a flow while the gradient by the poses of its rows is collected.
    q_bar: Vec<Vector3<f64>>,
}

impl Reverse {
    /// Turns `bars.state` = ∂L/∂(state after the step) into ∂L/∂(state before), and adds to the
    /// other bars and to `report`.
    pub(crate) fn step(
        &mut self,
        scene: &Scene,
        before: &State,
        record: &StepRecord,
        bars: &mut Bars<'_>,
        report: &mut GradientReport,
    ) -> Result<(), DiffError> {
        if record.fell_back() {
            report.add_fall_back();
        }
        if record.parts.is_empty() {
            self.part(scene, before, record, bars, report)?;
        } else {
            self.division(scene, before, record, bars, report)?;
        }
        sizes::state_vector("the gradient by a state", scene, bars.state)?;
        sizes::finite("the gradient by a control", bars.control.iter().all(|u| u.is_finite()))
    }

    /// The same for a step that is not divided, or for a part of one; `bars.scene.dt` collects the
    /// gradient by its length.
    pub(crate) fn part(
        &mut self,
        scene: &Scene,
        before: &State,
        record: &StepRecord,
        bars: &mut Bars<'_>,
        report: &mut GradientReport,
    ) -> Result<(), DiffError> {
        if let Some(smooth) = &record.smooth {
            return self.smooth(scene, record, smooth, bars, report);
        }
        for post in record.post.iter().rev() {
            self.displacement(scene, record, post, bars, report)?;
        }
        self.motion(before, record, bars);
        let flows = record.motion == Motion::Flow;
        if flows {
            self.q_bar.clear();
            self.q_bar.resize(bars.state.q.len(), Vector3::zeros());
            std::mem::swap(&mut self.q_bar, &mut bars.state.q);
        }
        // v⁺ from the islands, from p/m in free flight, or driven.
        self.free_flight(scene, record, bars);
        self.rotations.renew(before.q.len());
        let context = record.velocity_context(scene, before);
        for island in &record.islands {
            self.seed.clear();
            self.seed.extend(island.bodies.iter().map(|body| self.v_bar[*body as usize]));
            self.island(&context, island, Some(1.0), bars, report)?;
            report.add_bounces(&context, island);
            for (body, bar) in island.bodies.iter().zip(self.adjoint.momentum()) {
                self.p_bar[*body as usize] = *bar;
            }
        }
        momentum::vjp(&context, before.time, &self.p_bar, &mut self.rotations, bars);
        if flows {
            self.midway(before, record, bars);
        }
        Ok(())
    }

    /// q + ½ h v⁻ of the rows: shares the gradient by it out, and adds that by q⁺.
    fn midway(&self, before: &State, record: &StepRecord, bars: &mut Bars<'_>) {
        let state = &mut *bars.state;
        for (i, (q, v)) in state.q.iter_mut().zip(&mut state.v).enumerate() {
            *v += *q * (0.5 * record.dt);
            bars.scene.dt += 0.5 * q.dot(&before.v[i]);
            *q += self.q_bar[i];
        }
    }

    /// q̃ + dt w: turns the gradient by it into that by q̃.
    pub(crate) fn displacement(
        &mut self,
        scene: &Scene,
        record: &StepRecord,
        post: &PostRecord,
        bars: &mut Bars<'_>,
        report: &mut GradientReport,
    ) -> Result<(), DiffError> {
        self.rotations.renew(post.moved.len());
        let context = record.post_context(scene, post);
        for island in &post.islands {
            self.seed.clear();
            for (body, w) in island.bodies.iter().zip(&island.solution.velocities) {
                let q_bar = bars.state.q[*body as usize];
                bars.scene.dt += q_bar.dot(w);
                self.seed.push(q_bar * record.dt);
            }
            self.island(&context, island, None, bars, report)?;
        }
        Ok(())
    }

    /// One problem: from `seed`, and from ∂L/∂λ times `weight` if its impulses count, to all that it was
    /// assembled from, but for p.
    pub(crate) fn island(
        &mut self,
        context: &RowContext<'_>,
        island: &IslandRecord,
        weight: Option<f64>,
        bars: &mut Bars<'_>,
        report: &mut GradientReport,
    ) -> Result<(), DiffError> {
        let IslandRecord { problem, solution, .. } = island;
        let weight = weight.filter(|_| self.impulses.any());
        let impulses = weight.and_then(|weight| self.impulses.of(island, weight));
        self.adjoint.solve(problem, solution, &self.seed, impulses)?;
        report.add(island, &self.adjoint.report(problem, solution));
        island::vjp(context, island, &self.adjoint, &mut self.rotations, bars);
        Ok(())
    }

    /// q̃ = q + dt v⁺ (of a flow q + ½ dt (v⁻ + v⁺), of an impact q), time⁺ = time + dt: leaves ∂L/∂v⁺ in
    /// `v_bar`, and in `bars.state.v` what comes through v⁻.
    fn motion(&mut self, before: &State, record: &StepRecord, bars: &mut Bars<'_>) {
        self.v_bar.clear();
        let dt = record.dt;
        let (mut dt_bar, state) = (bars.state.time, &mut *bars.state);
        for (i, (v_bar, q_bar)) in state.v.iter_mut().zip(&state.q).enumerate() {
            let v = &record.after.v[i];
            let (by_after, by_before) = match record.motion {
                Motion::Fixed => (q_bar * dt, Vector3::zeros()),
                Motion::Flow => (q_bar * (0.5 * dt), q_bar * (0.5 * dt)),
                Motion::Impact | Motion::Projection | Motion::Smooth => {
                    (Vector3::zeros(), Vector3::zeros())
                }
            };
            self.v_bar.push(*v_bar + by_after);
            *v_bar = by_before;
            dt_bar += match record.motion {
                Motion::Flow => 0.5 * q_bar.dot(&(before.v[i] + v)),
                _ => q_bar.dot(v),
            };
        }
        bars.scene.dt += dt_bar;
    }

    /// v⁺ = p/m for bodies without rows, v⁺ = v for bodies without unknowns; begins `p_bar`.
    fn free_flight(&mut self, scene: &Scene, record: &StepRecord, bars: &mut Bars<'_>) {
        self.bound.clear();
        self.bound.resize(self.v_bar.len(), false);
        let bound = record.islands.iter().flat_map(|island| &island.bodies);
        bound.for_each(|body| self.bound[*body as usize] = true);
        self.p_bar.clear();
        self.p_bar.resize(self.v_bar.len(), Vector3::zeros());
        for (i, v_bar) in self.v_bar.iter().enumerate().filter(|(i, _)| !self.bound[*i]) {
            if scene.is_dynamic(i) {
                self.p_bar[i] = v_bar.component_div(&scene.bodies()[i].mass);
                bars.scene.bodies[i].mass -= self.p_bar[i].component_mul(&record.after.v[i]);
            } else {
                bars.state.v[i] += v_bar;
            }
        }
    }
}
