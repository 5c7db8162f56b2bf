//! A loss as a function of some parameters of a scene, with its derivatives.

use std::time::{Duration, Instant};

use nalgebra::{DMatrix, DVector};
use tangency::control::Residuals;
use tangency::diff::{GradientReport, Parameter, tangent};
use tangency::lcp::LcpSolver;
use tangency::{GradientMode, Rollout, Scene, State, simulate};

use crate::Failure;
use crate::loss::Loss;
use crate::observations::Observations;
use crate::tape::Tape;

/// A loss over a rollout of a scene, as a function of parameters.
pub struct Objective<'a> {
    /// The scene; parameters that are not learned keep its values.
    pub scene: &'a Scene,
    /// What varies.
    pub parameters: &'a [Parameter],
    /// The solver of the steps.
    pub solver: &'a dyn LcpSolver,
    /// Steps of the rollout.
    pub steps: usize,
    /// Whether few records are kept for the gradient, and the others made again.
    pub checkpoints: bool,
    /// How it is differentiated.
    pub mode: GradientMode,
}

/// A loss with its gradient at some values of the parameters.
#[derive(Clone, Debug, Default)]
pub struct Evaluation {
    /// The loss.
    pub loss: f64,
    /// By the parameters.
    pub gradient: Vec<f64>,
    /// Where it is one-sided.
    pub report: GradientReport,
    /// Worst residual of the steps.
    pub residual: f64,
    /// Time of the rollout.
    pub forward: Duration,
    /// Time of the reverse pass.
    pub reverse: Duration,
}

impl Objective<'_> {
    /// The scene with these values.
    ///
    /// # Errors
    /// A value out of range.
    pub fn scene_at(&self, values: &[f64]) -> Result<Scene, Failure> {
        let mut scene = self.scene.clone();
        for (parameter, value) in self.parameters.iter().zip(values) {
            parameter
                .set(&mut scene, *value)
                .map_err(|source| Failure::Value { name: parameter.name.clone(), source })?;
        }
        Ok(scene)
    }

    /// The values that the scene has.
    #[must_use]
    pub fn values(&self) -> Vec<f64> {
        self.parameters.iter().map(|parameter| parameter.value(self.scene)).collect()
    }

    /// The motion with these values.
    ///
    /// # Errors
    /// A value out of range, or a step that failed.
    pub fn rollout(&self, values: &[f64]) -> Result<(Scene, Rollout), Failure> {
        let scene = self.scene_at(values)?;
        let rollout = simulate(&scene, self.solver, self.steps)?;
        Ok((scene, rollout))
    }

    /// The loss alone.
    ///
    /// # Errors
    /// As [`Objective::rollout`].
    pub fn value(&self, loss: &Loss, values: &[f64]) -> Result<f64, Failure> {
        let (_, rollout) = self.rollout(values)?;
        Ok(loss.value(&rollout.states().collect::<Vec<_>>(), rollout.records.last()))
    }

    /// The loss and its gradient in reverse mode.
    ///
    /// # Errors
    /// As [`Objective::rollout`], or an adjoint that could not be taken.
    pub fn evaluate(&self, loss: &Loss, values: &[f64]) -> Result<Evaluation, Failure> {
        let start = Instant::now();
        let scene = self.scene_at(values)?;
        let record = if self.checkpoints { Tape::sparse } else { Tape::full };
        let mut tape = record(&scene, self.solver, self.steps)?;
        let forward = start.elapsed();
        let start = Instant::now();
        let last = tape.last_record(&scene, self.solver)?;
        let seeds = loss.seeds(&tape.states(), last.as_ref());
        let found = tape.gradient(&scene, self.solver, self.mode, &seeds)?;
        let states = tape.states();
        let by = |parameter: &Parameter| parameter.gradient(&scene, &found.by);
        let gradient = self.parameters.iter().map(by).collect();
        let reverse = start.elapsed();
        let (loss, residual) = (loss.value(&states, last.as_ref()), tape.residual());
        Ok(Evaluation { loss, gradient, report: found.report, residual, forward, reverse })
    }

    /// Residuals of an observed motion with their derivatives, in forward mode.
    ///
    /// # Errors
    /// As [`Objective::evaluate`].
    pub fn linearise(&self, observed: &Observations, values: &[f64]) -> Result<Residuals, Failure> {
        let (scene, mut rollout) = self.rollout(values)?;
        self.mode.prepare(&mut rollout)?;
        let states: Vec<&State> = rollout.states().collect();
        let residuals = observed.scaled_residuals(&states);
        let mut jacobian = DMatrix::zeros(residuals.len(), self.parameters.len());
        for (parameter, mut column) in self.parameters.iter().zip(jacobian.column_iter_mut()) {
            let along = parameter.direction(&scene, self.steps);
            let changes = observed.scaled_changes(&states, &tangent(&scene, &rollout, &along)?);
            column.copy_from_slice(&changes);
        }
        Ok(Residuals { values: DVector::from_vec(residuals), jacobian })
    }

    /// The same with fewer steps.
    #[must_use]
    pub fn shortened(&self, steps: usize) -> Self {
        Self { steps: steps.min(self.steps), ..*self }
    }
}
