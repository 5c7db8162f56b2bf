//! The point of a problem's central path at which every complementary product is one energy ε.
//!
//! ```text
//!  M v = p + Jᵀ λ         u = J v + c λ − b         u, λ obey the softened laws of `barrier`
//! ```
//!
//! It is a smooth function of the problem, near its solution for small ε: off by O(ε) where no row is at
//! a switch, by O(√ε) where one is. Newton's method finds it from the solution. Its steps, and the
//! derivative of the point, are problems of soft rows: with u = o − a λ + β h and λ = y + ρ h,
//!
//! ```text
//!  J v + (c + a) y = b + o           ρ = β/(c + a), |ρ| < 1
//! ```
//!
//! A contact so sticks in part (y_t) and slides in part (λ_t = y_t + ρ μ λₙ): the equations are those of
//! an [`ActiveSystem`] in which every row is active and softer, and friction is folded by its share ρ μ.

use nalgebra::Vector3;

use crate::barrier::{Barrier, Softness};
use crate::{ActiveSystem, Fold, Law, Lcp, LcpError, LcpSolution, Metric, Row, Scratch};

/// Most steps of Newton's method at one energy.
const MOST_STEPS: u32 = 40;
/// Where a point is not found, one of an energy greater by this factor leads to it.
const DETOUR: f64 = 30.0;
/// Most such factors.
const DETOURS: u32 = 5;
/// Share of the way to where a pair vanishes that a step may go.
const SHARE: f64 = 0.99;
/// Accepted residuals that steps may fail to make much smaller before the method ends.
const PATIENCE: u32 = 2;
/// Residuals that need no further step.
const EXACT: f64 = 1e-15;
/// Residuals above this are no solution.
const ACCEPTED: f64 = 1e-10;

/// A point of the central path, and its linearisation.
#[derive(Clone, Debug)]
pub struct CentralPoint {
    /// v, λ and u of the point; modes are those of the solution that it is near to.
    pub solution: LcpSolution,
    /// ε, J.
    pub energy: f64,
    /// What the equations leave over in mass-weighted units, relative to s*.
    pub residual: f64,
    /// Steps of Newton's method.
    pub steps: u32,
    soft: SoftProblem,
}

/// A problem with softer rows, factored.
#[derive(Clone, Debug)]
struct SoftProblem {
    problem: Lcp,
    system: ActiveSystem,
    softness: Vec<Softness>,
}

impl CentralPoint {
    /// The point of energy ε near a solution.
    ///
    /// # Errors
    /// [`LcpError::NotConverged`] if there is none near it.
    pub fn new(
        problem: &Lcp,
        near: &LcpSolution,
        energy: f64,
        scratch: &mut Scratch,
    ) -> Result<Self, LcpError> {
        let metric = Metric::new(problem);
        let mut newton = Newton::new(problem, &metric, near, energy);
        for _ in 0..=DETOURS {
            if newton.reach(energy, scratch) {
                return Ok(newton.finish(near, scratch));
            }
            let wider = newton.widest * DETOUR;
            newton = Newton { steps: newton.steps, ..Newton::new(problem, &metric, near, wider) };
        }
        let Newton { residual, steps, .. } = newton;
        Err(LcpError::NotConverged { iterations: steps, residual })
    }

    /// The energy ε = κ s² of a problem, J; s is its scale s* without the rows that are open and could only
    /// stop what moves: `b < 0` of a unilateral one.
    #[must_use]
    pub fn energy(problem: &Lcp, kappa: f64) -> f64 {
        let moving = problem.mass.iter().zip(&problem.momentum);
        let moving = moving.flat_map(|(mass, p)| p.component_mul(p).component_div(mass).data.0[0]);
        let drives = |row: &&Row| row.law != Law::Unilateral || row.rhs > 0.0;
        let driven = problem.rows.iter().enumerate().filter(|(_, row)| drives(row));
        let driven = driven.map(|(i, row)| row.rhs * row.rhs / problem.row_weight(i));
        kappa * moving.chain(driven).fold(0.0, f64::max)
    }

