//! All derivatives of one step at once: A = ∂x⁺/∂x, B = ∂x⁺/∂u, P = ∂x⁺/∂p.
//!
//! ```text
//!  p = M v + dt f(q, u)      v⁺ = LCP(M, p, rows(q, v, u))
//!
//!  ∂v⁺/∂(q, v) = ∂v⁺/∂p · ∂p/∂(q, v) + what comes through the rows       (an island's response)
//!  q̃ = q + dt v⁺             ∂q̃ = ∂q + dt ∂v⁺
//!  q⁺ = q̃ + dt w(q̃, v⁺)      ∂q⁺ = ∂q̃ + dt (∂w/∂q̃ ∂q̃ + ∂w/∂v⁺ ∂v⁺)   (only where mended)
//! ```
//!
//! Each island is factored once, or not at all where its solver left a factorisation; its 3 k
//! velocities are solved for backwards, half as many right-hand sides as there are directions.

use std::borrow::Cow;
use std::sync::Arc;

use nalgebra::{DMatrix, DVector};
use tangency_core::lcp::{ActiveSystem, Metric};
use tangency_core::row::RowContext;
use tangency_core::{Control, IslandRecord, Scene, State, StepRecord};

use crate::coordinates::Coordinates;
use crate::division::is_divided;
use crate::error::DiffError;
use crate::island::Response;
use crate::joint_force::JointForce;
use crate::lcp::LcpAdjoint;
use crate::parameter::Parameter;
use crate::report::GradientReport;
use crate::sizes;
use crate::step::{step_jvp, step_vjp};
use crate::vector::{Direction, SceneVector, StateVector};

/// The derivatives of the state after a step. Rows are the [`Coordinates`] of the state after it.
#[derive(Clone, Debug, PartialEq)]
pub struct StepJacobian {
    /// A = ∂x⁺/∂x, 6 n × 6 n.
    pub state: DMatrix<f64>,
    /// B = ∂x⁺/∂u, 6 n × channels.
    pub control: DMatrix<f64>,
    /// P, 6 n × parameters.
    pub parameters: DMatrix<f64>,
    /// Rows at a switch, where the derivative is one-sided; its step is 0.
    pub report: GradientReport,
}

/// All derivatives of a recorded step: by the state before it, the control, and `parameters`.
///
/// The derivative by a parameter is that of this step alone: initial positions and velocities are part
/// of the state, and a parameter that sets them has a zero column.
///
/// # Errors
/// As [`step_vjp`](crate::step_vjp).
pub fn step_jacobian(
    scene: &Scene,
    before: &State,
    record: &StepRecord,
    parameters: &[Parameter],
) -> Result<StepJacobian, DiffError> {
    sizes::step(scene, before, record)?;
    if is_divided(record) {
        return by_directions(scene, before, record, parameters);
    }
    let record = &*factored(record);
    let mut assembly = Assembly::new(scene, before, record)?;
    assembly.add_momentum();
    let mut by = assembly.motion();
    for post in &record.post {
        assembly.mend(&record.post_context(scene, post), &post.islands, &mut by)?;
    }
    let [state, control] = by;
    let parameters = by_parameters(scene, before, record, &assembly.coordinates, parameters)?;
    assembly.report.end();
    let finite = state.iter().chain(&control).all(|x| x.is_finite());
    sizes::finite("the Jacobian of a step", finite)?;
    Ok(StepJacobian { state, control, parameters, report: assembly.report })
}

/// The record with a factored system for every problem.
fn factored(record: &StepRecord) -> Cow<'_, StepRecord> {
    let post = record.post.iter().flat_map(|post| &post.islands);
    if record.islands.iter().chain(post).all(is_factored) {
        return Cow::Borrowed(record);
    }
    let mut record = record.clone();
    let post = record.post.iter_mut().flat_map(|post| &mut post.islands);
    record.islands.iter_mut().chain(post).for_each(factor);
    Cow::Owned(record)
}

fn is_factored(IslandRecord { solution, .. }: &IslandRecord) -> bool {
    solution.system.is_some() || solution.central.is_some()
}

fn factor(IslandRecord { problem, solution, .. }: &mut IslandRecord) {
    if solution.system.is_none() && solution.central.is_none() {
        let system = ActiveSystem::new(problem, &Metric::new(problem), &solution.modes);
        solution.system = Some(Arc::new(system));
    }
}

