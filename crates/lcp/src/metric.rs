//! The mass-weighted units of one problem.
//!
//! ```text
//!  Wᵢᵢ = Jᵢ M⁻¹ Jᵢᵀ + cᵢ       ŷᵢ = λᵢ √Wᵢᵢ       ûᵢ = uᵢ / √Wᵢᵢ       ĥᵢ = hᵢ √Wᵢᵢ      √J each
//!  s* = max( max_k |p_k|/√M_kk , max_i |bᵢ|/√Wᵢᵢ )
//! ```
//!
//! ŷ, û and s* are square roots of energies: quotients of them do not change with the units of
//! length, mass or time, and no mass ratio weighs them.
//!
//! Masses are counted in the largest power of two that the greatest of them reaches, μ: a mass M is
//! M/μ, an impulse λ/μ, a weight μ Wᵢᵢ. Nothing else would make the square roots the same to the last
//! bit when the unit of mass changes by an odd power of two.

#![expect(non_snake_case, reason = "matrices carry their names from the notes")]

use std::sync::Arc;

use nalgebra::Vector3;

use crate::equations::Equations;
use crate::pattern::{Pattern, Patterns};
use crate::{Law, Lcp, LcpError, NO_BODY, Row, order};

/// Below this number of rows, or up to this half-width of their band, bodies are not eliminated.
const FEW_ROWS: usize = 24;
const NARROW: usize = 6;

/// Problems of so many active rows and fewer are eliminated by rows where more contacts slide than a few.
const MOST_ROWS: usize = 400;
const FEW_SLIDES: usize = 4;
/// So many active rows to a sliding contact are few slides, too.
const SHARE_OF_SLIDES: usize = 30;

/// The mass-weighted units of one problem: computed once, used by every residual, mode reading and
/// linear system.
#[derive(Clone, Debug, Default)]
pub struct Metric {
    /// √(μ Wᵢᵢ) per row.
    root: Vec<f64>,
    /// 1/√(μ M) per body.
    inverse_root_mass: Vec<Vector3<f64>>,
    /// All rows, weighted, and the masses.
    pub(crate) equations: Equations,
    /// Half-width of the band of all rows as they come.
    pub(crate) width: usize,
    /// How bodies are eliminated, where that may pay.
    pattern: Option<Arc<Pattern>>,
    /// Working memory: the first row of each body.
    first_rows: Vec<u32>,
    /// μ, the unit of mass.
    unit: f64,
    /// 1/μ, exact.
    per_unit: f64,
    /// A sum that is finite only if all numbers of the problem are.
    sum: f64,
    /// s*, the problem's own scale.
    pub scale: f64,
}

/// A row divided by √(μ Wᵢᵢ): B̂ v + ĉ ŷ = b̂.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WeightedRow {
    /// Bodies; the number of bodies stands for none.
    pub(crate) bodies: [u32; 2],
    /// J/√(μ Wᵢᵢ).
    pub(crate) jacobian: [Vector3<f64>; 2],
    /// b/√(μ Wᵢᵢ).
    pub(crate) rhs: f64,
    /// c/Wᵢᵢ.
    pub(crate) compliance: f64,
    /// 1/√(μ Wᵢᵢ).
    pub(crate) inverse: f64,
}

impl WeightedRow {
    /// B̂ v.
    pub(crate) fn velocity(&self, v: &[Vector3<f64>]) -> f64 {
        let [a, b] = self.bodies.map(|body| body as usize);
        self.jacobian[0].dot(&v[a]) + self.jacobian[1].dot(&v[b])
    }

    /// z ← z + B̂ᵀ y.
    pub(crate) fn add_transposed(&self, y: f64, z: &mut [Vector3<f64>]) {
        let [a, b] = self.bodies.map(|body| body as usize);
        z[a] += self.jacobian[0] * y;
        z[b] += self.jacobian[1] * y;
    }
}

impl Metric {
    /// The metric of `problem`.
    #[must_use]
    pub fn new(problem: &Lcp) -> Self {
        let mut metric = Self::default();
        metric.renew(problem, &mut Patterns::default());
        metric
    }

    /// The metric of a problem that is valid.
    ///
    /// # Errors
    /// As [`Lcp::validate`].
    pub fn checked(problem: &Lcp) -> Result<Self, LcpError> {
        problem.validate()?;
        Ok(Self::new(problem))
    }

    /// Becomes the metric of another problem, in the same memory.
    pub(crate) fn renew(&mut self, problem: &Lcp, patterns: &mut Patterns) {
        self.unit = power_of_two(problem.mass.iter().fold(0.0, |most: f64, m| most.max(m.x)));
        self.per_unit = self.unit.recip();
        (self.scale, self.sum) = (0.0, 0.0);
        self.weigh_bodies(problem);
        self.weigh_rows(problem);
        self.width = order::half_width_of_all(problem, &mut self.first_rows);
        let may_pay = problem.rows.len() >= FEW_ROWS && self.width > NARROW;
        self.pattern = may_pay.then(|| patterns.of(problem));
    }

    fn weigh_bodies(&mut self, problem: &Lcp) {
        self.equations.weigh_bodies(problem, self.unit);
        self.inverse_root_mass.clear();
        let per_unit = self.per_unit;
        for (inverse, momentum) in self.equations.inverse_mass.iter().zip(&problem.momentum) {
            let root = inverse.map(f64::sqrt) * per_unit;
            self.inverse_root_mass.push(root);
            let weighted = momentum.component_mul(&root).abs();
            self.scale = weighted.iter().copied().fold(self.scale, greater);
            self.sum += weighted.x + weighted.y + weighted.z;
        }
    }

