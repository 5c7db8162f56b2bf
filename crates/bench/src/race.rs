//! Engines timed against each other on the same scenes.

use std::time::Duration;

use tangency_core::{Scene, SceneDef};

use crate::engine::{Engine, Refusal, World, is_finite};
use crate::paths::Paths;
use crate::scenes;
use crate::timing::{Patience, Quartiles, Work, interleaved, timed};

/// A scene of the race.
#[derive(Clone, Debug)]
pub struct Heat {
    /// What tables call it.
    pub name: String,
    /// Heats of one family only grow: an engine too slow for one is left out of the following ones.
    pub family: &'static str,
    /// The scene; its dt counts.
    pub def: SceneDef,
    /// Steps per run.
    pub steps: usize,
    /// Whether value and gradient are timed, too.
    pub gradient: bool,
}

/// Steps of a value and gradient.
pub const GRADIENT_STEPS: usize = 200;

impl Heat {
    fn new(family: &'static str, def: SceneDef, dt: f64, steps: usize) -> Self {
        let (name, def) = (def.name.clone(), SceneDef { dt, ..def });
        Self { name, family, def, steps, gradient: false }
    }
}

/// The heats: four small scenes at 5 ms and at 1/60 s, long chains and pyramids at 1/60 s.
#[must_use]
pub fn heats(longest_chain: usize, widest_pyramid: usize) -> Vec<Heat> {
    let small = || ["bounce", "stack", "chain", "cartpole"].into_iter().zip(scenes::race_scenes());
    let slow = 1.0 / 60.0;
    let fine = small().map(|(family, def)| {
        let heat = Heat::new(family, def, 0.005, 400);
        Heat { gradient: true, ..heat }
    });
    let coarse = small().map(|(family, def)| Heat::new(family, def, slow, 120));
    let lengths = [50, 200, 1000, 10_000].into_iter().filter(|n| *n <= longest_chain);
    let chains = lengths.map(|n| Heat::new("chain", scenes::race_chain(n), slow, 60));
    let bases = [10, 20].into_iter().filter(|base| *base <= widest_pyramid);
    let pyramids = bases.map(|base| {
        let heat = Heat::new("pyramid", scenes::pyramid(base), slow, 60);
        Heat { name: format!("pyramid of {}", base * (base + 1) / 2), ..heat }
    });
    fine.chain(coarse).chain(chains).chain(pyramids).collect()
}

/// What one engine did in one heat.
#[derive(Debug)]
pub struct Entry {
    /// The heat.
    pub heat: String,
    /// Its family.
    pub family: &'static str,
    /// Its dt, s.
    pub dt: f64,
    /// The engine.
    pub engine: String,
    /// Its result, or why there is none.
    pub result: Result<Performance, Refusal>,
}

/// Times and errors of a run.
#[derive(Clone, Copy, Debug)]
pub struct Performance {
    /// Steps per run; fewer than asked where the cap was reached.
    pub steps: usize,
    /// Time per step, s.
    pub step: Quartiles,
    /// Deepest penetration at every fifth step, m.
    pub penetration: f64,
    /// Largest joint error at every fifth step, m or rad.
    pub drift: f64,
    /// What the gradient of [`GRADIENT_STEPS`] steps costs.
    pub gradient: Gradient,
    /// Which ways the steps took, if the engine tells.
    pub paths: Option<Paths>,
}

/// What is known of an engine's gradient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Gradient {
    /// It was not asked for.
    NotAsked,
    /// The engine has none.
    None,
    /// The engine refused, or takes longer than the cap.
    Refused,
    /// Its cost.
    Known(GradientCost),
}

/// What a value and its gradient cost, and the value alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GradientCost {
    /// Time of the value alone, which keeps no record, s.
    pub value: Quartiles,
    /// Time of value and gradient, s.
    pub both: Quartiles,
}

impl GradientCost {
    /// Value and gradient over value.
    #[must_use]
    pub fn multiple(&self) -> f64 {
        self.both.least / self.value.least
    }
}