/// The same of a step that impacts divide, column by column: each part is a step of its own.
fn by_directions(
    scene: &Scene,
    before: &State,
    record: &StepRecord,
    parameters: &[Parameter],
) -> Result<StepJacobian, DiffError> {
    let coordinates = Coordinates::of(scene);
    let (size, channels) = (coordinates.size(), scene.controls().len());
    let still = SceneVector::like(scene);
    let column = |x: &DVector<f64>, u: &[f64]| {
        let state = coordinates.spread(x.column(0));
        let along = Direction { state: &state, control: u, scene: &still };
        Ok::<_, DiffError>(coordinates.flatten(&step_jvp(scene, before, record, &along)?))
    };
    let unit = |size: usize, k: usize| DVector::from_fn(size, |i, _| f64::from(u8::from(i == k)));
    let (zero, mut report) = (DVector::zeros(size), GradientReport::default());
    let mut state = DMatrix::zeros(size, size);
    for k in 0..size {
        state.set_column(k, &column(&unit(size, k), &vec![0.0; channels])?);
    }
    let mut control = DMatrix::zeros(size, channels);
    for k in 0..channels {
        control.set_column(k, &column(&zero, unit(channels, k).as_slice())?);
    }
    let parameters = by_parameters(scene, before, record, &coordinates, parameters)?;
    let (mut by_control, mut by_scene) = (vec![0.0; channels], still.clone());
    let nothing = StateVector::like(before);
    step_vjp(scene, before, record, &nothing, &mut by_control, &mut by_scene, &mut report)?;
    report.end();
    Ok(StepJacobian { state, control, parameters, report })
}

/// P, a forward solve per parameter with the factorisations at hand.
fn by_parameters(
    scene: &Scene,
    before: &State,
    record: &StepRecord,
    coordinates: &Coordinates,
    parameters: &[Parameter],
) -> Result<DMatrix<f64>, DiffError> {
    let still = StateVector::like(before);
    let no_control = vec![0.0; scene.controls().len()];
    let mut all = DMatrix::zeros(coordinates.size(), parameters.len());
    for (parameter, mut column) in parameters.iter().zip(all.column_iter_mut()) {
        let along = parameter.direction(scene, 0);
        let direction = Direction { state: &still, control: &no_control, scene: &along.scene };
        let change = step_jvp(scene, before, record, &direction)?;
        column.copy_from(&coordinates.flatten(&change));
    }
    Ok(all)
}

/// The derivatives of v⁺ as they come together.
struct Assembly<'a> {
    context: RowContext<'a>,
    coordinates: Coordinates,
    adjoint: LcpAdjoint,
    report: GradientReport,
    /// ∂v⁺/∂p, 3 n × 3 n.
    momentum: DMatrix<f64>,
    /// ∂v⁺/∂x, 3 n × 6 n.
    state: DMatrix<f64>,
    /// ∂v⁺/∂u, 3 n × channels.
    control: DMatrix<f64>,
}

impl<'a> Assembly<'a> {
    /// What comes through the rows; bodies without any have v⁺ = p/m.
    fn new(scene: &'a Scene, before: &'a State, record: &'a StepRecord) -> Result<Self, DiffError> {
        let coordinates = Coordinates::of(scene);
        let n = coordinates.bodies().len();
        let inverse = coordinates.bodies().iter().flat_map(|body| {
            let mass = scene.bodies()[*body].mass;
            [1.0 / mass.x, 1.0 / mass.y, 1.0 / mass.z]
        });
        let mut all = Self {
            context: record.velocity_context(scene, before),
            adjoint: LcpAdjoint::default(),
            report: GradientReport::default(),
            momentum: DMatrix::from_diagonal(&DVector::from_iterator(3 * n, inverse)),
            state: DMatrix::zeros(3 * n, 6 * n),
            control: DMatrix::zeros(3 * n, scene.controls().len()),
            coordinates,
        };
        for island in &record.islands {
            let response = all.response(&all.context.clone(), island)?;
            all.report.add_bounces(&all.context, island);
            all.place(island, &response);
        }
        Ok(all)
    }

