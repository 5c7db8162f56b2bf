//! States as plain vectors: the order in which Jacobians of steps have their rows and columns.

use nalgebra::{DVector, DVectorView, Vector3};
use tangency_core::{Scene, State};

use crate::vector::StateVector;

/// The coordinates x = (q, v) of a scene's dynamic bodies, 6 n numbers:
///
/// ```text
///  x = (x₁ y₁ θ₁ … xₙ yₙ θₙ | ẋ₁ ẏ₁ ω₁ … ẋₙ ẏₙ ωₙ)        bodies in the scene's order
/// ```
///
/// Static and kinematic bodies and time have none: they go their way whatever the others do.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Coordinates {
    bodies: Vec<usize>,
    /// Where a body of the scene stands among the dynamic ones.
    slots: Vec<Option<usize>>,
}

impl Coordinates {
    /// Those of a scene.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let all = scene.bodies().len();
        let bodies: Vec<usize> = (0..all).filter(|body| scene.is_dynamic(*body)).collect();
        let mut slots = vec![None; all];
        bodies.iter().enumerate().for_each(|(slot, body)| slots[*body] = Some(slot));
        Self { bodies, slots }
    }

    /// The dynamic bodies, by their indices in the scene.
    #[must_use]
    pub fn bodies(&self) -> &[usize] {
        &self.bodies
    }

    /// 6 n.
    #[must_use]
    pub fn size(&self) -> usize {
        6 * self.bodies.len()
    }

    /// Where the pose of a body has its component (axis 0, 1, 2: x, y, angle); `None` if the body is
    /// not dynamic or there is no such axis.
    #[must_use]
    pub fn pose(&self, body: usize, axis: usize) -> Option<usize> {
        let slot = self.slot(body)?;
        (axis < 3).then_some(3 * slot + axis)
    }

    /// The same for the body's velocity.
    #[must_use]
    pub fn velocity(&self, body: usize, axis: usize) -> Option<usize> {
        Some(3 * self.bodies.len() + self.pose(body, axis)?)
    }

    /// Where a body of the scene stands among the dynamic ones.
    pub(crate) fn slot(&self, body: usize) -> Option<usize> {
        self.slots.get(body).copied().flatten()
    }

    /// The coordinates of a state, 6 n.
    #[must_use]
    pub fn of_state(&self, state: &State) -> DVector<f64> {
        self.gather(&state.q, &state.v)
    }

    /// A gradient by, or a direction of, a state as 6 n numbers; what belongs to other bodies and to
    /// time is left out.
    #[must_use]
    pub fn flatten(&self, vector: &StateVector) -> DVector<f64> {
        self.gather(&vector.q, &vector.v)
    }

    /// The reverse of [`flatten`](Self::flatten), with zeros for what was left out.
    ///
    /// # Panics
    /// If `flat` has not 6 n entries.
    #[must_use]
    pub fn spread(&self, flat: DVectorView<'_, f64>) -> StateVector {
        assert_eq!(flat.len(), self.size(), "six coordinates per dynamic body");
        let mut vector = StateVector::zeros(self.slots.len());
        let half = 3 * self.bodies.len();
        for (slot, body) in self.bodies.iter().enumerate() {
            vector.q[*body] = flat.fixed_rows::<3>(3 * slot).into();
            vector.v[*body] = flat.fixed_rows::<3>(half + 3 * slot).into();
        }
        vector
    }

    fn gather(&self, q: &[Vector3<f64>], v: &[Vector3<f64>]) -> DVector<f64> {
        let of = |list: &'_ [Vector3<f64>]| -> Vec<f64> {
            self.bodies.iter().flat_map(|body| list[*body].iter().copied()).collect()
        };
        DVector::from_vec([of(q), of(v)].concat())
    }
}
