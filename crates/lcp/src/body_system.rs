//! Newton's equations of an interior point with the rows eliminated.
//!
//! ```text
//!  (Ŵ + D) y = r     with  Ŵ = B̂ μM⁻¹ B̂ᵀ + ĉ  and  D = diag(d) + friction's coupling to its normal
//!
//!  G = (D + ĉ)⁻¹       K = M/μ + B̂ᵀ G B̂       K x = B̂ᵀ G r       y = G (r − B̂ x)
//! ```
//!
//! D is triangular per contact, and so is G: y_n = r_n / a_n, y_t = (r_t − e y_n) / a_t. However many
//! rows a pair of bodies shares, K has one 3 × 3 block for it.

use nalgebra::Vector3;

use crate::block_factor::BlockFactor;
use crate::equations::Equations;
use crate::{BoxLaw, Law, Lcp, Metric, Scratch};

/// δ: keeps equalities solvable when they depend on each other.
const PROXIMAL: f64 = 1e-8;
/// With a weight 1/a above this, a solution is refined.
const STIFF: f64 = 1e7;
/// Defects relative to the right-hand side that are small enough.
const EXACT: f64 = 1e-6;
/// With defects above this it is no solution.
const WRONG: f64 = 0.1;
/// Corrections of a solution.
const SWEEPS: usize = 3;

/// What is added to Ŵ, one entry each per unknown.
#[derive(Clone, Copy, Debug)]
pub struct Added<'a> {
    /// Dᵢᵢ, positive except for free unknowns.
    pub d: &'a [f64],
    /// D_tn, which couples friction to its normal; 0 for others.
    pub e: &'a [f64],
}

/// All rows of a problem as box unknowns, scaled as in [`BoxForm`](crate::BoxForm), in the order of the
/// problem. Ŵ is never formed: products and solutions go through the bodies.
#[derive(Debug)]
pub struct BodySystem<'a> {
    metric: &'a Metric,
    equations: &'a Equations,
    /// Laws.
    pub laws: Vec<BoxLaw>,
    /// q.
    pub q: Vec<f64>,
    /// Unit of the unknowns: unknown times `scale` is ŷ.
    pub scale: f64,
    factor: BlockFactor,
    /// Block of the two bodies of a row.
    blocks: Vec<u32>,
    /// 1/a.
    weights: Vec<f64>,
    stiff: bool,
    x: Vec<Vector3<f64>>,
    ordered: Vec<Vector3<f64>>,
    along: Vec<f64>,
    defect: Vec<f64>,
}

impl<'a> BodySystem<'a> {
    /// Of all rows of a problem; `None` if friction acts on other bodies than its normal row.
    #[must_use]
    pub fn new(problem: &Lcp, metric: &'a Metric, scratch: &mut Scratch) -> Option<Self> {
        let foreign = |row: &crate::Row| match row.law {
            Law::Friction { normal, .. } => problem.rows[normal as usize].bodies != row.bodies,
            _ => false,
        };
        if problem.rows.iter().any(foreign) {
            return None;
        }
        let equations = &metric.equations;
        let count = equations.rows.len();
        let mut x = scratch.vectors.filled(problem.mass.len() + 1, Vector3::zeros());
        let mut q = scratch.floats.take();
        let scale = list_remainders(problem, equations, &mut x, &mut q);
        let mut laws = scratch.laws.take();
        laws.extend((0..count).map(|row| BoxLaw::of_row(problem, metric, row, scale)));
        let coupled = laws.iter().any(|law| matches!(law, BoxLaw::Friction { .. }));
        let pattern = scratch.pattern(problem);
        let mut blocks = scratch.indices.take();
        pattern.list_blocks(problem, &mut blocks);
        Some(Self {
            metric,
            equations,
            laws,
            q,
            scale,
            factor: BlockFactor::zeros(&pattern, coupled, scratch),
            blocks,
            weights: scratch.floats.filled(count, 0.0),
            stiff: false,
            x,
            ordered: scratch.vectors.take(),
            along: scratch.floats.filled(count, 0.0),
            defect: scratch.floats.filled(count, 0.0),
        })
    }

    /// Gives its memory back.
    pub fn give(self, scratch: &mut Scratch) {
        for floats in [self.q, self.weights, self.along, self.defect] {
            scratch.floats.give(floats);
        }
        scratch.vectors.give(self.x);
        scratch.vectors.give(self.ordered);
        scratch.indices.give(self.blocks);
        scratch.laws.give(self.laws);
        self.factor.give(scratch);
    }

    /// Impulses per row.
    pub fn impulses(&self, y: &[f64], impulses: &mut Vec<f64>) {
        impulses.clear();
        let unit = |(row, y): (usize, &f64)| self.metric.true_impulse(row, self.scale * y);
        impulses.extend(y.iter().enumerate().map(unit));
    }

