//! The iteration: expand, solve backwards, step forwards.

use crate::backward::{Expanded, Policy};
use crate::motion::Motion;
use crate::regularisation::Regularisation;
use crate::{ControlLimits, Cost, Dynamics, Ending, Plan, PlanError};

/// Iterative LQR within limits; its settings.
#[derive(Clone, Debug, PartialEq)]
pub struct Planner {
    /// Most iterations.
    pub max_iterations: usize,
    /// A promised or achieved decrease of less than this part of the cost ends the search.
    pub tolerance: f64,
    /// Part of the promised decrease that a step must bring.
    pub least_success: f64,
    /// How often a step is halved before it is given up.
    pub halvings: u32,
    /// Least addition to the Hessians by the control but none, cost per squared control.
    pub least_regularisation: f64,
    /// Greatest addition.
    pub greatest_regularisation: f64,
    /// How fast the factor of the addition grows or shrinks.
    pub regularisation_factor: f64,
}

impl Default for Planner {
    fn default() -> Self {
        Self {
            max_iterations: 500,
            tolerance: 1e-9,
            least_success: 1e-4,
            halvings: 12,
            least_regularisation: 1e-6,
            greatest_regularisation: 1e10,
            regularisation_factor: 1.6,
        }
    }
}

impl Planner {
    /// Plans from `initial`, beginning with `controls`: T of m numbers within `limits`. T and what can
    /// be reached in it are the caller's.
    ///
    /// # Errors
    /// A [`PlanError`]: input that does not fit, a first guess that cannot be followed, or
    /// [`PlanError::Iterations`] and [`PlanError::Stuck`] with the best plan so far.
    pub fn plan<D: Dynamics>(
        &self,
        dynamics: &mut D,
        cost: &dyn Cost,
        limits: &ControlLimits,
        initial: &D::State,
        controls: &[Vec<f64>],
    ) -> Result<Plan, PlanError> {
        self.check()?;
        let (n, m) = (dynamics.states(), dynamics.controls());
        cost.check(n, m)?;
        crate::cost::size("the limits of the control", [m, 1], limits.lower().shape())?;
        for (step, control) in controls.iter().enumerate() {
            limits.check(step, control)?;
        }
        let motion = Motion::first(dynamics, cost, initial, controls)?;
        let regularisation = Regularisation::new(self);
        let history = vec![motion.cost];
        Search {
            planner: self,
            dynamics,
            cost,
            limits,
            motion,
            regularisation,
            failed: false,
            history,
        }
        .run()
    }

    fn check(&self) -> Result<(), PlanError> {
        let positive = "give a positive number";
        let above_one = "give a number above 1";
        let part = "give a number in [0, 1)";
        let Self { tolerance, least_success, regularisation_factor, .. } = *self;
        let (least, greatest) = (self.least_regularisation, self.greatest_regularisation);
        let rules = [
            ("tolerance", tolerance, (0.0..1.0).contains(&tolerance), part),
            ("least_success", least_success, (0.0..1.0).contains(&least_success), part),
            ("least_regularisation", least, least > 0.0 && least.is_finite(), positive),
            ("greatest_regularisation", greatest, greatest > least, "give more than the least"),
            (
                "regularisation_factor",
                regularisation_factor,
                regularisation_factor > 1.0 && regularisation_factor.is_finite(),
                above_one,
            ),
        ];
        match rules.into_iter().find(|(_, _, good, _)| !good) {
            None => Ok(()),
            Some((field, value, _, expected)) => Err(PlanError::Setting { field, value, expected }),
        }
    }
}

/// A search on its way.
struct Search<'a, D: Dynamics> {
    planner: &'a Planner,
    dynamics: &'a mut D,
    cost: &'a dyn Cost,
    limits: &'a ControlLimits,
    motion: Motion<D>,
    regularisation: Regularisation,
    /// Whether a step from this motion has failed.
    failed: bool,
    history: Vec<f64>,
}