    fn weigh_rows(&mut self, problem: &Lcp) {
        let none = u32::try_from(problem.mass.len()).expect("fewer bodies than u32 counts");
        let Self { unit, scale, sum, root, equations, .. } = self;
        let Equations { rows, inverse_mass, .. } = equations;
        root.clear();
        root.resize(problem.rows.len(), 0.0);
        let weigh = |(row, root): (&Row, &mut f64)| {
            let bodies = row.bodies.map(|body| if body == NO_BODY { none } else { body });
            let weight = |side: usize| {
                let J = &row.jacobian[side];
                J.component_mul(&inverse_mass[bodies[side] as usize]).dot(J)
            };
            // μ Wᵢᵢ; 1 for a row without influence.
            let weight = weight(0) + weight(1) + row.compliance * *unit;
            *root = if weight > 0.0 { weight.sqrt() } else { unit.sqrt() };
            let inverse = root.recip();
            let rhs = row.rhs * inverse;
            *scale = greater(*scale, rhs.abs());
            *sum += weight + rhs;
            let jacobian = [row.jacobian[0] * inverse, row.jacobian[1] * inverse];
            let compliance = row.compliance * (inverse * inverse * *unit);
            WeightedRow { bodies, jacobian, rhs, compliance, inverse }
        };
        rows.clear();
        rows.extend(problem.rows.iter().zip(root).map(weigh));
    }

    /// Whether all numbers of the problem are finite, and their squares.
    pub(crate) fn is_finite(&self) -> bool {
        self.sum.is_finite()
    }

    /// Whether eliminating bodies was thought of.
    pub(crate) fn has_pattern(&self) -> bool {
        self.pattern.is_some()
    }

    /// How to eliminate bodies if that is cheaper than a band of `rows` rows of this half-width.
    ///
    /// Counted are multiplications: of a factorisation and of three sweeps. Where friction slides, rows
    /// need both triangles and room for exchanges, which bodies do without; that costs digits where
    /// many contacts slide, and is left to problems that are too large for rows.
    pub(crate) fn pattern(
        &self,
        rows: usize,
        width: usize,
        slides: usize,
    ) -> Option<&Arc<Pattern>> {
        let few = slides <= FEW_SLIDES || SHARE_OF_SLIDES * slides <= rows;
        if !few && rows <= MOST_ROWS {
            return None;
        }
        let pattern = self.pattern.as_ref()?;
        let by_rows = rows * (width * width / 2 + 12 * width + 36) * if slides > 0 { 4 } else { 1 };
        let sweep = 18 * (pattern.bodies() + 2 * pattern.blocks()) + 24 * rows;
        let by_bodies = 27 * (pattern.bodies() + pattern.products() + rows) + 3 * sweep;
        (by_bodies < by_rows).then_some(pattern)
    }

    /// √(μ Wᵢᵢ) of a row.
    #[must_use]
    pub fn root(&self, row: usize) -> f64 {
        self.root[row]
    }

    /// μ, the unit of mass, kg.
    #[must_use]
    pub fn unit(&self) -> f64 {
        self.unit
    }

    /// ŷ of a row's impulse.
    #[must_use]
    pub fn impulse(&self, row: usize, impulse: f64) -> f64 {
        impulse * self.root[row] * self.per_unit
    }

    /// The impulse of a row's ŷ, N·s or N·m·s.
    #[must_use]
    pub fn true_impulse(&self, row: usize, impulse: f64) -> f64 {
        impulse * (self.unit * self.equations.rows[row].inverse)
    }

    /// û of a row's remainder.
    #[must_use]
    pub fn remainder(&self, row: usize, remainder: f64) -> f64 {
        remainder * self.equations.rows[row].inverse
    }

    /// p/√M of one coordinate.
    #[must_use]
    pub fn momentum(&self, momentum: f64, mass: f64) -> f64 {
        momentum / (self.unit * mass).sqrt()
    }

    /// p/√M of one body.
    pub(crate) fn weighted_momentum(&self, body: usize, momentum: &Vector3<f64>) -> Vector3<f64> {
        momentum.component_mul(&self.inverse_root_mass[body])
    }

    /// The velocity of one coordinate from √M v, m/s or rad/s.
    #[must_use]
    pub fn true_velocity(&self, velocity: f64, mass: f64) -> f64 {
        velocity * self.unit / (self.unit * mass).sqrt()
    }

    /// A defect divided by the scale; NaN counts as infinite, 0/0 as 0.
    pub(crate) fn relative(&self, defect: f64) -> f64 {
        quotient(defect, self.scale)
    }

    /// The bound ĥ of a bounded or friction row, from the impulses as they are.
    pub(crate) fn bound(&self, law: Law, row: usize, impulses: &[f64]) -> f64 {
        match law {
            Law::Bounded { max } => self.impulse(row, max),
            Law::Friction { normal, mu } => {
                self.impulse(row, mu * impulses[normal as usize].max(0.0))
            }
            Law::Equality | Law::Unilateral => f64::INFINITY,
        }
    }
}

/// The greater of two numbers that are none of them NaN, or the first.
#[inline]
pub(crate) fn greater(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// The largest power of two up to a positive number; 1 where there is none.
fn power_of_two(x: f64) -> f64 {
    let exponent = f64::from_bits(x.to_bits() & f64::INFINITY.to_bits());
    if exponent.is_normal() { exponent } else { 1.0 }
}

/// Defect over scale; NaN counts as infinite, 0/0 and what is too small for normal numbers as 0.
pub(crate) fn quotient(defect: f64, scale: f64) -> f64 {
    if defect < f64::MIN_POSITIVE {
        0.0
    } else if defect.is_finite() {
        defect / scale
    } else {
        f64::INFINITY
    }
}