    /// out = Ŵ y.
    pub fn times(&mut self, y: &[f64], out: &mut [f64]) {
        let rows = &self.equations.rows;
        self.x.fill(Vector3::zeros());
        for (row, y) in rows.iter().zip(y) {
            row.add_transposed(*y, &mut self.x);
        }
        for (x, inverse) in self.x.iter_mut().zip(&self.equations.inverse_mass) {
            x.component_mul_assign(inverse);
        }
        for ((row, y), out) in rows.iter().zip(y).zip(out) {
            *out = row.velocity(&self.x) + row.compliance * y;
        }
    }

    /// Factors K for an added matrix D.
    pub fn factor(&mut self, Added { d, e }: Added, scratch: &mut Scratch) {
        self.factor.clear();
        self.factor.add_masses(&self.equations.mass);
        self.stiff = false;
        for (slot, row) in self.equations.rows.iter().enumerate() {
            let mut a = d[slot] + row.compliance;
            let mut right = row.jacobian;
            match self.laws[slot] {
                BoxLaw::Free => a += PROXIMAL,
                BoxLaw::Friction { normal, .. } => {
                    let part = e[slot] * self.weights[normal];
                    let other = &self.equations.rows[normal].jacobian;
                    right[0] -= other[0] * part;
                    right[1] -= other[1] * part;
                }
                BoxLaw::Positive | BoxLaw::Bounded { .. } => {}
            }
            let weight = a.recip();
            self.weights[slot] = weight;
            self.stiff |= weight > STIFF;
            let left = [row.jacobian[0] * weight, row.jacobian[1] * weight];
            self.factor.add_product(row.bodies, self.blocks[slot], &left, &right);
        }
        self.factor.factor(scratch);
        // Where sliding spoils a pivot, refinement tells what the solution is worth.
        self.stiff |= !self.factor.count_free(&self.equations.mass);
    }

    /// y with (Ŵ + D) y = `rhs` for the same D; refined against the matrix without δ where that may matter.
    /// False if it is not a solution.
    pub fn solve(&mut self, Added { d, e }: Added, rhs: &[f64], y: &mut [f64]) -> bool {
        y.copy_from_slice(rhs);
        self.condensed(e, y);
        if !self.stiff {
            return true;
        }
        let size = rhs.iter().fold(0.0_f64, |size, r| size.max(r.abs()));
        let mut defect = std::mem::take(&mut self.defect);
        let mut least = f64::INFINITY;
        for _ in 0..SWEEPS {
            let worst = self.remainder(Added { d, e }, rhs, y, &mut defect);
            if worst <= EXACT * size || worst > 0.5 * least {
                least = least.min(worst);
                break;
            }
            least = worst;
            self.condensed(e, &mut defect);
            y.iter_mut().zip(&defect).for_each(|(y, dy)| *y += dy);
        }
        self.defect = defect;
        least <= WRONG * size
    }

    /// r = rhs − (Ŵ + D) y; its greatest entry.
    fn remainder(&mut self, Added { d, e }: Added, rhs: &[f64], y: &[f64], r: &mut [f64]) -> f64 {
        self.times(y, r);
        let mut worst = 0.0_f64;
        for slot in 0..y.len() {
            let mut own = d[slot] * y[slot];
            if let BoxLaw::Friction { normal, .. } = self.laws[slot] {
                own += e[slot] * y[normal];
            }
            r[slot] = rhs[slot] - own - r[slot];
            worst = worst.max(r[slot].abs());
        }
        worst
    }

    /// r ← G (r − B̂ K⁻¹ B̂ᵀ G r).
    fn condensed(&mut self, e: &[f64], r: &mut [f64]) {
        let rows = &self.equations.rows;
        let bodies = self.equations.mass.len();
        self.x.fill(Vector3::zeros());
        for (slot, row) in rows.iter().enumerate() {
            let y = self.weigh(slot, r[slot], e, &self.along);
            self.along[slot] = y;
            row.add_transposed(y, &mut self.x);
        }
        self.factor.solve(false, &mut self.x[..bodies], &mut self.ordered);
        for (slot, row) in rows.iter().enumerate() {
            let left = r[slot] - row.velocity(&self.x);
            r[slot] = self.weigh(slot, left, e, r);
        }
    }

    /// One entry of G r, given those before it.
    fn weigh(&self, slot: usize, r: f64, e: &[f64], before: &[f64]) -> f64 {
        let taken = match self.laws[slot] {
            BoxLaw::Friction { normal, .. } => e[slot] * before[normal],
            _ => 0.0,
        };
        (r - taken) * self.weights[slot]
    }
}

/// q = (B̂ M⁻¹ p − b̂) / s with s its largest entry; returns s. Leaves the free velocities in `v`.
fn list_remainders(
    problem: &Lcp,
    equations: &Equations,
    v: &mut [Vector3<f64>],
    q: &mut Vec<f64>,
) -> f64 {
    for ((v, p), m) in v.iter_mut().zip(&problem.momentum).zip(&problem.mass) {
        *v = p.component_div(m);
    }
    q.extend(equations.rows.iter().map(|row| row.velocity(v) - row.rhs));
    let largest = q.iter().fold(0.0_f64, |largest, q| largest.max(q.abs()));
    let scale = if largest > 0.0 { largest } else { 1.0 };
    for q in q {
        *q /= scale;
    }
    scale
}
