//! Time against error: each case is run with ever shorter steps and compared with what is known.
//!
//! Errors are the worst over the case's bodies and sample times:
//!
//! ```text
//!  position   |x − x*| / length        angle   |θ − θ*|, but for whole turns
//!  velocity   max(|v − v*|, length |ω − ω*|) / speed
//!  energy     |E − E*| / energy        gap     deepest penetration / length
//! ```

mod case;
mod known;
mod motion;

use std::f64::consts::TAU;
use std::time::Duration;

pub use case::{Case, cases};
pub use known::Known;

use tangency_core::{Scene, SceneDef, State};

use crate::engine::{Engine, Refusal, is_finite};
use crate::paths::Paths;
use crate::timing::{Patience, Quartiles, Work, interleaved, timed};

/// One run of a case: an engine at a dt.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Time step, s.
    pub dt: f64,
    /// Steps.
    pub steps: usize,
    /// Time per simulated second, s.
    pub time: Quartiles,
    /// The same with the gradient by everything, where there is one.
    pub with_gradient: Option<Quartiles>,
    /// What was wrong.
    pub error: Errors,
    /// Which ways the steps took, if the engine tells.
    pub paths: Option<Paths>,
}

/// What was wrong with a run; see the module.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Of places, in lengths of the case.
    pub position: f64,
    /// Of angles, rad.
    pub angle: f64,
    /// Of velocities, in speeds of the case.
    pub velocity: f64,
    /// Of the energy, in energies of the case.
    pub energy: f64,
    /// Deepest penetration, in lengths of the case.
    pub penetration: f64,
    /// Largest joint error, m or rad.
    pub drift: f64,
}

impl Errors {
    /// The worst of position, angle and velocity.
    #[must_use]
    pub fn state(&self) -> f64 {
        self.position.max(self.angle).max(self.velocity)
    }
}

/// An engine's points in one case, the longest step first, and why there are no more.
#[derive(Debug)]
pub struct Front {
    /// The engine.
    pub engine: String,
    /// Its points.
    pub points: Vec<Point>,
    /// What ended the sweep early.
    pub stopped: Option<Refusal>,
}

/// Longest step, s; the others are this over powers of two.
const LONGEST: f64 = 1.0 / 30.0;

/// Sweeps dt for every engine, until runs take longer than the cap or `halvings` are done.
#[must_use]
pub fn sweep(
    case: &Case,
    engines: &[&dyn Engine],
    halvings: i32,
    patience: &Patience,
) -> Vec<Front> {
    let start =
        |engine: &&dyn Engine| Front { engine: engine.name(), points: Vec::new(), stopped: None };
    let mut fronts: Vec<Front> = engines.iter().map(start).collect();
    let mut running = vec![true; engines.len()];
    for k in 0..=halvings {
        let def = SceneDef { dt: LONGEST * 0.5_f64.powi(k), ..case.def.clone() };
        level(case, &def, engines, &mut fronts, &mut running, patience);
    }
    fronts
}

/// All engines that are still in, at one dt.
fn level(
    case: &Case,
    def: &SceneDef,
    engines: &[&dyn Engine],
    fronts: &mut [Front],
    running: &mut [bool],
    patience: &Patience,
) {
    let steps = case.steps(def.dt);
    let mut tried = Vec::new();
    for (k, engine) in engines.iter().enumerate() {
        if !running[k] {
            continue;
        }
        match observe(case, def, *engine, patience) {
            Ok((error, spent)) => {
                running[k] = 2 * spent < patience.cap;
                tried.push((k, error));
            }
            Err(refusal) => {
                running[k] = false;
                fronts[k].stopped = Some(refusal);
            }
        }
    }
    let works = tried.iter().map(|(k, _)| forward(engines[*k], def, steps)).collect();
    let times = interleaved(works, patience);
    for ((k, error), time) in tried.into_iter().zip(times) {
        let per_second = 1.0 / case.duration;
        let Ok(time) = time else { continue };
        let with_gradient = gradient_time(engines[k], def, steps, patience);
        let (time, with_gradient) =
            (time.scaled(per_second), with_gradient.map(|time| time.scaled(per_second)));
        fronts[k].points.push(Point {
            dt: def.dt,
            steps,
            time,
            with_gradient,
            error,
            paths: engines[k].paths(def, steps),
        });
    }
}

/// A run that is compared at the sample times, and how long its steps took.
fn observe(
    case: &Case,
    def: &SceneDef,
    engine: &dyn Engine,
    patience: &Patience,
) -> Result<(Errors, Duration), Refusal> {
    let scene = Scene::new(def)?;
    let mut world = engine.build(def)?;
    let steps = case.steps(def.dt);
    let (mut error, mut spent) = (Errors::default(), Duration::ZERO);
    for sample in 1..=case.samples {
        for k in 1..=steps / case.samples {
            let (time, result) = timed(|| world.step());
            result?;
            spent += time;
            if spent > 4 * patience.cap {
                let taken = (sample - 1) * steps / case.samples + k;
                let seconds = spent.as_secs_f64() / taken as f64;
                return Err(Refusal::TooSlow { engine: engine.name(), seconds });
            }
        }
        let state = world.state();
        if !is_finite(&state) {
            let steps = sample * steps / case.samples;
            return Err(Refusal::NotFinite { engine: engine.name(), steps });
        }
        let t = case.duration * sample as f64 / case.samples as f64;
        error.include(case, &scene, &state, &(case.known)(t))?;
    }
    Ok((error, spent))
}

impl Errors {
    /// Takes a sample into account.
    fn include(
        &mut self,
        case: &Case,
        scene: &Scene,
        found: &State,
        known: &[Known],
    ) -> Result<(), Refusal> {
        let mut exact = found.clone();
        for Known { body, q, v } in known {
            let (dq, dv) = (found.q[*body] - q, found.v[*body] - v);
            self.position = self.position.max(dq.xy().norm() / case.length);
            // Some engines know an angle up to whole turns.
            self.angle = self.angle.max((dq.z - TAU * (dq.z / TAU).round()).abs());
            let dv = dv.xy().norm().max(case.length * dv.z.abs());
            self.velocity = self.velocity.max(dv / case.speed);
            (exact.q[*body], exact.v[*body]) = (*q, *v);
        }
        let defect = (scene.energy(found) - scene.energy(&exact)).abs() / case.energy;
        self.energy = self.energy.max(defect);
        self.penetration = self.penetration.max(scene.penetration(found)? / case.length);
        self.drift = self.drift.max(scene.joint_drift(found));
        Ok(())
    }
}

fn forward<'a>(engine: &'a dyn Engine, def: &'a SceneDef, steps: usize) -> Work<'a, Refusal> {
    Box::new(move || {
        let mut world = engine.build(def)?;
        let (time, result) = timed(|| (0..steps).try_for_each(|_| world.step()));
        result.map(|()| time)
    })
}

/// The time of value and gradient; `None` where the engine has none, refuses, or exceeds half the cap.
fn gradient_time(
    engine: &dyn Engine,
    def: &SceneDef,
    steps: usize,
    patience: &Patience,
) -> Option<Quartiles> {
    let mut both = engine.value_and_gradient(def, steps).ok().flatten()?;
    let (first, tried) = timed(&mut both);
    if tried.is_err() || 2 * first > patience.cap {
        return None;
    }
    let work: Work<'_, Refusal> = Box::new(move || {
        let (time, result) = timed(&mut both);
        result.map(|_| time)
    });
    interleaved(vec![work], patience).pop()?.ok()
}
