//! What a gradient is by, how exact it is, and what it takes beside its time, which the
//! [race](crate::race) measures.

use tangency_core::{Param, Rollout, Scene, SceneDef, State, StepScratch, rollout_in, simulate};
use tangency_diff::{Gradient, RolloutVector, StateVector, gradient};

use crate::check::Check;
use crate::engine::{Engine as _, Refusal};
use crate::finite_difference::{Estimate, derivative};
use crate::memory;
use crate::own::Tangency;
use crate::race::GRADIENT_STEPS;
use crate::retelling::params;
use crate::scenes;
use crate::signature::signature;
use crate::timing::{Patience, Work, interleaved, timed};

/// A gradient by everything, of where the last body of a scene is after [`GRADIENT_STEPS`] steps.
#[derive(Clone, Debug)]
pub struct Study {
    /// The scene.
    pub scene: String,
    /// The engine.
    pub engine: String,
    /// Numbers of the scene, its initial state included, and controls.
    pub numbers: usize,
    /// How many of them were compared with differences.
    pub compared: usize,
    /// The worst of |g − d| / max(|d|, 1), d being the difference.
    pub error: f64,
}

/// Studies the scenes of the race that the engine is meant for, with `most` differences in each.
///
/// # Errors
/// A [`Refusal`] where a step has no answer or no derivative.
pub fn study(engine: &Tangency, most: usize) -> Result<Vec<Study>, Refusal> {
    let one = |def| {
        let run = Run::new(engine, engine.scene(&def)?)?;
        let (compared, error) = run.compare(most)?;
        let (scene, engine, numbers) = (def.name, engine.name(), run.inputs().len());
        Ok(Study { scene, engine, numbers, compared, error })
    };
    scenes::race_scenes().into_iter().filter(|def| engine.fits(def)).map(one).collect()
}

/// Steps of a tape that is weighed.
pub const TAPE_STEPS: usize = 300;

/// Tapes that are weighed together, twice.
const TAPES: usize = 16;

/// Memory of a tape of [`TAPE_STEPS`] steps, bytes, where the system tells: see
/// [`memory::per_copy`].
///
/// # Errors
/// A [`Refusal`] where the scene or a step is refused.
pub fn tape(engine: &Tangency, def: &SceneDef) -> Result<Option<f64>, Refusal> {
    let scene = engine.scene(def)?;
    memory::per_copy(TAPES, || Ok(simulate(&scene, &*engine.solver, TAPE_STEPS)?))
}

/// A number that the gradient is by.
#[derive(Clone, Copy, Debug)]
enum Input {
    /// Of the scene.
    Number(Param),
    /// Of the control of a step: its channel.
    Control(usize, usize),
}

/// A run whose last pose is differentiated.
struct Run<'a> {
    engine: &'a Tangency,
    scene: Scene,
    tape: Rollout,
}

impl<'a> Run<'a> {
    fn new(engine: &'a Tangency, scene: Scene) -> Result<Self, Refusal> {
        let tape = play(engine, &scene, None)?;
        Ok(Self { engine, scene, tape })
    }

    fn inputs(&self) -> Vec<Input> {
        let channels = self.scene.controls().len();
        let controls = (0..GRADIENT_STEPS).flat_map(|k| (0..channels).map(move |c| (k, c)));
        let controls = controls.map(|(k, channel)| Input::Control(k, channel));
        params(&self.scene).into_iter().map(Input::Number).chain(controls).collect()
    }

    /// How many numbers could be compared with differences, at most `most`, and the worst error.
    fn compare(&self, most: usize) -> Result<(usize, f64), Refusal> {
        let by = self.gradient()?.by;
        let inputs = self.inputs();
        let stride = inputs.len().div_ceil(most).max(1);
        let (mut compared, mut worst) = (0, 0.0_f64);
        for input in inputs.into_iter().step_by(stride) {
            if let Some(difference) = self.difference(input) {
                let error = (self.reverse(&by, input) - difference).abs();
                worst = worst.max(error / difference.abs().max(1.0));
                compared += 1;
            }
        }
        Ok((compared, worst))
    }

    fn gradient(&self) -> Result<Gradient, Refusal> {
        let seed = |k: usize, state: &State| {
            let mut bar = StateVector::like(state);
            bar.q.last_mut()?.fill(1.0);
            (k == GRADIENT_STEPS).then_some(bar)
        };
        Ok(gradient(&self.scene, &self.tape, seed)?)
    }

