//! The infeasible predictor-corrector loop (Mehrotra 1992; Mattingley & Boyd 2012) on the box form.

use tangency_lcp::{Mode, Scratch};

use crate::iterate::Iterate;
use crate::newton::Newton;
use crate::system::System;

/// Products are not driven below this; smaller ones cost accuracy at grazing contacts.
const LEAST_PRODUCT: f64 = 1e-26;

/// How boldly the loop goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pace {
    /// Impulses at the start.
    pub(crate) start: f64,
    /// Share of the step to the boundary that is taken.
    pub(crate) to_boundary: f64,
    /// Least centring σ.
    pub(crate) centring: f64,
    /// Whether the corrector's second-order terms are used.
    pub(crate) second_order: bool,
    /// Iterations without a new least residual after which the loop gives up.
    pub(crate) patience: u32,
}

/// Mehrotra's choices: fast where the path is smooth.
pub(crate) const BOLD: Pace =
    Pace { start: 1.0, to_boundary: 0.995, centring: 0.0, second_order: true, patience: 12 };
/// Short steps near the central path: slow, and often successful where the bold loop jams.
pub(crate) const CAREFUL: Pace =
    Pace { start: 10.0, to_boundary: 0.9, centring: 0.2, second_order: false, patience: 25 };
/// Steps shorter than 0.02 in a row after which the loop gives up.
const SHORT_STEPS: u32 = 4;

/// The running loop: one call of [`advance`](Self::advance) is one iteration.
#[derive(Debug)]
pub(crate) struct Loop<'a, S> {
    pub(crate) system: &'a mut S,
    pace: Pace,
    at: Iterate,
    newton: Newton,
    predictor: Iterate,
    step: Iterate,
    /// Number of pairs.
    pairs: f64,
    u: Vec<f64>,
    /// Least natural residual so far.
    pub(crate) best: f64,
    best_y: Vec<f64>,
    since_best: u32,
    short: u32,
    /// Iterations done.
    pub(crate) iterations: u32,
    /// Whether predictor and iterate agree on which member of each pair is the greater.
    pub(crate) settled: bool,
}

impl<'a, S: System> Loop<'a, S> {
    pub(crate) fn new(system: &'a mut S, pace: Pace, scratch: &mut Scratch) -> Self {
        let len = system.q().len();
        let mut at = Iterate::zeros(len, scratch);
        at.start(system.laws(), system.q(), pace.start);
        let pairs = system.laws().iter().map(|law| law.pairs()).sum::<usize>() as f64;
        let mut best_y = scratch.floats.take();
        best_y.extend_from_slice(&at.y);
        let mut start = Self {
            system,
            pace,
            at,
            newton: Newton::new(len, scratch),
            predictor: Iterate::zeros(len, scratch),
            step: Iterate::zeros(len, scratch),
            pairs,
            u: scratch.floats.filled(len, 0.0),
            best: f64::INFINITY,
            best_y,
            since_best: 0,
            short: 0,
            iterations: 0,
            settled: false,
        };
        start.best = start.renew_residual();
        start
    }

    /// Gives its memory back.
    pub(crate) fn give(self, scratch: &mut Scratch) {
        for iterate in [self.at, self.predictor, self.step] {
            iterate.give(scratch);
        }
        for floats in [self.u, self.best_y] {
            scratch.floats.give(floats);
        }
        self.newton.give(scratch);
    }

    /// Current unknowns.
    pub(crate) fn y(&self) -> &[f64] {
        &self.at.y
    }

    /// Modes of the iterate, per row of the problem.
    pub(crate) fn list_modes(&self, modes: &mut Vec<Mode>) {
        let (y, u) = (&self.at.y, &self.u);
        modes.clear();
        modes.resize(y.len(), Mode::Active);
        for (slot, law) in self.system.laws().iter().enumerate() {
            modes[self.system.row(slot)] = law.mode(slot, y, u);
        }
    }

    /// Unknowns of least residual.
    pub(crate) fn best_y(&self) -> &[f64] {
        &self.best_y
    }

    /// One iteration; false if the loop has nothing more to give.
    pub(crate) fn advance(&mut self, scratch: &mut Scratch) -> bool {
        self.newton.factor(self.system, &self.at, scratch);
        let solved = self.direction();
        let length =
            self.pace.to_boundary * self.at.longest(&self.step, 1.0 / self.pace.to_boundary);
        if !solved || !length.is_finite() || self.step.y.iter().any(|dy| !dy.is_finite()) {
            return false;
        }
        self.predictor.add(&self.at);
        self.at.advance(self.system.laws(), &self.step, length);
        self.settled = self.at.agrees(&self.predictor);
        self.iterations += 1;
        self.short = if length < 0.02 { self.short + 1 } else { 0 };
        let residual = self.renew_residual();
        if residual < self.best {
            self.best = residual;
            self.best_y.copy_from_slice(&self.at.y);
            self.since_best = 0;
        } else {
            self.since_best += 1;
        }
        self.short < SHORT_STEPS && self.since_best < self.pace.patience && residual.is_finite()
    }

    /// u = W y + q; returns the natural residual.
    fn renew_residual(&mut self) -> f64 {
        self.system.times(&self.at.y, &mut self.u);
        let mut worst = 0.0_f64;
        let rows = self.u.iter_mut().zip(self.system.q()).zip(self.system.laws());
        for (y, ((u, q), law)) in self.at.y.iter().zip(rows) {
            *u += q;
            let defect = law.defect(*y, *u, &self.at.y);
            worst = if defect.is_nan() { f64::INFINITY } else { worst.max(defect.abs()) };
        }
        worst
    }

    /// Predictor, centring σ = (μ_aff/μ)³, corrector; false if there is none.
    fn direction(&mut self) -> bool {
        let Self { system, at, newton, predictor, step, .. } = self;
        let before = at.products();
        if !newton.step(*system, (at, &self.u), 0.0, None, predictor) {
            return false;
        }
        let affine = at.longest(predictor, 1.0);
        let ratio = (at.products_after(predictor, affine) / before).clamp(0.0, 1.0);
        let mut centring = ratio.powi(3).max(self.pace.centring);
        let jammed = affine < 0.1;
        if jammed {
            centring = centring.max(0.3);
        }
        let target = (centring * (before / self.pairs.max(1.0))).max(LEAST_PRODUCT);
        let second = (!jammed && self.pace.second_order).then_some(&*predictor);
        newton.step(*system, (at, &self.u), target, second, step)
    }
}