    /// The problem with softer rows, whose system is [`system`](Self::system).
    #[must_use]
    pub fn soft(&self) -> &Lcp {
        &self.soft.problem
    }

    /// The equations of the derivative: every row is active, and every friction row is folded in part.
    #[must_use]
    pub fn system(&self) -> &ActiveSystem {
        &self.soft.system
    }

    /// ∂u/∂h of a bounded or friction row, velocity per impulse.
    #[must_use]
    pub fn by_bound(&self, row: usize) -> f64 {
        self.soft.softness[row].by_bound()
    }
}

impl SoftProblem {
    fn new(problem: &Lcp, softness: Vec<Softness>, scratch: &mut Scratch) -> Self {
        let mut problem = problem.clone();
        let mut folds = Vec::new();
        for (index, (row, soft)) in (0_u32..).zip(problem.rows.iter_mut().zip(&softness)) {
            row.compliance += soft.compliance();
            if let Law::Friction { normal, mu } = row.law {
                let coefficient = mu * soft.by_bound() / row.compliance;
                folds.push(Fold { row: index, column: normal, coefficient });
            }
        }
        let metric = scratch.metric(&problem);
        let system = ActiveSystem::of_folded(&problem, &metric, &folds, scratch);
        scratch.give_metric(metric);
        Self { problem, system, softness }
    }

    /// (v, y, λ) that the equations imply, y and λ per row.
    fn solve(&self) -> (Vec<Vector3<f64>>, Vec<f64>, Vec<f64>) {
        let Self { problem, system, softness } = self;
        let mut impulses = vec![0.0; problem.rows.len()];
        let mut momentum = problem.momentum.clone();
        for (i, (row, soft)) in problem.rows.iter().zip(softness).enumerate() {
            if let Law::Bounded { max } = row.law {
                impulses[i] = max * (soft.by_bound() / row.compliance);
                row.add_transposed(impulses[i], &mut momentum);
            }
        }
        let right = |row: &u32| problem.rows[*row as usize].rhs + softness[*row as usize].offset;
        let rhs: Vec<f64> = system.rows().iter().map(right).collect();
        let found = system.solve_with(problem, &momentum, &rhs);
        let mut own = vec![0.0; problem.rows.len()];
        for (row, y) in system.rows().iter().zip(&found.impulses) {
            own[*row as usize] = *y;
            impulses[*row as usize] += *y;
        }
        for fold in system.folds() {
            let normal = found.impulses[fold.column as usize];
            impulses[fold.row as usize] += fold.coefficient * normal;
        }
        (found.velocities, own, impulses)
    }
}

/// Newton's method for the point.
struct Newton<'a> {
    problem: &'a Lcp,
    metric: &'a Metric,
    energy: f64,
    /// The energy that the method began with.
    widest: f64,
    barriers: Vec<Barrier>,
    impulses: Vec<f64>,
    velocities: Vec<Vector3<f64>>,
    residual: f64,
    steps: u32,
}

impl<'a> Newton<'a> {
    /// Every row where it would be if it were alone.
    fn new(problem: &'a Lcp, metric: &'a Metric, near: &LcpSolution, energy: f64) -> Self {
        let mut impulses: Vec<f64> = Vec::with_capacity(near.impulses.len());
        let mut barriers = Vec::with_capacity(near.impulses.len());
        for (i, row) in problem.rows.iter().enumerate() {
            let (at, weight) = ([near.impulses[i], near.slacks[i]], problem.row_weight(i));
            let bound = bound(row.law, &impulses);
            let barrier = Barrier::meeting(row.law, at, weight, bound, energy);
            impulses.push(barrier.impulse().unwrap_or(near.impulses[i]));
            barriers.push(barrier);
        }
        let velocities = problem.velocities(&impulses);
        let mut newton = Self {
            problem,
            metric,
            energy,
            widest: energy,
            barriers,
            impulses,
            velocities,
            residual: f64::INFINITY,
            steps: 0,
        };
        newton.residual = newton.assess();
        newton
    }

