//! How far the impulses of a flow are from the ends of their laws.

use nalgebra::Vector3;
use tangency_lcp::{Guess, Law, Lcp, LcpSolution, Metric, Mode};

use crate::StepError;
use crate::island::Island;
use crate::obey::drive;
use crate::record::{IslandRecord, StepRecord};
use crate::resolve::Division;
use crate::row::{RowContext, RowSource};
use crate::scratch::StepScratch;
use crate::smooth::Slope;
use crate::touch::Survey;

/// Accelerations that differ by less than this part are the same.
const SAME: f64 = 1e-11;

impl Division<'_> {
    /// How far the impulses after a flow are from the ends of their laws, at least, relative to all that
    /// drives the problem; negative only if the laws then ask for other accelerations. And whose it is.
    pub(crate) fn margin_after(
        &self,
        flow: &StepRecord,
        survey: &Survey,
        scratch: &mut StepScratch,
    ) -> Result<(f64, RowSource), StepError> {
        let slope = self.slope_again(flow, &survey.reached, scratch)?;
        let context = flow.slope_context(self.scene, &slope);
        let (margin, source) = self.margin(&context, &slope);
        let mut broken =
            slope.islands.iter().filter(|island| margin_of(self, &context, &slope, island).0 < 0.0);
        if margin < 0.0 && !broken.any(|island| self.differs(&context, &slope, island, scratch)) {
            return Ok((0.0, source));
        }
        Ok((margin, source))
    }

    /// The least margin of a slope's rows.
    pub(crate) fn margin(&self, context: &RowContext<'_>, slope: &Slope) -> (f64, RowSource) {
        let of_island = |island| margin_of(self, context, slope, island);
        slope.islands.iter().map(of_island).fold(NO_MARGIN, least)
    }

    /// Whether the laws of an island ask for other accelerations than its modes.
    fn differs(
        &self,
        context: &RowContext<'_>,
        slope: &Slope,
        island: &IslandRecord,
        scratch: &mut StepScratch,
    ) -> bool {
        let IslandRecord { bodies, sources, problem, stage, solution, .. } = island;
        let (bodies, sources, problem) = (bodies.clone(), sources.clone(), problem.clone());
        let mut again = Island { bodies, sources, problem, stage: *stage };
        let guess = Guess { modes: solution.modes.clone(), impulses: solution.impulses.clone() };
        match self.obey(context, &slope.rates(), &mut again, Some(&guess), scratch) {
            Ok(other) => apart(&island.problem, solution, &other) > SAME,
            Err(_) => true,
        }
    }
}

const NO_MARGIN: (f64, RowSource) = (f64::INFINITY, RowSource::Held { joint: 0, row: 0 });

fn least(a: (f64, RowSource), b: (f64, RowSource)) -> (f64, RowSource) {
    if b.0 < a.0 { b } else { a }
}

/// How far an island's impulses are from the ends of their laws.
fn margin_of(
    division: &Division<'_>,
    context: &RowContext<'_>,
    slope: &Slope,
    island: &IslandRecord,
) -> (f64, RowSource) {
    let IslandRecord { problem, solution, sources, .. } = island;
    if problem.is_linear() {
        return NO_MARGIN;
    }
    let metric = Metric::new(problem);
    let impulse = |row: usize| metric.impulse(row, solution.impulses[row]);
    let (rates, scale) = (slope.rates(), drive(problem, &metric));
    let mut all = NO_MARGIN;
    for (row, source) in sources.iter().enumerate() {
        let margin = match (problem.rows[row].law, solution.modes[row]) {
            (Law::Unilateral, Mode::Active) => impulse(row),
            (Law::Unilateral, _) => {
                let (speed, noise) = division.drift(context, &rates, *source);
                let rests = speed.abs() <= noise;
                if rests { metric.remainder(row, solution.slacks[row]) } else { f64::INFINITY }
            }
            (Law::Friction { normal, mu }, Mode::Active) => {
                let bound = mu * solution.impulses[normal as usize].max(0.0);
                metric.impulse(row, bound) - impulse(row).abs()
            }
            (Law::Bounded { max }, Mode::Active) => metric.impulse(row, max) - impulse(row).abs(),
            _ => f64::INFINITY,
        };
        let relative = if scale > 0.0 { margin / scale } else { f64::INFINITY };
        all = least(all, (relative, *source));
    }
    all
}

/// How far two solutions of a problem are apart, relative to all that drives it.
fn apart(problem: &Lcp, one: &LcpSolution, other: &LcpSolution) -> f64 {
    let metric = Metric::new(problem);
    let mut worst = 0.0_f64;
    for (body, mass) in problem.mass.iter().enumerate() {
        let change: Vector3<f64> = one.velocities[body] - other.velocities[body];
        for (m, change) in mass.iter().zip(&change) {
            worst = worst.max(metric.momentum(m * change, *m).abs());
        }
    }
    let scale = drive(problem, &metric);
    if scale > 0.0 { worst / scale } else { 0.0 }
}
