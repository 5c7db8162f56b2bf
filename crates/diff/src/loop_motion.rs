//! How a state moves with a joint of a closed linkage that has one way to move.
//!
//! With A the rows of all that joints hold (φ = 0), j the gradient of the joint's free coordinate, each over
//! the bodies that are linked with it, and H the Hessian of a row's measure:
//!
//! ```text
//!  A n = 0,  j n = 1                                   dq = n by the coordinate,  dv = n by its rate
//!  d(J v) = J dv + vᵀ H n = 0 of every row, j too      dv by the coordinate
//! ```
//!
//! Rows may depend on each other. They are solved by least squares in mass-weighted units, `n̂ = √M n` and rows
//! divided by `√(J M⁻¹ Jᵀ)`, in which singular values have no unit: n is unique if as many of them are
//! above rounding as there are unknowns, and exists if it leaves nothing over.

use nalgebra::{DMatrix, DVector, Vector6};
use tangency_core::measure::MeasureJet;
use tangency_core::{Joint, JointRow, Scene, State};
use tangency_lcp::pseudo_inverse;

use crate::joint_motion::{JointMotion, JointMotionError, holds};
use crate::vector::StateVector;

/// Singular values below this are rounding.
const ZERO: f64 = 1e-8;
/// What a motion may leave over of its rows.
const CLOSED: f64 = 1e-8;

/// The rows of a linkage; the last is that of the free coordinate.
struct Linkage<'a> {
    scene: &'a Scene,
    state: &'a State,
    /// Bodies that may move, each once.
    bodies: Vec<usize>,
    rows: Vec<(&'a Joint, MeasureJet)>,
    /// 1/√(J M⁻¹ Jᵀ) per row.
    weights: Vec<f64>,
}

/// The motion of all bodies that are linked with a joint.
pub(crate) fn loop_motion(
    scene: &Scene,
    state: &State,
    joint: usize,
    free: JointRow,
) -> Result<JointMotion, JointMotionError> {
    let linkage = Linkage::new(scene, state, joint, free);
    let matrix = linkage.matrix();
    let unknowns = matrix.ncols();
    let inverse = pseudo_inverse(&matrix, ZERO).ok_or(JointMotionError::Blocked { joint })?;
    // The trace of A⁺ A is the rank.
    let missing = unknowns as f64 - inverse.transpose().dot(&matrix);
    let ways = (0..=unknowns).take_while(|ways| *ways as f64 + 0.5 < missing).count();
    if ways > 0 {
        return Err(JointMotionError::NotUnique { joint, ways });
    }
    let last = matrix.nrows() - 1;
    let mut one = DVector::zeros(last + 1);
    one[last] = linkage.weights[last];
    let way = &inverse * &one;
    if (&matrix * &way - &one).amax() > CLOSED * one[last] {
        return Err(JointMotionError::Blocked { joint });
    }
    let rate = linkage.spread(&way);
    let mut coordinate = StateVector { q: rate.q.clone(), ..StateVector::like(state) };
    coordinate.v = linkage.spread(&(&inverse * linkage.bends(&rate))).q;
    let rate = StateVector { v: rate.q, ..StateVector::like(state) };
    Ok(JointMotion { coordinate, rate })
}

impl<'a> Linkage<'a> {
    fn new(scene: &'a Scene, state: &'a State, joint: usize, free: JointRow) -> Self {
        let bodies = linked(scene, joint);
        let touches = |it: &&Joint| it.bodies.iter().flatten().any(|body| bodies.contains(body));
        let jet = |it: &Joint, row: &JointRow| {
            let anchors = [&it.anchors[0], &it.anchors[1]];
            let [a, b] = it.bodies.map(|body| body.map_or_else(Default::default, |i| state.q[i]));
            row.measure.jet([&a, &b], anchors)
        };
        let held = scene.joints().iter().filter(holds).filter(touches);
        let held = held.flat_map(|it| it.held.iter().map(move |row| (it, jet(it, row))));
        let it = &scene.joints()[joint];
        let rows: Vec<_> = held.chain([(it, jet(it, &free))]).collect();
        let mut linkage = Self { scene, state, bodies, rows, weights: Vec::new() };
        linkage.weights = vec![1.0; linkage.rows.len()];
        let lengths = linkage.matrix().row_iter().map(|row| row.norm()).collect::<Vec<f64>>();
        linkage.weights = lengths.iter().map(|l| if *l > 0.0 { l.recip() } else { 1.0 }).collect();
        linkage
    }

    /// J M^(−½) of the bodies that may move, divided by the lengths of the rows.
    fn matrix(&self) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(self.rows.len(), 3 * self.bodies.len());
        for (i, (joint, jet)) in self.rows.iter().enumerate() {
            for (side, body) in joint.bodies.iter().enumerate() {
                let place = body.and_then(|body| self.bodies.iter().position(|b| *b == body));
                let Some(place) = place else { continue };
                let mass = self.scene.bodies()[self.bodies[place]].mass;
                for k in 0..3 {
                    let entry = jet.jacobian[3 * side + k] * self.weights[i];
                    matrix[(i, 3 * place + k)] += entry / mass[k].sqrt();
                }
            }
        }
        matrix
    }

    /// −vᵀ H n of every row, in its units.
    fn bends(&self, along: &StateVector) -> DVector<f64> {
        let of = |list: &[nalgebra::Vector3<f64>], joint: &Joint| {
            let [a, b] = joint.bodies.map(|body| body.map_or_else(Default::default, |i| list[i]));
            Vector6::new(a.x, a.y, a.z, b.x, b.y, b.z)
        };
        let bend = |((joint, jet), weight): (&(&Joint, MeasureJet), &f64)| {
            -weight * of(&self.state.v, joint).dot(&(jet.hessian * of(&along.q, joint)))
        };
        DVector::from_iterator(self.rows.len(), self.rows.iter().zip(&self.weights).map(bend))
    }

    /// From mass-weighted unknowns to the bodies, as poses.
    fn spread(&self, unknowns: &DVector<f64>) -> StateVector {
        let mut along = StateVector::like(self.state);
        for (place, body) in self.bodies.iter().enumerate() {
            let mass = self.scene.bodies()[*body].mass.map(f64::sqrt);
            along.q[*body] = unknowns.fixed_rows::<3>(3 * place).component_div(&mass);
        }
        along
    }
}

/// The bodies that rigid joints link with a joint; what does not move by itself links nothing.
fn linked(scene: &Scene, joint: usize) -> Vec<usize> {
    let moves = |body: &usize| scene.is_dynamic(*body);
    let own = scene.joints()[joint].bodies.into_iter().flatten();
    let mut found: Vec<usize> = own.filter(moves).collect();
    let mut next = 0;
    while next < found.len() {
        let body = Some(found[next]);
        next += 1;
        let joints = scene.joints().iter().filter(holds).filter(|it| it.bodies.contains(&body));
        for neighbour in joints.flat_map(|it| it.bodies).flatten().filter(moves) {
            if !found.contains(&neighbour) {
                found.push(neighbour);
            }
        }
    }
    found
}
