//! How much a gradient grows on its way back, told where it is a lot.

use serde::Serialize;
use tangency::GradientReport;

/// Growth above this is told: of a number that is known to 16 digits, fewer than 10 then matter.
const MUCH: f64 = 1e6;

/// What lies before this much growth is not counted to where it happens.
const LITTLE: f64 = 10.0;

/// The greatest growth of a gradient.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Growth {
    /// How much, relative to the derivatives of the loss.
    pub factor: f64,
    /// The steps, counted from 1, over which it grew from little to that.
    pub steps: [usize; 2],
}

impl Growth {
    /// Of a gradient; nothing if it is zero.
    #[must_use]
    pub fn of(report: &GradientReport) -> Self {
        let Some((state, factor)) = report.greatest_growth() else { return Self::default() };
        let little = |growth: &f64| *growth <= LITTLE;
        let length = report.growth[state..].iter().position(little).unwrap_or(0);
        Self { factor, steps: [state + 1, state + length.max(1)] }
    }

    /// A sentence where it is much.
    #[must_use]
    pub fn warning(&self) -> Option<String> {
        let Self { factor, steps: [first, last] } = self;
        (*factor > MUCH).then(|| {
            format!(
                "The gradient grows by {factor:.1e} over steps {first} to {last}: the motion there \
                 amplifies small changes by as much"
            )
        })
    }
}
