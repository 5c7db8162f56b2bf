//! The geometry of a row.

use nalgebra::Vector3;

/// Value and gradient of a row, before its right-hand side.
pub(crate) struct Shape {
    /// Position error or gap, m or rad; 0 for friction and motors.
    pub(crate) value: f64,
    /// Jacobian blocks, 1 × 3 each.
    pub(crate) jacobian: [Vector3<f64>; 2],
}
