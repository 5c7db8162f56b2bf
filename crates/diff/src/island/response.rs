//! All derivatives of the velocities that an island's problem gives, from one factorisation.
//!
//! ```text
//!  Kᵀ a = e for each of the 3 k velocities        ∂v/∂p = a_vᵀ        ∂v/∂x = −aᵀ F_x, row by row
//! ```
//!
//! What a row is by its bodies' poses ([`Slope`]) does not depend on a, and is computed once.

use nalgebra::{DMatrix, DVectorViewMut, Vector3, Vector6};
use tangency_core::lcp::{NO_BODY, Row};
use tangency_core::row::{RowContext, RowSource};
use tangency_core::{IslandRecord, Scene};

use super::motor_channels;
use super::slope::Slope;
use crate::error::DiffError;
use crate::lcp::{LcpAdjoint, RowVector};

/// The velocities of an island's k bodies by all that its problem was assembled from. Matrices are
/// transposed: a column per velocity.
pub(crate) struct Response {
    /// By the momenta p, 3 k × 3 k.
    pub(crate) momentum: DMatrix<f64>,
    /// By poses and velocities through the rows, 6 k × 3 k.
    pub(crate) state: DMatrix<f64>,
    /// By the controls through motors, channels × 3 k.
    pub(crate) control: DMatrix<f64>,
}

impl Response {
    /// Of a problem at its solution. The last of its backward solves stays in `adjoint`.
    pub(crate) fn new(
        context: &RowContext<'_>,
        island: &IslandRecord,
        adjoint: &mut LcpAdjoint,
    ) -> Result<Self, DiffError> {
        let context = &RowContext { stage: island.stage, ..*context };
        let slopes: Vec<Slope> =
            island.sources.iter().map(|source| Slope::new(context, *source)).collect();
        let (k, channels) = (island.bodies.len(), context.scene.controls().len());
        let mut response = Self {
            momentum: DMatrix::zeros(3 * k, 3 * k),
            state: DMatrix::zeros(6 * k, 3 * k),
            control: DMatrix::zeros(channels, 3 * k),
        };
        let mut seed = vec![Vector3::zeros(); k];
        for column in 0..3 * k {
            seed[column / 3][column % 3] = 1.0;
            adjoint.solve(&island.problem, &island.solution, &seed, None)?;
            seed[column / 3][column % 3] = 0.0;
            response.collect(column, context, island, &slopes, adjoint);
        }
        Ok(response)
    }

    /// The derivatives of one velocity.
    fn collect(
        &mut self,
        column: usize,
        context: &RowContext<'_>,
        island: &IslandRecord,
        slopes: &[Slope],
        adjoint: &LcpAdjoint,
    ) {
        let IslandRecord { problem, solution, sources, .. } = island;
        let by_momentum = adjoint.momentum().iter().flat_map(Vector3::iter);
        self.momentum.column_mut(column).iter_mut().zip(by_momentum).for_each(|(to, a)| *to = *a);
        for (index, (row, slope)) in problem.rows.iter().zip(slopes).enumerate() {
            if adjoint.is_idle(solution, index) {
                continue;
            }
            let mut bar = adjoint.row(problem, solution, index);
            soften(context, island, index, &mut bar);
            let pulled = slope.pull(&bar.jacobian, bar.rhs);
            add(self.state.column_mut(column), row, &pulled);
            if let RowSource::Motor { joint } = sources[index] {
                self.add_motor(column, context.scene, joint, bar.rhs);
            }
        }
    }

    fn add_motor(&mut self, column: usize, scene: &Scene, joint: u32, rhs: f64) {
        motor_channels(scene, joint).for_each(|channel| self.control[(channel, column)] += rhs);
    }
}

/// Adds to J̄ what comes through the compliance that a row gives way by, c = κ Σ J²/M.
fn soften(context: &RowContext<'_>, island: &IslandRecord, index: usize, bar: &mut RowVector) {
    if !context.stage.gives_way() {
        return;
    }
    let (kappa, row) = (context.softness(island.sources[index]), &island.problem.rows[index]);
    for (body, (j, j_bar)) in row.bodies.iter().zip(row.jacobian.iter().zip(&mut bar.jacobian)) {
        if *body != NO_BODY {
            let mass = &island.problem.mass[*body as usize];
            *j_bar += 2.0 * kappa * bar.compliance * j.component_div(mass);
        }
    }
}

/// Adds gradients by (q_a, q_b) and (v_a, v_b) to those by the island's q and v.
fn add(mut to: DVectorViewMut<'_, f64>, row: &Row, [by_q, by_v]: &[Vector6<f64>; 2]) {
    let half = to.len() / 2;
    for (side, body) in row.bodies.iter().enumerate().filter(|(_, body)| **body != NO_BODY) {
        let place = 3 * *body as usize;
        for axis in 0..3 {
            to[place + axis] += by_q[3 * side + axis];
            to[half + place + axis] += by_v[3 * side + axis];
        }
    }
}
