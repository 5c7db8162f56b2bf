//! Active-set polish of raw problems: what every backend ends with.

#![expect(non_snake_case, reason = "matrices carry their names from the literature")]

use nalgebra::DVector;

use super::{ACCEPTANCE, RawLcp, RawSolution};
use crate::{BandMatrix, BoxForm, BoxLaw, LcpError, Lu};

/// ε of the proximal term, as for the rows of a mechanical problem.
const PROXIMAL: f64 = 1e-10;
const MAX_SWEEPS: usize = 12;
/// Below this z and w both count as zero, relative to the scaled q.
const WEAK: f64 = 1e-10;

/// Collects approximate unknowns of a raw problem and keeps the best that the active-set loop makes
/// of them.
#[derive(Clone, Debug)]
pub struct RawPolish<'a> {
    problem: &'a RawLcp,
    form: &'a BoxForm,
    target: f64,
    max_flips: u32,
    best: Option<Candidate>,
}

impl<'a> RawPolish<'a> {
    /// A polish towards the residual `target`, with at most `max_flips` corrections per attempt.
    /// `form` is the problem's [box form](RawLcp::box_form).
    #[must_use]
    pub fn new(problem: &'a RawLcp, form: &'a BoxForm, target: f64, max_flips: u32) -> Self {
        Self { problem, form, target, max_flips, best: None }
    }

    /// The scaled problem, in whose unknowns y candidates are offered.
    #[must_use]
    pub fn form(&self) -> &'a BoxForm {
        self.form
    }

    /// Whether the target is reached.
    #[must_use]
    pub fn reached(&self) -> bool {
        self.best.as_ref().is_some_and(|best| best.residual <= self.target)
    }

    /// The unknowns that y shows as active.
    #[must_use]
    pub fn active(&self, y: &[f64]) -> Vec<bool> {
        let u = self.form.remainders(y);
        let pairs = y.iter().zip(&u);
        let active = |(law, (y, u)): (&BoxLaw, (&f64, &f64))| *law == BoxLaw::Free || y > u;
        self.form.laws.iter().zip(pairs).map(active).collect()
    }

    /// Takes into account the approximate unknowns themselves and what the active-set loop makes of
    /// them; true if the target is reached.
    pub fn offer(&mut self, y: &[f64]) -> bool {
        let z = DVector::from_vec(self.form.impulses(y));
        self.keep(Candidate::plain(self.problem, z));
        let found = self.active_set().run(self.active(y), y, self.target);
        self.keep(found);
        self.reached()
    }

    /// The best candidate as a solution.
    ///
    /// # Errors
    /// [`LcpError::NotConverged`] if its residual is above 1e-10.
    pub fn finish(self, iterations: u32, pivots: u32) -> Result<RawSolution, LcpError> {
        let Self { problem, form, best, .. } = self;
        match best {
            Some(best) if best.residual <= ACCEPTANCE => {
                Ok(best.into_solution(problem, form, iterations, pivots))
            }
            best => {
                let residual = best.map_or(f64::INFINITY, |best| best.residual);
                Err(LcpError::NotConverged { iterations, residual })
            }
        }
    }

    fn keep(&mut self, candidate: Candidate) {
        if self.best.as_ref().is_none_or(|best| candidate.residual < best.residual) {
            self.best = Some(candidate);
        }
    }

    fn active_set(&self) -> ActiveSet<'a> {
        ActiveSet { problem: self.problem, form: self.form, max_flips: self.max_flips }
    }
}

/// z with its residual.
#[derive(Clone, Debug)]
struct Candidate {
    z: DVector<f64>,
    residual: f64,
}

impl Candidate {
    /// As it is, negative complementary unknowns set to zero.
    fn plain(problem: &RawLcp, mut z: DVector<f64>) -> Self {
        z.iter_mut().skip(problem.free).for_each(|z| *z = z.max(0.0));
        let residual = problem.residual(&z);
        Self { z, residual }
    }

    fn into_solution(
        self,
        problem: &RawLcp,
        form: &BoxForm,
        iterations: u32,
        pivots: u32,
    ) -> RawSolution {
        let Self { z, residual } = self;
        let w = &problem.matrix * &z + &problem.q;
        let scaled = |i: usize| (z[i] / form.unscale[i], w[i] * form.unscale[i]);
        let is_active = |i: &usize| {
            let (y, u) = scaled(*i);
            *i < problem.free || (y > WEAK && y > u)
        };
        let active: Vec<usize> = (0..z.len()).filter(is_active).collect();
        let size = form.unscale.first().map_or(1.0, |unscale| unscale.abs());
        let weak = (problem.free..z.len())
            .filter(|&i| {
                let (y, u) = scaled(i);
                y <= WEAK && u.abs() <= WEAK * size * size
            })
            .collect();
        let rank_defect = System::new(form, &active).rank_defect;
        RawSolution { z, w, residual, iterations, pivots, active, weak, rank_defect }
    }
}