    /// Goes to the point of an energy, by way of greater ones if the method began there; whether it is
    /// found.
    fn reach(&mut self, energy: f64, scratch: &mut Scratch) -> bool {
        loop {
            self.run(scratch);
            if self.residual > ACCEPTED || self.residual.is_nan() || self.energy <= energy {
                return self.residual <= ACCEPTED;
            }
            self.energy = (self.energy / DETOUR).max(energy);
            self.residual = self.assess();
        }
    }

    /// Newton's method at one energy, until nothing more is to be gained.
    fn run(&mut self, scratch: &mut Scratch) {
        let (mut stalled, last) = (0, self.steps + MOST_STEPS);
        while self.residual > EXACT && stalled < PATIENCE && self.steps < last {
            let before = self.residual;
            self.step(scratch);
            self.residual = self.assess();
            let stalls = before < ACCEPTED && self.residual > 0.3 * before;
            stalled = if stalls { stalled + 1 } else { 0 };
        }
    }

    /// The greatest of what the equations of the softer rows leave over, and the pairs, in mass-weighted
    /// units relative to s*.
    fn assess(&self) -> f64 {
        let mut worst = 0.0_f64;
        for (i, (row, barrier)) in self.problem.rows.iter().zip(&self.barriers).enumerate() {
            let (impulse, weight) = (self.impulses[i], self.problem.row_weight(i));
            let slack = row.velocity(&self.velocities) + row.compliance * impulse - row.rhs;
            let soft = weight + barrier.softness(self.energy).compliance();
            let open = (slack - barrier.slack()).abs() / soft.sqrt();
            let bound = bound(row.law, &self.impulses);
            let both = open + barrier.defect(impulse, bound, weight, self.energy);
            worst = if both.is_finite() { worst.max(both) } else { f64::INFINITY };
        }
        let scale = self.metric.scale * self.metric.unit().sqrt();
        worst / scale.max(self.energy.sqrt())
    }

    fn softness(&self) -> Vec<Softness> {
        self.barriers.iter().map(|barrier| barrier.softness(self.energy)).collect()
    }

    /// Goes towards where the linear laws meet as far as every pair stays positive.
    fn step(&mut self, scratch: &mut Scratch) {
        self.steps += 1;
        let soft = SoftProblem::new(self.problem, self.softness(), scratch);
        let (velocities, own, impulses) = soft.solve();
        let stepped = |(i, barrier): (usize, &Barrier)| {
            let row = &soft.problem.rows[i];
            let at = [own[i], bound(row.law, &impulses)];
            barrier.stepped(at, row.compliance, self.energy)
        };
        let to: Vec<Barrier> = self.barriers.iter().enumerate().map(stepped).collect();
        let ways = self.barriers.iter().zip(&to).map(|(from, to)| from.longest(to));
        let length = (SHARE * ways.fold(f64::INFINITY, f64::min)).min(1.0);
        self.barriers.iter_mut().zip(&to).for_each(|(from, to)| from.advance(to, length));
        for (from, to) in self.impulses.iter_mut().zip(&impulses) {
            *from += length * (to - *from);
        }
        for (from, to) in self.velocities.iter_mut().zip(&velocities) {
            *from += length * (to - *from);
        }
    }

    fn finish(mut self, near: &LcpSolution, scratch: &mut Scratch) -> CentralPoint {
        for (i, barrier) in self.barriers.iter_mut().enumerate() {
            *barrier = barrier.settled(self.problem.row_weight(i), self.energy);
        }
        let soft = SoftProblem::new(self.problem, self.softness(), scratch);
        let slacks = self.problem.remainders(&self.velocities, &self.impulses);
        let Self { velocities, impulses, energy, residual, steps, .. } = self;
        let (modes, stats) = (near.modes.clone(), near.stats);
        let solution =
            LcpSolution { velocities, impulses, slacks, modes, stats, ..LcpSolution::default() };
        CentralPoint { solution, energy, residual, steps, soft }
    }
}

/// h of a row.
fn bound(law: Law, impulses: &[f64]) -> f64 {
    match law {
        Law::Bounded { max } => max,
        Law::Friction { normal, mu } => mu * impulses[normal as usize],
        Law::Equality | Law::Unilateral => 0.0,
    }
}