    /// The response of an island; its switches go to the report.
    fn response(
        &mut self,
        context: &RowContext<'_>,
        island: &IslandRecord,
    ) -> Result<Response, DiffError> {
        let response = Response::new(context, island, &mut self.adjoint)?;
        let report = self.adjoint.report(&island.problem, &island.solution);
        self.report.add(island, &report);
        Ok(response)
    }

    /// Where the three numbers of each of an island's bodies stand.
    fn places(&self, island: &IslandRecord) -> Vec<usize> {
        let slots = island.bodies.iter().filter_map(|body| self.coordinates.slot(*body as usize));
        slots.flat_map(|slot| 3 * slot..3 * slot + 3).collect()
    }

    /// Copies the response of an island to its bodies' places.
    fn place(&mut self, island: &IslandRecord, response: &Response) {
        let places = self.places(island);
        let (k, half) = (places.len(), self.state.ncols() / 2);
        for (column, to) in places.iter().enumerate() {
            for (row, from) in places.iter().enumerate() {
                self.momentum[(*to, *from)] = response.momentum[(row, column)];
                self.state[(*to, *from)] = response.state[(row, column)];
                self.state[(*to, half + *from)] = response.state[(k + row, column)];
            }
            for channel in 0..self.control.ncols() {
                self.control[(*to, channel)] = response.control[(channel, column)];
            }
        }
    }

    /// What comes through p = M v + dt f(q, u).
    fn add_momentum(&mut self) {
        let RowContext { scene, control: inputs, .. } = self.context;
        let half = self.state.ncols() / 2;
        for (slot, body) in self.coordinates.bodies().iter().enumerate() {
            for axis in 0..3 {
                let (from, mass) = (3 * slot + axis, scene.bodies()[*body].mass[axis]);
                let by_v = self.momentum.column(from) * mass;
                self.state.column_mut(half + from).axpy(1.0, &by_v, 1.0);
            }
        }
        for (channel, input) in scene.controls().iter().enumerate() {
            match *input {
                Control::Wrench { body, component } => {
                    let Some(from) = self.coordinates.pose(body, component) else { continue };
                    let by_p = self.momentum.column(from);
                    self.control.column_mut(channel).axpy(self.context.dt, &by_p, 1.0);
                }
                Control::JointForce { joint } => {
                    let force = JointForce::new(&self.context, &self.coordinates, joint);
                    let by_u = force.by_effort(&self.momentum);
                    self.control.column_mut(channel).axpy(self.context.dt, &by_u, 1.0);
                    force.add_by_pose(
                        &self.momentum,
                        self.context.dt * inputs[channel],
                        &mut self.state,
                    );
                }
                Control::MotorSpeed { .. } => {}
            }
        }
    }

    /// Derivatives of (q̃, v⁺) by x and by u.
    fn motion(&self) -> [DMatrix<f64>; 2] {
        let (dt, half) = (self.context.dt, self.state.nrows());
        let moved = |by: &DMatrix<f64>| {
            let mut all = DMatrix::zeros(2 * half, by.ncols());
            all.rows_mut(0, half).copy_from(&(by * dt));
            all.rows_mut(half, half).copy_from(by);
            all
        };
        let mut state = moved(&self.state);
        (0..half).for_each(|place| state[(place, place)] += 1.0);
        [state, moved(&self.control)]
    }

    /// Derivatives of (q⁺, v⁺) from those of (q̃, v⁺), by the problems of one displacement.
    fn mend(
        &mut self,
        context: &RowContext<'_>,
        islands: &[IslandRecord],
        by: &mut [DMatrix<f64>; 2],
    ) -> Result<(), DiffError> {
        let (moved, half) = (by.clone(), self.state.nrows());
        for island in islands {
            let response = self.response(context, island)?;
            let places = self.places(island);
            let both = places.iter().copied().chain(places.iter().map(|place| half + place));
            let both: Vec<usize> = both.collect();
            for (by, moved) in by.iter_mut().zip(&moved) {
                let displaced = response.state.tr_mul(&moved.select_rows(&both));
                for (displaced, place) in displaced.row_iter().zip(&places) {
                    let mut to = by.row_mut(*place);
                    to += displaced * context.dt;
                }
            }
        }
        Ok(())
    }
}
