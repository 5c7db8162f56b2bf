//! The infeasible predictor-corrector loop (Mehrotra 1992; Mattingley & Boyd 2012) on the box form.

use tangency_lcp::BoxForm;

use crate::newton::{Iterate, Newton};

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
pub(crate) struct Loop<'a> {
    form: &'a BoxForm,
    pace: Pace,
    at: Iterate,
    u: Vec<f64>,
    /// Least natural residual so far.
    pub(crate) best: f64,
    best_y: Vec<f64>,
    since_best: u32,
    short: u32,
    /// Iterations done.
    pub(crate) iterations: u32,
}

impl<'a> Loop<'a> {
    pub(crate) fn new(form: &'a BoxForm, pace: Pace) -> Self {
        let at = Iterate::start(form, pace.start);
        let u = form.remainders(&at.y);
        let best = form.residual(&at.y, &u);
        let best_y = at.y.clone();
        Self { form, pace, at, u, best, best_y, since_best: 0, short: 0, iterations: 0 }
    }

    /// Current unknowns.
    pub(crate) fn y(&self) -> &[f64] {
        &self.at.y
    }

    /// Unknowns of least residual.
    pub(crate) fn best_y(&self) -> &[f64] {
        &self.best_y
    }

    /// One iteration; false if the loop has nothing more to give.
    pub(crate) fn advance(&mut self) -> bool {
        let step = self.direction();
        let length =
            self.pace.to_boundary * self.at.longest(self.form, &step, 1.0 / self.pace.to_boundary);
        if !length.is_finite() || step.y.iter().any(|dy| !dy.is_finite()) {
            return false;
        }
        self.at.advance(self.form, &step, length);
        self.u = self.form.remainders(&self.at.y);
        self.iterations += 1;
        self.short = if length < 0.02 { self.short + 1 } else { 0 };
        let residual = self.form.residual(&self.at.y, &self.u);
        if residual < self.best {
            self.best = residual;
            self.best_y.clone_from(&self.at.y);
            self.since_best = 0;
        } else {
            self.since_best += 1;
        }
        self.short < SHORT_STEPS && self.since_best < self.pace.patience && residual.is_finite()
    }

    /// Predictor, centring σ = (μ_aff/μ)³, corrector.
    fn direction(&self) -> Iterate {
        let newton = Newton::new(self.form, &self.at, &self.u);
        let product = self.at.mean_product(self.form);
        let predictor = newton.step(0.0, None);
        let affine = self.at.longest(self.form, &predictor, 1.0);
        let mut ahead = self.at.clone();
        ahead.advance(self.form, &predictor, affine);
        let ratio = (ahead.mean_product(self.form) / product).clamp(0.0, 1.0);
        let centring = ratio.powi(3).max(self.pace.centring);
        if affine < 0.1 || !self.pace.second_order {
            let centring = if affine < 0.1 { centring.max(0.3) } else { centring };
            newton.step((centring * product).max(LEAST_PRODUCT), None)
        } else {
            newton.step((centring * product).max(LEAST_PRODUCT), Some(&predictor))
        }
    }
}
