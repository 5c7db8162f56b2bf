//! The convex program of a problem, in mass-weighted units.
//!
//! ```text
//!  x = M^½ v / s*       Ĵ = J M^-½ / √W_rr       b̂ = b / (√W_rr s*)       ŷ = λ √W_rr / s*
//!
//!  min ½|x|² − fᵀx + Σ ½ w²/ĉ + Σ h τ
//!  equality      Ĵx + w − b̂ = 0                                     ŷ = −z
//!  unilateral    Ĵx + w − b̂ ≥ 0                                     ŷ = z
//!  bounded       τ ± (Ĵx + w − b̂) ≥ 0                               ŷ = z₊ − z₋
//!  friction      ûₙ + s ± μ̂ ûₜ ≥ 0                                   ŷₙ = z₊ + z₋,  ŷₜ = μ̂ (z₊ − z₋)
//!                or (ûₙ + s, μ̂ ûₜ) in the second-order cone          ŷₙ = z₀,       ŷₜ = μ̂ z₁
//! ```
//!
//! w = ĉ ŷ is there for compliant rows only, τ for bounded ones. μ̂ = μ √(W_tt/W_nn): each row has its
//! own scale.

use clarabel::algebra::CscMatrix;
use clarabel::solver::SupportedConeT;
use tangency_lcp::{Law, Lcp, LcpSolution, Metric};

use crate::fixed_point::FrictionCone;

/// Where a row of the problem stands in the program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Place {
    /// One cone row.
    Single(usize),
    /// Two cone rows, from this one on: a bounded row.
    Bounded(usize),
    /// The normal row of a contact with friction: two cone rows and the friction row's index.
    Normal(usize, usize),
    /// The friction row: its contact's first cone row and μ̂.
    Friction(usize, f64),
}

/// The program's data, and how to come back.
#[derive(Debug)]
pub(crate) struct Program {
    pub(crate) p: CscMatrix<f64>,
    pub(crate) q: Vec<f64>,
    pub(crate) a: CscMatrix<f64>,
    pub(crate) b: Vec<f64>,
    pub(crate) cones: Vec<SupportedConeT<f64>>,
    pub(crate) places: Vec<Place>,
    cone: FrictionCone,
}

/// One affine expression Ĵx + w − b̂ over the program's unknowns.
#[derive(Clone, Debug, Default)]
struct Affine {
    entries: Vec<(usize, f64)>,
    constant: f64,
}

impl Affine {
    /// self + factor · other
    fn plus(&self, factor: f64, other: &Self) -> Self {
        let mut sum = self.clone();
        sum.entries.extend(other.entries.iter().map(|(k, x)| (*k, factor * x)));
        sum.constant += factor * other.constant;
        sum
    }
}

/// Collects the program.
struct Builder<'a> {
    problem: &'a Lcp,
    metric: &'a Metric,
    p: Vec<f64>,
    q: Vec<f64>,
    triplets: [Vec<usize>; 2],
    values: Vec<f64>,
    b: Vec<f64>,
    cones: Vec<SupportedConeT<f64>>,
}

impl Program {
    pub(crate) fn new(problem: &Lcp, metric: &Metric, cone: FrictionCone) -> Self {
        let mut builder = Builder::new(problem, metric);
        let affine: Vec<Affine> = (0..problem.rows.len()).map(|i| builder.affine(i)).collect();
        let mut places = vec![Place::Single(usize::MAX); affine.len()];
        // Zero cone first, then the rest.
        for i in builder.rows_with(|law| *law == Law::Equality) {
            places[i] = Place::Single(builder.push(&affine[i], SupportedConeT::ZeroConeT(1)));
        }
        let nonnegative = || SupportedConeT::NonnegativeConeT(1);
        for i in 0..affine.len() {
            match problem.rows[i].law {
                Law::Bounded { max } => {
                    let tau = builder.bound(metric.impulse(i, max) / metric.scale);
                    let first = builder.push(&tau.plus(1.0, &affine[i]), nonnegative());
                    builder.push(&tau.plus(-1.0, &affine[i]), nonnegative());
                    places[i] = Place::Bounded(first);
                }
                Law::Friction { normal, mu } => {
                    let n = normal as usize;
                    let mu = mu * metric.root(i) / metric.root(n);
                    let first = match cone {
                        FrictionCone::Polyhedral => {
                            let first =
                                builder.push(&affine[n].plus(mu, &affine[i]), nonnegative());
                            builder.push(&affine[n].plus(-mu, &affine[i]), nonnegative());
                            first
                        }
                        FrictionCone::SecondOrder => {
                            let tangential = Affine::default().plus(mu, &affine[i]);
                            let first =
                                builder.push(&affine[n], SupportedConeT::SecondOrderConeT(2));
                            builder.push_into_last(&tangential);
                            first
                        }
                    };
                    places[n] = Place::Normal(first, i);
                    places[i] = Place::Friction(first, mu);
                }
                Law::Equality | Law::Unilateral => {}
            }
        }
        for i in builder.rows_with(|law| *law == Law::Unilateral) {
            if places[i] == Place::Single(usize::MAX) {
                places[i] = Place::Single(builder.push(&affine[i], nonnegative()));
            }
        }
        builder.finish(places, cone)
    }

    /// Whether the program depends on s.
    pub(crate) fn has_friction(&self) -> bool {
        self.places.iter().any(|place| matches!(place, Place::Friction(..)))
    }