/// Runs all engines on a heat. `before` is what they did so far.
#[must_use]
pub fn race(
    heat: &Heat,
    engines: &[&dyn Engine],
    patience: &Patience,
    before: &[Entry],
) -> Vec<Entry> {
    let mut trials = Vec::new();
    for engine in engines {
        let seconds = slowest(heat, &engine.name(), before);
        trials.push(if seconds > patience.cap.as_secs_f64() {
            Err(Refusal::TooSlow { engine: engine.name(), seconds })
        } else {
            try_out(heat, *engine, patience)
        });
    }
    let again = |trial: &Result<Performance, Refusal>| {
        trial.as_ref().is_ok_and(|trial| trial.step.median < patience.cap.as_secs_f64())
    };
    let mut works: Vec<Work<'_, Refusal>> = Vec::new();
    for (engine, trial) in engines.iter().zip(&trials) {
        if let Ok(trial) = trial
            && again(&Ok(*trial))
        {
            works.push(forward(*engine, &heat.def, trial.steps));
        }
    }
    let mut times = interleaved(works, patience).into_iter();
    let finish = |(engine, trial): (&&dyn Engine, Result<Performance, Refusal>)| {
        let timed_again = again(&trial);
        let result = trial.and_then(|mut trial| {
            if timed_again && let Some(time) = times.next() {
                trial.step = time?.scaled(1.0 / trial.steps as f64);
            }
            if heat.gradient {
                trial.gradient = gradient_cost(*engine, &heat.def, patience);
            }
            Ok(trial)
        });
        let (family, engine) = (heat.family, engine.name());
        Entry { heat: heat.name.clone(), family, dt: heat.def.dt, engine, result }
    };
    engines.iter().zip(trials).map(finish).collect()
}

/// The longest time per step of an engine in earlier heats of the family, s.
fn slowest(heat: &Heat, engine: &str, before: &[Entry]) -> f64 {
    let mine = before.iter().filter(|e| e.family == heat.family && e.engine == engine);
    let seconds = mine.map(|entry| match &entry.result {
        Ok(done) => done.step.median,
        Err(Refusal::TooSlow { seconds, .. }) => *seconds,
        Err(_) => 0.0,
    });
    seconds.fold(0.0, f64::max)
}

/// The first run: warms up, measures errors, and finds how many steps fit under the cap.
fn try_out(heat: &Heat, engine: &dyn Engine, patience: &Patience) -> Result<Performance, Refusal> {
    let scene = Scene::new(&heat.def)?;
    let mut world = engine.build(&heat.def)?;
    let (mut penetration, mut drift) = (0.0_f64, 0.0_f64);
    let (mut spent, mut steps) = (Duration::ZERO, 0);
    while steps < heat.steps && spent < patience.cap {
        let (time, result) = timed(|| world.step());
        result?;
        spent += time;
        steps += 1;
        if steps % 5 == 0 || steps == 1 {
            let state = world.state();
            if !is_finite(&state) {
                return Err(Refusal::NotFinite { engine: engine.name(), steps });
            }
            penetration = penetration.max(scene.penetration(&state)?);
            drift = drift.max(scene.joint_drift(&state));
        }
    }
    let step = Quartiles::of(vec![spent.as_secs_f64() / steps as f64]);
    let (gradient, paths) = (Gradient::NotAsked, engine.paths(&heat.def, steps));
    Ok(Performance { steps, step, penetration, drift, gradient, paths })
}

/// A run of some steps from the start; building the world does not count.
fn forward<'a>(engine: &'a dyn Engine, def: &'a SceneDef, steps: usize) -> Work<'a, Refusal> {
    Box::new(move || {
        let mut world = engine.build(def)?;
        let (time, result) = timed(|| run(&mut *world, steps));
        result.map(|()| time)
    })
}

fn run(world: &mut dyn World, steps: usize) -> Result<(), Refusal> {
    (0..steps).try_for_each(|_| world.step())
}

/// Value and gradient against the value alone, which keeps no record.
fn gradient_cost(engine: &dyn Engine, def: &SceneDef, patience: &Patience) -> Gradient {
    let Ok(built) = engine.value_and_gradient(def, GRADIENT_STEPS) else {
        return Gradient::Refused;
    };
    let Some(mut both) = built else { return Gradient::None };
    let (first, tried) = timed(&mut both);
    if tried.is_err() || first > 4 * patience.cap {
        return Gradient::Refused;
    }
    let both: Work<'_, Refusal> = Box::new(move || {
        let (time, result) = timed(&mut both);
        result.map(|_| time)
    });
    let times = interleaved(vec![forward(engine, def, GRADIENT_STEPS), both], patience);
    match times[..] {
        [Ok(value), Ok(both)] => Gradient::Known(GradientCost { value, both }),
        _ => Gradient::Refused,
    }
}