    fn reverse(&self, by: &RolloutVector, input: Input) -> f64 {
        match input {
            Input::Number(param) => by.by(&self.scene, param),
            Input::Control(k, channel) => by.controls[k][channel],
        }
    }

    /// The derivative by differences; `None` where they leave the range of the number, or cross a
    /// switch (a contact that is made a step later, say), so that there is none.
    fn difference(&self, input: Input) -> Option<f64> {
        let x = match input {
            Input::Number(param) => self.scene.get(param)?,
            Input::Control(..) => 0.0,
        };
        let at = |step: &f64| self.difference_at(input, x, step * x.abs().max(0.1));
        let found = STEPS.iter().filter_map(at);
        found.min_by(|a, b| a.error.total_cmp(&b.error)).map(|best| best.value)
    }

    fn difference_at(&self, input: Input, x: f64, step: f64) -> Option<Estimate> {
        let (modes, mut crossed) = (signature(&self.tape), false);
        let value = |x: f64| {
            if crossed {
                return f64::NAN;
            }
            let changed = self.changed(input, x).ok().filter(|run| signature(run) == modes);
            crossed = changed.is_none();
            changed.map_or(f64::NAN, |run| last_pose(&run))
        };
        let found = derivative(value, x, step);
        (!crossed).then_some(found)
    }

    /// The run with one number changed.
    fn changed(&self, input: Input, value: f64) -> Result<Rollout, Refusal> {
        match input {
            Input::Number(param) => {
                let mut scene = self.scene.clone();
                scene.set(param, value)?;
                play(self.engine, &scene, None)
            }
            Input::Control(k, channel) => play(self.engine, &self.scene, Some((k, channel, value))),
        }
    }
}

/// Steps of differences in parts of the number; the one that says the least error of itself counts.
const STEPS: [f64; 3] = [1e-3, 1e-4, 1e-5];

/// What is differentiated: x + y + θ of the last body at the end.
fn last_pose(run: &Rollout) -> f64 {
    run.last().q.last().map_or(0.0, nalgebra::Matrix::sum)
}

/// A run with all controls zero but one: step, channel, value.
fn play(
    engine: &Tangency,
    scene: &Scene,
    nudge: Option<(usize, usize, f64)>,
) -> Result<Rollout, Refusal> {
    let control = |k: usize, _: &State| {
        let mut control = vec![0.0; scene.controls().len()];
        if let Some((step, channel, value)) = nudge
            && step == k
        {
            control[channel] = value;
        }
        control
    };
    let (initial, mut scratch) = (scene.initial_state(), StepScratch::default());
    Ok(rollout_in(scene, &*engine.solver, initial, GRADIENT_STEPS, control, &mut scratch)?)
}

/// Links of the chain whose gradient is read by one number and by all.
const LINKS: usize = 100;

/// That value and gradient by all numbers of a long chain, more than a thousand, take no longer than by
/// one.
///
/// # Errors
/// A [`Refusal`] where a step has no answer or no derivative.
pub fn all_over_one(engine: &Tangency, patience: &Patience) -> Result<Check, Refusal> {
    let scene = engine.scene(&scenes::race_chain(LINKS))?;
    let all = params(&scene);
    let reads = [&all[..1], &all[..]].map(|numbers| {
        let work: Work<'_, Refusal> = Box::new(|| {
            let (time, sum) = timed(|| read(engine, &scene, numbers));
            std::hint::black_box(sum?);
            Ok(time)
        });
        work
    });
    let mut least = Vec::new();
    for time in interleaved(reads.into(), patience) {
        least.push(time?.least);
    }
    let what =
        format!("chain of {LINKS}: value and gradient by {} numbers over those by one", all.len());
    Ok(Check::at_most(what, least[1] / least[0], 1.1))
}

/// Plays, differentiates, and adds up some numbers of the gradient.
fn read(engine: &Tangency, scene: &Scene, numbers: &[Param]) -> Result<f64, Refusal> {
    let run = Run::new(engine, scene.clone())?;
    let by = run.gradient()?.by;
    Ok(numbers.iter().map(|number| by.by(scene, *number)).sum())
}
