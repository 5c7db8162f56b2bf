//! Where a case runs scenes on one backend and writes down what it measures.

use tangency_core::{
    Rollout, Scene, SceneDef, State, StepError, StepRecord, StepScratch, Stepping, rollout, step,
};
use tangency_diff::StateVector;
use tangency_lcp::{LcpSolver, RawSolver};

use crate::run::{Direction, Run, Slope};
use crate::{Backend, Figure, Grade, Relation, Stop, Tally, Verdict};

/// One backend at one case: runs, and the figures so far.
pub struct Lab<'a> {
    /// The backend.
    pub backend: &'a Backend,
    /// The figures so far.
    pub figures: Vec<Figure>,
    /// What the steps so far took.
    pub tally: Tally,
    case: &'static str,
}

/// The most accurate stepping that the engine has, in steps of a millisecond.
#[must_use]
pub fn recommended(def: SceneDef) -> SceneDef {
    SceneDef { dt: 1e-3, stepping: Stepping::Accurate { max_events: 32 }, ..def }
}

/// Steps of dt that are divided at impacts, so that derivatives are those of the motion.
#[must_use]
pub(crate) fn resolved(def: SceneDef, dt: f64) -> SceneDef {
    SceneDef { dt, stepping: Stepping::ImpactResolved { max_impacts: 8 }, ..def }
}

/// Number of steps of a duration.
#[must_use]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "durations are short")]
pub(crate) fn steps(duration: f64, dt: f64) -> usize {
    (duration / dt).round() as usize
}

impl<'a> Lab<'a> {
    /// A lab without figures.
    #[must_use]
    pub fn new(backend: &'a Backend, case: &'static str) -> Self {
        Self { backend, figures: Vec::new(), tally: Tally::default(), case }
    }

