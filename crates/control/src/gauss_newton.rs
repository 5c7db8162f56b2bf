//! Gauss–Newton with Levenberg and Marquardt's damping.

#![expect(non_snake_case, reason = "matrices carry their usual names")]

use nalgebra::{DMatrix, DVector};

use crate::Bounds;
use crate::bounds::Chart;
use crate::objective::{Iterate, LeastSquares, Residuals, SearchError, Watch, check_start, push};

/// (JᵀJ + μ diag JᵀJ) Δz = −Jᵀr, μ small while that works (Levenberg 1944, Marquardt 1963), in
/// coordinates z in which no bound is ever met (see [`Bounds`]).
///
/// argmin's own inverts JᵀJ, knows no damping, and stops at a trial that fails.
#[derive(Clone, Debug, PartialEq)]
pub struct GaussNewton {
    /// Bounds, one per number.
    pub bounds: Vec<Bounds>,
    /// Most iterations.
    pub iterations: usize,
}

/// Moves of the coordinates below this end the search.
const SMALLEST_MOVE: f64 = 1e-14;
/// Numbers that residuals see less than this, relative to others, are damped as if they did.
const LEAST_SEEN: f64 = 1e-2;
/// Greatest move of a coordinate in one update.
const GREATEST_MOVE: f64 = 1.0;
/// Where the damping starts, how it changes, and where it is given up.
const DAMPING: [f64; 3] = [1e-2, 10.0, 1e12];

impl GaussNewton {
    /// For so many numbers without bounds, 100 iterations.
    #[must_use]
    pub fn unbounded(numbers: usize) -> Self {
        Self { bounds: vec![Bounds::FREE; numbers], iterations: 100 }
    }

    /// The points from `start` on, the start first: each better than those before it. The last may be
    /// there twice, where nothing better was found.
    ///
    /// # Errors
    /// A [`SearchError`] where it cannot begin.
    pub fn minimise<O: LeastSquares>(
        &self,
        objective: &mut O,
        start: &[f64],
        watch: Watch<'_>,
    ) -> Result<Vec<Iterate>, SearchError<O::Error>> {
        let residuals = objective.linearise(start)?;
        check_start(&self.bounds, start)?;
        let chart = Chart(&self.bounds);
        let z = DVector::from_vec(chart.coordinates(start));
        let mut trace = Vec::new();
        push(&mut trace, start.to_vec(), residuals.loss(), watch);
        let mut search = Search { chart, z, residuals, damping: DAMPING[0] };
        for _ in 0..self.iterations {
            let moved = search.advance(objective);
            let point =
                if moved.is_some() { search.point() } else { trace[trace.len() - 1].point.clone() };
            push(&mut trace, point, search.residuals.loss(), watch);
            if moved.is_none_or(|distance| distance < SMALLEST_MOVE) {
                break;
            }
        }
        Ok(trace)
    }
}

/// Where the search is.
struct Search<'a> {
    chart: Chart<'a>,
    z: DVector<f64>,
    residuals: Residuals,
    damping: f64,
}

impl Search<'_> {
    fn point(&self) -> Vec<f64> {
        self.chart.values(self.z.as_slice())
    }

    /// Goes to a better point; how far it is in coordinates, or `None` if there is none.
    fn advance(&mut self, objective: &mut impl LeastSquares) -> Option<f64> {
        let [_, factor, hopeless] = DAMPING;
        let slopes = DVector::from_vec(self.chart.slopes(self.z.as_slice()));
        let J = &self.residuals.jacobian * DMatrix::from_diagonal(&slopes);
        let (A, g) = (J.tr_mul(&J), J.tr_mul(&self.residuals.values));
        while self.damping < hopeless {
            let step = damped_step(&A, &g, self.damping)?;
            let (distance, z) = (step.amax(), &self.z + &step);
            match objective.linearise(&self.chart.values(z.as_slice())) {
                Ok(residuals) if residuals.loss() < self.residuals.loss() => {
                    self.damping /= factor;
                    (self.z, self.residuals) = (z, residuals);
                    return Some(distance);
                }
                _ if distance < SMALLEST_MOVE => return None,
                _ => self.damping *= factor,
            }
        }
        None
    }
}

/// −(A + μ diag A)⁻¹ g, shortened to the greatest move; `None` if nothing depends on anything.
fn damped_step(A: &DMatrix<f64>, g: &DVector<f64>, damping: f64) -> Option<DVector<f64>> {
    let greatest = A.diagonal().amax();
    if greatest == 0.0 {
        return None;
    }
    // What the residuals hardly see stays where it is.
    let diagonal = A.diagonal().map(|a| damping * a.max(LEAST_SEEN * greatest));
    let step = -(A + DMatrix::from_diagonal(&diagonal)).cholesky()?.solve(g);
    let longest = step.amax();
    Some(if longest > GREATEST_MOVE { step * (GREATEST_MOVE / longest) } else { step })
}
