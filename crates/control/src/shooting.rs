//! The cost of a scene's motion as a function of its controls and numbers.

use nalgebra::DVector;
use tangency_core::{Rollout, Scene, SceneError, State, StepError, rollout};
use tangency_diff::{Coordinates, DiffError, Parameter, gradient};
use tangency_lcp::LcpSolver;

use crate::objective::{Objective, Slope};
use crate::{Bounds, ControlLimits, Cost};

/// The cost of a motion as a function of numbers of the scene and of the controls.
///
/// A point has the value of each parameter (such as a velocity at the start), then m numbers for each
/// of the steps: the controls. Its gradient is found in reverse mode, at a price that does not depend on
/// how many numbers these are.
pub struct Shooting<'a> {
    /// The scene; what is not a parameter stays as it is.
    pub scene: &'a Scene,
    /// The solver of its steps.
    pub solver: &'a dyn LcpSolver,
    /// Numbers that vary besides the controls.
    pub parameters: &'a [Parameter],
    /// What the motion costs; its states are in the order of [`Coordinates`].
    pub cost: &'a dyn Cost,
    /// T, how many steps.
    pub steps: usize,
}

/// Why a motion could not be taken or differentiated.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ShootingError {
    /// More or fewer numbers than there are parameters and controls.
    #[error("{found} numbers, expected {expected}: one per parameter and per control of each step")]
    Size {
        /// One per parameter and per control of each step.
        expected: usize,
        /// How many there were.
        found: usize,
    },
    /// A value that a parameter cannot have.
    #[error("{name} cannot be {value}")]
    Parameter {
        /// Its name.
        name: String,
        /// The value.
        value: f64,
        /// Why.
        source: SceneError,
    },
    /// A step.
    #[error(transparent)]
    Step(#[from] StepError),
    /// A derivative.
    #[error(transparent)]
    Derivative(#[from] DiffError),
}

impl Shooting<'_> {
    /// How many numbers a point has.
    #[must_use]
    pub fn size(&self) -> usize {
        self.parameters.len() + self.steps * self.scene.controls().len()
    }

    /// The values that the parameters have, and so many zeros as there are controls.
    #[must_use]
    pub fn start(&self) -> Vec<f64> {
        let mut point: Vec<f64> = self.parameters.iter().map(|p| p.value(self.scene)).collect();
        point.resize(self.size(), 0.0);
        point
    }

    /// Bounds of a point: none for parameters, the limits for controls.
    #[must_use]
    pub fn bounds(&self, limits: &ControlLimits) -> Vec<Bounds> {
        let pairs = limits.lower().iter().zip(limits.upper());
        let step: Vec<Bounds> = pairs.map(|(l, u)| Bounds { lower: *l, upper: *u }).collect();
        let controls = std::iter::repeat_n(step, self.steps).flatten();
        self.parameters.iter().map(|_| Bounds::FREE).chain(controls).collect()
    }

    /// The controls at a point, m numbers per step.
    #[must_use]
    pub fn controls(&self, point: &[f64]) -> Vec<Vec<f64>> {
        let (all, m) = (&point[self.parameters.len()..], self.scene.controls().len());
        (0..self.steps).map(|k| all[k * m..(k + 1) * m].to_vec()).collect()
    }

    /// The scene and its motion at a point.
    ///
    /// # Errors
    /// A [`ShootingError`].
    pub fn motion(&self, point: &[f64]) -> Result<(Scene, Rollout), ShootingError> {
        let (expected, found) = (self.size(), point.len());
        if expected != found {
            return Err(ShootingError::Size { expected, found });
        }
        let mut scene = self.scene.clone();
        for (parameter, &value) in self.parameters.iter().zip(point) {
            let name = || parameter.name.clone();
            parameter.set(&mut scene, value).map_err(|source| ShootingError::Parameter {
                name: name(),
                value,
                source,
            })?;
        }
        let controls = self.controls(point);
        let initial = scene.initial_state();
        let control = |k: usize, _: &State| controls[k].clone();
        let motion = rollout(&scene, self.solver, initial, self.steps, control)?;
        Ok((scene, motion))
    }
}

impl Objective for Shooting<'_> {
    type Error = ShootingError;

    fn evaluate(&mut self, point: &[f64]) -> Result<Slope, ShootingError> {
        let (scene, motion) = self.motion(point)?;
        let (order, steps) = (Coordinates::of(&scene), self.steps);
        let controls: Vec<_> = self.controls(point).into_iter().map(DVector::from_vec).collect();
        let mut loss = self.cost.last(&order.of_state(motion.last()));
        let mut by_controls = Vec::with_capacity(point.len());
        let mut seeds = Vec::with_capacity(steps + 1);
        for (k, u) in controls.iter().enumerate() {
            let x = order.of_state(motion.state(k));
            loss += self.cost.running(k, &x, u);
            let slopes = self.cost.running_expansion(k, &x, u);
            seeds.push(slopes.x);
            by_controls.extend_from_slice(slopes.u.as_slice());
        }
        seeds.push(self.cost.last_expansion(&order.of_state(motion.last())).x);
        let found = gradient(&scene, &motion, |k, _| Some(order.spread(seeds[k].as_view())))?.by;
        for (total, through) in by_controls.iter_mut().zip(found.controls.iter().flatten()) {
            *total += through;
        }
        let by_parameters = self.parameters.iter().map(|p| p.gradient(&scene, &found));
        Ok(Slope { loss, gradient: by_parameters.chain(by_controls).collect() })
    }
}