    /// The backend's solver.
    #[must_use]
    pub fn solver(&self) -> &'a dyn LcpSolver {
        &*self.backend.solver
    }

    /// The backend's solver of raw problems.
    #[must_use]
    pub fn raw(&self) -> &'a dyn RawSolver {
        &*self.backend.raw
    }

    /// Runs a definition from its own initial state with all controls zero.
    ///
    /// # Errors
    /// [`Stop`] where the scene or a step is refused.
    pub fn run(&mut self, def: &SceneDef, duration: f64) -> Result<Run, Stop> {
        self.run_steps(def, steps(duration, def.dt))
    }

    /// The same for a number of steps.
    ///
    /// # Errors
    /// [`Stop`] where the scene or a step is refused.
    pub fn run_steps(&mut self, def: &SceneDef, count: usize) -> Result<Run, Stop> {
        self.run_driven(def, &vec![vec![0.0; def.controls.len()]; count])
    }

    /// The same with the control of every step.
    ///
    /// # Errors
    /// [`Stop`] where the scene or a step is refused.
    pub fn run_driven(&mut self, def: &SceneDef, controls: &[Vec<f64>]) -> Result<Run, Stop> {
        let scene = Scene::new(def)?;
        let control = |k: usize, _: &State| controls[k].clone();
        let count = controls.len();
        let result = rollout(&scene, self.solver(), scene.initial_state(), count, control);
        let tape: Rollout = self.counted(result)?;
        tape.records.iter().for_each(|record| self.tally.add_step(record));
        Ok(Run { scene, tape })
    }

    /// Runs a scene without control channels and keeps no record; `see` is shown each.
    ///
    /// # Errors
    /// [`Stop`] where the scene or a step is refused.
    pub fn watch(
        &mut self,
        def: &SceneDef,
        count: usize,
        mut see: impl FnMut(&Scene, &StepRecord),
    ) -> Result<State, Stop> {
        let scene = Scene::new(def)?;
        let (mut state, mut scratch) = (scene.initial_state(), StepScratch::default());
        for _ in 0..count {
            let result = step(&scene, self.solver(), &state, &[], &mut scratch);
            let record = self.counted(result)?;
            self.tally.add_step(&record);
            see(&scene, &record);
            state = record.after;
        }
        Ok(state)
    }

    /// The first step of a definition.
    ///
    /// # Errors
    /// [`Stop`] where the scene or the step is refused.
    pub fn first_step(&mut self, def: &SceneDef) -> Result<StepRecord, Stop> {
        Ok(self.run_steps(def, 1)?.tape.records.remove(0))
    }

    fn counted<T>(&mut self, result: Result<T, StepError>) -> Result<T, Stop> {
        self.tally.refused += usize::from(result.is_err());
        Ok(result?)
    }

    /// |got − expected| ≤ tolerance, by plain stepping.
    pub fn near(&mut self, quantity: impl Into<String>, got: f64, expected: f64, tolerance: f64) {
        self.figure(quantity, Grade::Step, Relation::Near, [got, expected, tolerance]);
    }

    /// |got − expected| ≤ tolerance · |expected|, by plain stepping.
    pub fn relative(&mut self, quantity: impl Into<String>, got: f64, expected: f64, part: f64) {
        self.near(quantity, got, expected, part * expected.abs());
    }

    /// |got − expected| ≤ tolerance, by the recommended stepping.
    pub fn fine(&mut self, quantity: impl Into<String>, got: f64, expected: f64, tolerance: f64) {
        self.figure(quantity, Grade::Fine, Relation::Near, [got, expected, tolerance]);
    }

    /// A derivative of the motion to `part` of the expected one, or to `part` where that is zero, by the
    /// recommended stepping.
    pub fn fine_slope(&mut self, quantity: impl Into<String>, got: f64, expected: f64, part: f64) {
        let tolerance = if expected == 0.0 { part } else { part * expected.abs() };
        self.figure(quantity, Grade::Fine, Relation::Near, [got, expected, tolerance]);
    }

    /// A derivative through an impact.
    pub fn impact(&mut self, quantity: impl Into<String>, got: f64, expected: f64, tolerance: f64) {
        self.figure(quantity, Grade::Impact, Relation::Near, [got, expected, tolerance]);
    }

    /// got ≥ least, by plain stepping.
    pub fn at_least(&mut self, quantity: impl Into<String>, got: f64, least: f64) {
        self.figure(quantity, Grade::Step, Relation::AtLeast, [got, least, 0.0]);
    }

    /// got ≤ most, by plain stepping.
    pub fn at_most(&mut self, quantity: impl Into<String>, got: f64, most: f64) {
        self.figure(quantity, Grade::Step, Relation::AtMost, [got, most, 0.0]);
    }

    /// A statement that plain stepping must make true.
    pub fn holds(&mut self, quantity: impl Into<String>, truth: bool) {
        self.near(quantity, f64::from(u8::from(truth)), 1.0, 0.0);
    }

    /// A judged number.
    pub fn figure(
        &mut self,
        quantity: impl Into<String>,
        grade: Grade,
        relation: Relation,
        numbers: [f64; 3],
    ) {
        self.figures.push(Figure::new(self.case, quantity.into(), grade, relation, numbers));
    }

    /// The backend said that the problem is not of its class.
    pub fn refused(&mut self, quantity: impl Into<String>, note: &dyn std::fmt::Display) {
        let (grade, verdict) = (Grade::Step, Verdict::Refused);
        let note = note.to_string();
        self.figures.push(Figure::missing(self.case, quantity.into(), grade, verdict, note));
    }

    /// A part that ended early.
    pub(crate) fn stopped(&mut self, part: &str, stop: &Stop) {
        let (grade, verdict) = (Grade::Step, Verdict::Failed);
        let note = stop.to_string();
        self.figures.push(Figure::missing(self.case, part.into(), grade, verdict, note));
    }

    /// Order of convergence: the slope of log error on log dt over 8, 4, 2, 1 ms is at least
    /// `least`.
    ///
    /// # Errors
    /// What `error` reports.
    pub fn order(
        &mut self,
        quantity: &str,
        least: f64,
        mut error: impl FnMut(&mut Self, f64) -> Result<f64, Stop>,
    ) -> Result<(), Stop> {
        let mut points = [(0.0, 0.0); 4];
        for (point, dt) in points.iter_mut().zip([8e-3, 4e-3, 2e-3, 1e-3_f64]) {
            *point = (dt.ln(), error(self, dt)?.abs().ln());
        }
        let mean = |f: fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / 4.0;
        let (x, y) = (mean(|p| p.0), mean(|p| p.1));
        let cross: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
        let square: f64 = points.iter().map(|p| (p.0 - x).powi(2)).sum();
        self.at_least(format!("order of {quantity}"), cross / square, least);
        Ok(())
    }

    /// The derivative along a direction. Forward and reverse mode both take it and must agree.
    ///
    /// # Errors
    /// [`Stop`] where a step has no derivative.
    pub fn slope(
        &mut self,
        run: &Run,
        seed: &StateVector,
        direction: Direction<'_>,
    ) -> Result<f64, Stop> {
        let reverse = run.slope(seed, direction)?;
        let forward = run.tangent(direction)?.last().map_or(0.0, |change| change.dot(seed));
        let scale = reverse.abs().max(forward.abs()).max(1.0);
        let apart = (forward - reverse).abs();
        if apart.is_nan() || apart > 1e-10 * scale {
            let name = format!("forward and reverse mode along {:?}", direction[0].0);
            self.near(name, forward, reverse, 1e-10 * scale);
        }
        Ok(reverse)
    }

    /// Derivatives of a number of the last state where plain stepping converges: by steps of a
    /// millisecond within 2e-2, or 1e-9 where nothing changes, and by the recommended stepping within
    /// `part`.
    ///
    /// # Errors
    /// [`Stop`] where a step has no derivative.
    pub(crate) fn slopes(
        &mut self,
        what: &str,
        (def, duration): (&SceneDef, f64),
        pick: impl Fn(&mut StateVector),
        entries: &[Slope<'_>],
        part: f64,
    ) -> Result<(), Stop> {
        let plain = self.run(&SceneDef { dt: 1e-3, ..def.clone() }, duration)?;
        let fine = self.run(&recommended(def.clone()), duration)?;
        let seed = plain.pick(pick);
        for (by, direction, exact) in entries {
            let tolerance = if *exact == 0.0 { 1e-9 } else { 2e-2 * exact.abs() };
            let found = self.slope(&plain, &seed, direction)?;
            self.near(format!("d/d{by} of {what}"), found, *exact, tolerance);
            let found = self.slope(&fine, &seed, direction)?;
            self.fine_slope(format!("d/d{by} of {what}, exact"), found, *exact, part);
        }
        Ok(())
    }
}