impl<D: Dynamics> Search<'_, D> {
    fn run(mut self) -> Result<Plan, PlanError> {
        let mut expanded = self.motion.expand(self.dynamics, self.cost)?;
        let (mut best, mut promised) = (None, f64::INFINITY);
        for iteration in 0..self.planner.max_iterations {
            let least = self.regularisation.lambda();
            let Some(policy) = self.policy(&expanded) else {
                return Err(self.stuck(best, iteration, promised));
            };
            promised = policy.promise(1.0);
            if promised <= self.small() {
                let needed = self.regularisation.lambda() > least;
                if needed || least == 0.0 {
                    return Ok(self.into_plan(Some(policy), iteration, Some(Ending::Optimal)));
                }
                if self.failed {
                    return Err(self.stuck(Some(policy), iteration, promised));
                }
                // It may be the addition that keeps the promise small.
                self.regularisation.lower();
                best = Some(policy);
                continue;
            }
            match self.improved(&policy) {
                Some(motion) => {
                    let decrease = self.motion.cost - motion.cost;
                    self.accept(motion);
                    if decrease <= self.small() && self.regularisation.lambda() == 0.0 {
                        let ending = Some(Ending::Settled);
                        return Ok(self.into_plan(Some(policy), iteration + 1, ending));
                    }
                    expanded = self.motion.expand(self.dynamics, self.cost)?;
                }
                None if self.regularisation.raise() => self.failed = true,
                None => return Err(self.stuck(Some(policy), iteration + 1, promised)),
            }
            best = Some(policy);
        }
        let iterations = self.planner.max_iterations;
        let plan = Box::new(self.into_plan(best, iterations, None));
        Err(PlanError::Iterations { iterations, promised, plan })
    }

    fn stuck(self, policy: Option<Policy>, iterations: usize, promised: f64) -> PlanError {
        let plan = Box::new(self.into_plan(policy, iterations, None));
        PlanError::Stuck { iterations, promised, plan }
    }

    /// A decrease that is not worth a step.
    fn small(&self) -> f64 {
        self.planner.tolerance * self.motion.cost.abs()
    }

    /// The best change, with as much regularisation as it needs; `None` if no amount helps.
    fn policy(&mut self, expanded: &Expanded) -> Option<Policy> {
        loop {
            let lambda = self.regularisation.lambda();
            let found = expanded.policy(&self.motion.controls, self.limits, lambda);
            if found.is_some() {
                return found;
            }
            if !self.regularisation.raise() {
                return None;
            }
        }
    }

    /// The motion of the longest change that brings what it promises.
    fn improved(&mut self, policy: &Policy) -> Option<Motion<D>> {
        let lengths = (0..=self.planner.halvings).map(|halvings| 0.5_f64.powf(f64::from(halvings)));
        for alpha in lengths {
            let (motion, cost, limits) = (&self.motion, self.cost, self.limits);
            let Some(next) = motion.changed(self.dynamics, cost, limits, policy, alpha) else {
                continue;
            };
            let least = self.planner.least_success * policy.promise(alpha);
            if motion.cost - next.cost >= least.max(0.0) {
                return Some(next);
            }
        }
        None
    }

    fn accept(&mut self, motion: Motion<D>) {
        self.motion = motion;
        self.failed = false;
        self.history.push(self.motion.cost);
        self.regularisation.lower();
    }

    fn into_plan(self, policy: Option<Policy>, iterations: usize, ending: Option<Ending>) -> Plan {
        let Motion { states, controls, cost, .. } = self.motion;
        Plan {
            controls: controls.iter().map(|u| u.as_slice().to_vec()).collect(),
            states,
            gains: policy.map(|policy| policy.gains).unwrap_or_default(),
            limits: self.limits.clone(),
            cost,
            history: self.history,
            iterations,
            ending,
        }
    }
}
