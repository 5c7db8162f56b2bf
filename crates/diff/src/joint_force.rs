//! A control that pushes along a joint's free coordinate φ: p += dt u J_freeᵀ.
//!
//! ```text
//!  ∂v⁺/∂u = dt ∂v⁺/∂p Jᵀ        ∂v⁺/∂q += dt u ∂v⁺/∂p H,   H = ∂²φ/∂q²
//! ```

use nalgebra::{DMatrix, DVector, Matrix6, Vector6};
use tangency_core::row::RowContext;

use crate::coordinates::Coordinates;

/// First and second derivatives of a joint's free coordinate, and where its bodies stand.
pub(crate) struct JointForce {
    jacobian: Vector6<f64>,
    hessian: Matrix6<f64>,
    /// Of the six numbers of both poses; `None` for the world and for bodies that are not dynamic.
    places: [Option<usize>; 6],
}

impl JointForce {
    /// At the poses of a step.
    pub(crate) fn new(context: &RowContext<'_>, coordinates: &Coordinates, joint: usize) -> Self {
        let it = &context.scene.joints()[joint];
        let free = it.free.expect("checked when the scene was built");
        let poses = context.scene.joint_poses(joint, context.q);
        let jet = free.measure.jet([&poses[0], &poses[1]], [&it.anchors[0], &it.anchors[1]]);
        let place = |k: usize| it.bodies[k / 3].and_then(|body| coordinates.pose(body, k % 3));
        let places = [0, 1, 2, 3, 4, 5].map(place);
        Self { jacobian: jet.jacobian, hessian: jet.hessian, places }
    }

    /// ∂v⁺/∂p Jᵀ.
    pub(crate) fn by_effort(&self, momentum: &DMatrix<f64>) -> DVector<f64> {
        let mut by = DVector::zeros(momentum.nrows());
        for (place, j) in self.places.iter().zip(&self.jacobian) {
            if let Some(place) = place {
                by.axpy(*j, &momentum.column(*place), 1.0);
            }
        }
        by
    }

    /// Adds `impulse` ∂v⁺/∂p H to the derivatives by poses.
    pub(crate) fn add_by_pose(&self, momentum: &DMatrix<f64>, impulse: f64, by: &mut DMatrix<f64>) {
        for (k, to) in self.places.iter().enumerate() {
            for (l, from) in self.places.iter().enumerate() {
                if let (Some(to), Some(from)) = (to, from) {
                    let rate = impulse * self.hessian[(l, k)];
                    by.column_mut(*to).axpy(rate, &momentum.column(*from), 1.0);
                }
            }
        }
    }
}
