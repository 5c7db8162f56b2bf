//! The quadratic problem along a motion, solved backwards in time.
//!
//! ```text
//!  Q_x  = l_x  + Aᵀ V_x          Q_xx = l_xx + Aᵀ V_xx A
//!  Q_u  = l_u  + Bᵀ V_x          Q_ux = l_ux + Bᵀ V_xx A
//!                                Q_uu = l_uu + Bᵀ V_xx B
//!
//!  k = argmin ½ kᵀ (Q_uu + λ) k + Q_uᵀ k,  lower ≤ u + k ≤ upper        K = −(Q_uu + λ)_ff⁻¹ Q_ux,f
//!
//!  ΔV  = kᵀ Q_u + ½ kᵀ Q_uu k
//!  V_x  ← Q_x  + Kᵀ Q_uu k + Kᵀ Q_u  + Q_uxᵀ k
//!  V_xx ← Q_xx + Kᵀ Q_uu K + Kᵀ Q_ux + Q_uxᵀ K
//! ```

#![expect(non_snake_case, reason = "matrices carry their names from the paper")]

use nalgebra::{DMatrix, DVector};

use crate::box_qp::BoxQp;
use crate::cost::{Expansion, LastExpansion};
use crate::{ControlLimits, Linearisation};

/// A motion's expansion: first derivatives of its steps, first and second ones of its cost.
pub(crate) struct Expanded {
    pub(crate) dynamics: Vec<Linearisation>,
    pub(crate) running: Vec<Expansion>,
    pub(crate) last: LastExpansion,
}

/// The change of the controls, u ← u + α k + K (x − x̄), and what it promises.
pub(crate) struct Policy {
    /// k, T of m.
    pub(crate) changes: Vec<DVector<f64>>,
    /// K, T of m × n.
    pub(crate) gains: Vec<DMatrix<f64>>,
    /// Σ kᵀ Q_u and Σ ½ kᵀ Q_uu k.
    slope: f64,
    bend: f64,
}

impl Policy {
    /// The decrease that α k promises.
    pub(crate) fn promise(&self, alpha: f64) -> f64 {
        -alpha * (self.slope + alpha * self.bend)
    }
}

impl Expanded {
    /// The best change of `controls`; `None` if λ is too small for a minimum.
    pub(crate) fn policy(
        &self,
        controls: &[DVector<f64>],
        limits: &ControlLimits,
        lambda: f64,
    ) -> Option<Policy> {
        let steps = controls.len();
        let (changes, gains) = (Vec::with_capacity(steps), Vec::with_capacity(steps));
        let mut policy = Policy { changes, gains, slope: 0.0, bend: 0.0 };
        let (mut V_x, mut V_xx) = (self.last.x.clone(), self.last.xx.clone());
        for k in (0..steps).rev() {
            let q = Q::new(&self.running[k], &self.dynamics[k], &V_x, &V_xx);
            let room = limits.around(&controls[k]);
            let (change, gain) = q.best(&room, lambda, policy.changes.last())?;
            let bend = &q.uu * &change;
            policy.slope += change.dot(&q.u);
            policy.bend += 0.5 * change.dot(&bend);
            (V_x, V_xx) = q.value(&bend, &change, &gain);
            policy.changes.push(change);
            policy.gains.push(gain);
        }
        policy.changes.reverse();
        policy.gains.reverse();
        policy.promise(1.0).is_finite().then_some(policy)
    }
}

/// Derivatives of the cost to go, by the state and the control of one step.
struct Q {
    x: DVector<f64>,
    u: DVector<f64>,
    xx: DMatrix<f64>,
    ux: DMatrix<f64>,
    uu: DMatrix<f64>,
}

impl Q {
    fn new(l: &Expansion, f: &Linearisation, V_x: &DVector<f64>, V_xx: &DMatrix<f64>) -> Self {
        let (A, B) = (&f.state, &f.control);
        let (V_A, V_B) = (V_xx * A, V_xx * B);
        Self {
            x: &l.x + A.tr_mul(V_x),
            u: &l.u + B.tr_mul(V_x),
            xx: &l.xx + A.tr_mul(&V_A),
            ux: &l.ux + B.tr_mul(&V_A),
            uu: &l.uu + B.tr_mul(&V_B),
        }
    }

    /// k and K; sought from the change of the step after.
    fn best(
        &self,
        room: &ControlLimits,
        lambda: f64,
        start: Option<&DVector<f64>>,
    ) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let mut hessian = symmetric(&self.uu);
        (0..hessian.nrows()).for_each(|i| hessian[(i, i)] += lambda);
        let problem = BoxQp { hessian: &hessian, gradient: &self.u, limits: room };
        let zero = DVector::zeros(self.u.len());
        let found = problem.solve(start.unwrap_or(&zero))?;
        let gain = found.sensitivity(&self.ux);
        Some((found.minimum, gain))
    }

    /// V_x and V_xx, with `bend` = Q_uu k.
    fn value(
        &self,
        bend: &DVector<f64>,
        k: &DVector<f64>,
        K: &DMatrix<f64>,
    ) -> (DVector<f64>, DMatrix<f64>) {
        let V_x = &self.x + K.tr_mul(&(bend + &self.u)) + self.ux.tr_mul(k);
        let mixed = K.tr_mul(&self.ux);
        let V_xx = &self.xx + K.tr_mul(&(&self.uu * K)) + &mixed + mixed.transpose();
        (V_x, symmetric(&V_xx))
    }
}

/// What rounding took from symmetry comes back.
fn symmetric(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    (matrix + matrix.transpose()) * 0.5
}