    /// b with the frozen `s` (one number per row of the problem; read at friction rows).
    pub(crate) fn shifted(&self, s: &[f64]) -> Vec<f64> {
        let mut b = self.b.clone();
        for (place, s) in self.places.iter().zip(s) {
            if let Place::Friction(first, _) = place {
                b[*first] += s;
                if self.cone == FrictionCone::Polyhedral {
                    b[first + 1] += s;
                }
            }
        }
        b
    }

    /// Velocities and impulses of an iterate; slacks and modes are left to the polish.
    pub(crate) fn recover(
        &self,
        problem: &Lcp,
        metric: &Metric,
        x: &[f64],
        z: &[f64],
    ) -> LcpSolution {
        let mut solution = LcpSolution::default();
        for (body, mass) in problem.mass.iter().enumerate() {
            let at = |k: usize| metric.true_velocity(x[3 * body + k] * metric.scale, mass[k]);
            solution.velocities.push([at(0), at(1), at(2)].into());
        }
        for (i, (place, row)) in self.places.iter().zip(&problem.rows).enumerate() {
            let y = match (*place, self.cone) {
                (Place::Single(k), _) if row.law == Law::Equality => -z[k],
                (Place::Single(k), _) | (Place::Normal(k, _), FrictionCone::SecondOrder) => z[k],
                (Place::Bounded(k), _) => z[k] - z[k + 1],
                (Place::Normal(k, _), FrictionCone::Polyhedral) => z[k] + z[k + 1],
                (Place::Friction(k, mu), FrictionCone::Polyhedral) => mu * (z[k] - z[k + 1]),
                (Place::Friction(k, mu), FrictionCone::SecondOrder) => mu * z[k + 1],
            };
            solution.impulses.push(metric.true_impulse(i, y * metric.scale));
        }
        solution.slacks = problem.remainders(&solution.velocities, &solution.impulses);
        solution
    }

    /// μ̂|ûₜ| per friction row, 0 elsewhere.
    pub(crate) fn sliding(&self, metric: &Metric, solution: &LcpSolution) -> Vec<f64> {
        let slack = |i: usize| metric.remainder(i, solution.slacks[i]) / metric.scale;
        let of = |(i, place): (usize, &Place)| match place {
            Place::Friction(_, mu) => mu * slack(i).abs(),
            _ => 0.0,
        };
        self.places.iter().enumerate().map(of).collect()
    }
}

impl<'a> Builder<'a> {
    fn new(problem: &'a Lcp, metric: &'a Metric) -> Self {
        let mut q = Vec::with_capacity(3 * problem.mass.len());
        for (p, mass) in problem.momentum.iter().zip(&problem.mass) {
            q.extend((0..3).map(|k| -metric.momentum(p[k], mass[k]) / metric.scale));
        }
        let (p, b, cones) = (vec![1.0; q.len()], Vec::new(), Vec::new());
        let triplets = [Vec::new(), Vec::new()];
        Self { problem, metric, p, q, triplets, values: Vec::new(), b, cones }
    }

    fn rows_with(&self, wanted: impl Fn(&Law) -> bool) -> Vec<usize> {
        (0..self.problem.rows.len()).filter(|i| wanted(&self.problem.rows[*i].law)).collect()
    }

    /// Ĵx + w − b̂ of a row; adds w where the row is compliant.
    fn affine(&mut self, i: usize) -> Affine {
        let (row, metric) = (&self.problem.rows[i], self.metric);
        let constant = -metric.remainder(i, row.rhs) / metric.scale;
        let mut affine = Affine { entries: Vec::new(), constant };
        for (body, block) in row.blocks() {
            let mass = &self.problem.mass[body];
            let of = |k: usize| metric.remainder(i, metric.true_velocity(block[k], mass[k]));
            let entry = |k: usize| (3 * body + k, of(k));
            affine.entries.extend((0..3).map(entry).filter(|(_, x)| *x != 0.0));
        }
        if row.compliance > 0.0 {
            let compliance = metric.remainder(i, metric.true_impulse(i, row.compliance));
            affine.entries.push((self.unknown(1.0 / compliance, 0.0), 1.0));
        }
        affine
    }

    /// τ of a bounded row with cost h τ.
    fn bound(&mut self, h: f64) -> Affine {
        Affine { entries: vec![(self.unknown(0.0, h), 1.0)], constant: 0.0 }
    }

    fn unknown(&mut self, p: f64, q: f64) -> usize {
        self.p.push(p);
        self.q.push(q);
        self.p.len() - 1
    }

    /// Adds `affine ∈ cone`, in Clarabel's form A x + s = b, s ∈ K; returns its first cone row.
    fn push(&mut self, affine: &Affine, cone: SupportedConeT<f64>) -> usize {
        self.cones.push(cone);
        self.push_into_last(affine)
    }

    fn push_into_last(&mut self, affine: &Affine) -> usize {
        let row = self.b.len();
        for (k, x) in &affine.entries {
            self.triplets[0].push(row);
            self.triplets[1].push(*k);
            self.values.push(-x);
        }
        self.b.push(affine.constant);
        row
    }

    fn finish(self, places: Vec<Place>, cone: FrictionCone) -> Program {
        let (m, n) = (self.b.len(), self.p.len());
        let diagonal: Vec<usize> = (0..n).collect();
        let p = CscMatrix::new_from_triplets(n, n, diagonal.clone(), diagonal, self.p);
        let [rows, columns] = self.triplets;
        let a = CscMatrix::new_from_triplets(m, n, rows, columns, self.values);
        Program { p, q: self.q, a, b: self.b, cones: self.cones, places, cone }
    }
}
