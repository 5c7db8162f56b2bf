//! The infeasible predictor-corrector loop (Mehrotra 1992; Mattingley & Boyd 2012) on the box form.

use crate::box_form::BoxForm;
use crate::newton::{Iterate, Newton};

/// Share of the step to the boundary that is taken.
const TO_BOUNDARY: f64 = 0.995;
/// Products are not driven below this; smaller ones cost accuracy at grazing contacts.
const LEAST_PRODUCT: f64 = 1e-26;
/// Iterations without a new least residual, or with hardly a step, after which the loop gives up.
const PATIENCE: u32 = 12;
const SHORT_STEPS: u32 = 4;

/// The running loop: one call of [`advance`](Self::advance) is one iteration.
#[derive(Debug)]
pub(crate) struct Loop<'a> {
    form: &'a BoxForm,
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
    pub(crate) fn new(form: &'a BoxForm) -> Self {
        let at = Iterate::start(form);
        let u = form.remainders(&at.y);
        let best = form.residual(&at.y, &u);
        let best_y = at.y.clone();
        Self { form, at, u, best, best_y, since_best: 0, short: 0, iterations: 0 }
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
        let length = TO_BOUNDARY * self.at.longest(self.form, &step, 1.0 / TO_BOUNDARY);
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
        self.short < SHORT_STEPS && self.since_best < PATIENCE && residual.is_finite()
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
        let centring = ratio.powi(3);
        if affine < 0.1 {
            newton.step((centring.max(0.3) * product).max(LEAST_PRODUCT), None)
        } else {
            newton.step((centring * product).max(LEAST_PRODUCT), Some(&predictor))
        }
    }
}