/// Primal-dual active-set loop on the scaled problem.
struct ActiveSet<'a> {
    problem: &'a RawLcp,
    form: &'a BoxForm,
    max_flips: u32,
}

impl ActiveSet<'_> {
    /// Best candidate on the way from `active`; dependent unknowns stay near `start`.
    fn run(&self, mut active: Vec<bool>, start: &[f64], target: f64) -> Candidate {
        let mut seen: Vec<Vec<bool>> = Vec::new();
        let mut single = false;
        let mut best: Option<Candidate> = None;
        for _ in 0..=self.max_flips {
            let (y, candidate) = self.evaluate(&active, start, target);
            if best.as_ref().is_none_or(|best| candidate.residual < best.residual) {
                best = Some(candidate);
            }
            if best.as_ref().is_some_and(|best| best.residual <= target) {
                break;
            }
            let mut next = self.corrected(&active, &y);
            single |= seen.contains(&next);
            if single {
                next = last_correction(&active, &next);
            }
            if next == active {
                break;
            }
            seen.push(std::mem::replace(&mut active, next));
        }
        best.expect("the loop runs at least once")
    }

    /// The smallest solution of the equations; if it breaks a sign and is not the only one, the one
    /// nearest to `start`.
    fn evaluate(&self, active: &[bool], start: &[f64], target: f64) -> (Vec<f64>, Candidate) {
        let slots: Vec<usize> = (0..active.len()).filter(|&i| active[i]).collect();
        let system = System::new(self.form, &slots);
        let solve = |from: Vec<f64>| {
            let y = self.solve(&system, &slots, from);
            let z = DVector::from_vec(self.form.impulses(&y));
            (y, Candidate::plain(self.problem, z))
        };
        let least = solve(vec![0.0; active.len()]);
        if system.rank_defect == 0 || least.1.residual <= target {
            return least;
        }
        let mut from = vec![0.0; active.len()];
        for &i in &slots {
            from[i] = start[i];
        }
        let near = solve(from);
        if near.1.residual < least.1.residual { near } else { least }
    }

    fn corrected(&self, active: &[bool], y: &[f64]) -> Vec<bool> {
        let u = self.form.remainders(y);
        let keep = |i: usize| match (self.form.laws[i], active[i]) {
            (BoxLaw::Free, _) => true,
            (_, true) => y[i] >= 0.0,
            (_, false) => u[i] < 0.0,
        };
        (0..active.len()).map(keep).collect()
    }

    /// M_AA y_A = −q_A by refinement from `y`, which is zero outside A.
    fn solve(&self, system: &System, slots: &[usize], mut y: Vec<f64>) -> Vec<f64> {
        let mut previous = f64::INFINITY;
        for sweep in 0..MAX_SWEEPS {
            let u = self.form.remainders(&y);
            let mut r: Vec<f64> = slots.iter().map(|&i| -u[i]).collect();
            let worst = r.iter().fold(0.0_f64, |worst, r| worst.max(r.abs()));
            if worst <= 1e-17 || (sweep >= 2 && worst > 0.5 * previous) {
                break;
            }
            previous = worst;
            system.factor.solve(&mut r);
            slots.iter().zip(&r).for_each(|(&i, dy)| y[i] += dy);
        }
        y
    }
}

fn last_correction(active: &[bool], next: &[bool]) -> Vec<bool> {
    let mut corrected = active.to_vec();
    if let Some(i) = (0..active.len()).rev().find(|&i| active[i] != next[i]) {
        corrected[i] = next[i];
    }
    corrected
}

/// M_AA + ε I, factored.
struct System {
    factor: Lu,
    rank_defect: u32,
}

impl System {
    fn new(form: &BoxForm, slots: &[usize]) -> Self {
        let n = slots.len();
        let mut M = BandMatrix::zeros(n, form.matrix.lower());
        for (i, &row) in slots.iter().enumerate() {
            for j in M.columns(i) {
                M.add(i, j, form.entry(row, slots[j]));
            }
            M.add(i, i, PROXIMAL);
        }
        let factor = Lu::new(M, 1e-3 * PROXIMAL);
        let small = factor.pivots().filter(|pivot| pivot.abs() < 16.0 * PROXIMAL).count();
        Self { factor, rank_defect: u32::try_from(small).unwrap_or(u32::MAX) }
    }
}
