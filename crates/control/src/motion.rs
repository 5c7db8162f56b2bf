//! A motion forwards in time: controls, the steps they make, and what that costs.

use nalgebra::DVector;

use crate::backward::{Expanded, Policy};
use crate::cost::finite;
use crate::{ControlLimits, Cost, Dynamics, PlanError};

/// A motion of T steps.
pub(crate) struct Motion<D: Dynamics> {
    pub(crate) initial: D::State,
    /// T.
    pub(crate) steps: Vec<D::Step>,
    /// x, T + 1.
    pub(crate) states: Vec<DVector<f64>>,
    /// u, T.
    pub(crate) controls: Vec<DVector<f64>>,
    pub(crate) cost: f64,
}

impl<D: Dynamics> Motion<D> {
    /// The motion of a first guess.
    pub(crate) fn first(
        dynamics: &mut D,
        cost: &dyn Cost,
        initial: &D::State,
        controls: &[Vec<f64>],
    ) -> Result<Self, PlanError> {
        let mut motion = Self::begin(dynamics, initial);
        finite("a coordinate", 0, motion.states[0].iter())?;
        for (step, control) in controls.iter().enumerate() {
            let control = DVector::from_column_slice(control);
            motion
                .go_on(dynamics, cost, control)
                .map_err(|source| PlanError::Dynamics { step, source: source.into() })?;
            finite("a coordinate", step + 1, motion.last().iter())?;
            finite("the cost", step, std::iter::once(&motion.cost))?;
        }
        motion.cost += cost.last(motion.last());
        finite("the last cost", controls.len(), std::iter::once(&motion.cost))?;
        Ok(motion)
    }

    /// The motion of changed controls, u + α k + K (x − x̄) within the limits; `None` if a step fails
    /// or numbers overflow.
    pub(crate) fn changed(
        &self,
        dynamics: &mut D,
        cost: &dyn Cost,
        limits: &ControlLimits,
        policy: &Policy,
        alpha: f64,
    ) -> Option<Self> {
        let mut motion = Self::begin(dynamics, &self.initial);
        for (k, control) in self.controls.iter().enumerate() {
            let off = motion.last() - &self.states[k];
            let change = &policy.changes[k] * alpha + &policy.gains[k] * off;
            motion.go_on(dynamics, cost, limits.clamp(&(control + change))).ok()?;
        }
        motion.cost += cost.last(motion.last());
        let finite = motion.states.iter().flatten().all(|x| x.is_finite());
        (finite && motion.cost.is_finite()).then_some(motion)
    }

    /// Derivatives of all steps and their costs.
    pub(crate) fn expand(&self, dynamics: &D, cost: &dyn Cost) -> Result<Expanded, PlanError> {
        let (n, m) = (dynamics.states(), dynamics.controls());
        let (mut all, mut running) = (Vec::new(), Vec::new());
        for (step, control) in self.controls.iter().enumerate() {
            let before = self.state(dynamics, step);
            let by = dynamics
                .linearise(before, &self.steps[step])
                .map_err(|source| PlanError::Dynamics { step, source: source.into() })?;
            crate::cost::size("A of the dynamics", [n, n], by.state.shape())?;
            crate::cost::size("B of the dynamics", [n, m], by.control.shape())?;
            finite("a derivative of the dynamics", step, by.state.iter().chain(&by.control))?;
            all.push(by);
            let expansion = cost.running_expansion(step, &self.states[step], control);
            expansion.check(step, n, m)?;
            running.push(expansion);
        }
        let last = cost.last_expansion(self.last());
        last.check(self.steps.len(), n)?;
        Ok(Expanded { dynamics: all, running, last })
    }

    fn begin(dynamics: &D, initial: &D::State) -> Self {
        let states = vec![dynamics.coordinates(initial)];
        let (steps, controls) = (Vec::new(), Vec::new());
        Self { initial: initial.clone(), steps, states, controls, cost: 0.0 }
    }

    fn go_on(
        &mut self,
        dynamics: &mut D,
        cost: &dyn Cost,
        control: DVector<f64>,
    ) -> Result<(), D::Error> {
        let k = self.steps.len();
        let state = self.state(dynamics, k);
        let step = dynamics.step(state, self.steps.last(), control.as_slice())?;
        self.cost += cost.running(k, self.last(), &control);
        self.states.push(dynamics.coordinates(dynamics.after(&step)));
        self.steps.push(step);
        self.controls.push(control);
        Ok(())
    }

    /// The state before step k.
    fn state<'a>(&'a self, dynamics: &D, k: usize) -> &'a D::State {
        if k == 0 { &self.initial } else { dynamics.after(&self.steps[k - 1]) }
    }

    fn last(&self) -> &DVector<f64> {
        &self.states[self.states.len() - 1]
    }
}
