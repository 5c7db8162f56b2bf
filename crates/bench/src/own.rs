//! This engine among those that are timed.

use tangency_core::lcp::LcpSolver;
use tangency_core::{
    Correction, Scene, SceneDef, Stabilisation, State, StepRecord, StepScratch, Stepping,
    next_step, rollout_in, step,
};
use tangency_diff::gradient_adding;

use crate::engine::{Engine, Refusal, ValueAndGradient, World};
use crate::paths::Paths;

/// How this engine steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
    /// As the scene says; by default in fixed steps, joint errors removed within the velocity solve.
    AsDefined,
    /// The same, joint errors removed by a projection after every move.
    Projected,
    /// With impacts at their own time.
    ImpactResolved,
    /// Accurately, between events at their own time.
    Accurate,
}

/// Impacts, or events, that divide a step, at most, in these runs.
const MOST_PARTS: u32 = 64;

/// This engine on one backend.
pub struct Tangency {
    /// The backend's name.
    pub backend: &'static str,
    /// The backend.
    pub solver: Box<dyn LcpSolver>,
    /// How it steps.
    pub variant: Variant,
}

impl Tangency {
    /// Whether this variant differs from the plain one in a scene: joints are projected where there are
    /// some.
    #[must_use]
    pub fn fits(&self, def: &SceneDef) -> bool {
        self.variant != Variant::Projected || !def.joints.is_empty()
    }

    /// The scene as this variant runs it.
    ///
    /// # Errors
    /// [`Refusal::Scene`].
    pub fn scene(&self, def: &SceneDef) -> Result<Scene, Refusal> {
        let mut def = def.clone();
        match self.variant {
            Variant::AsDefined => {}
            Variant::Projected => {
                def.stabilisation = Stabilisation { joints: Correction::Post, ..def.stabilisation };
            }
            Variant::ImpactResolved => {
                def.stepping = Stepping::ImpactResolved { max_impacts: MOST_PARTS };
            }
            Variant::Accurate => def.stepping = Stepping::Accurate { max_events: MOST_PARTS },
        }
        Ok(Scene::new(&def)?)
    }
}

impl Engine for Tangency {
    fn name(&self) -> String {
        let mode = match self.variant {
            Variant::AsDefined => "",
            Variant::Projected => ", projected",
            Variant::ImpactResolved => ", impacts located",
            Variant::Accurate => ", accurate",
        };
        format!("tangency {}{mode}", self.backend)
    }

    fn settings(&self) -> String {
        let mode = match self.variant {
            Variant::AsDefined => "joint errors removed within the velocity solve",
            Variant::Projected => "joint errors removed by a projection after every move",
            Variant::ImpactResolved => "steps divided at impacts (stepping impact_resolved)",
            Variant::Accurate => "order 4 between located events (stepping accurate)",
        };
        format!("backend {}; residual ≤ 1e-10 in every step; {mode}", self.backend)
    }

    fn build(&self, def: &SceneDef) -> Result<Box<dyn World + '_>, Refusal> {
        let scene = self.scene(def)?;
        let control = vec![0.0; scene.controls().len()];
        let (last, scratch) = (None, StepScratch::default());
        Ok(Box::new(OwnWorld { scene, solver: &*self.solver, control, last, scratch }))
    }

    fn value_and_gradient(
        &self,
        def: &SceneDef,
        steps: usize,
    ) -> Result<Option<ValueAndGradient<'_>>, Refusal> {
        let scene = self.scene(def)?;
        let (zeros, mut scratch) = (vec![0.0; scene.controls().len()], StepScratch::default());
        Ok(Some(Box::new(move || {
            let (initial, control) = (scene.initial_state(), |_: usize, _: &State| zeros.clone());
            let run = rollout_in(&scene, &*self.solver, initial, steps, control, &mut scratch)?;
            let by = gradient_adding(&scene, &run, |k, _, bar| {
                if let Some(q) = bar.q.last_mut().filter(|_| k == steps) {
                    q.x += 1.0;
                }
            })?;
            std::hint::black_box(&by);
            let value = run.last().q.last().map_or(0.0, |q| q.x);
            scratch.recycle_run(run);
            Ok(value)
        })))
    }

    fn paths(&self, def: &SceneDef, steps: usize) -> Option<Paths> {
        Paths::of(&self.scene(def).ok()?, &*self.solver, steps).ok()
    }
}

struct OwnWorld<'a> {
    scene: Scene,
    solver: &'a dyn LcpSolver,
    control: Vec<f64>,
    last: Option<StepRecord>,
    scratch: StepScratch,
}

impl World for OwnWorld<'_> {
    fn step(&mut self) -> Result<(), Refusal> {
        let Self { scene, solver, control, last, scratch } = self;
        let record = match last {
            Some(before) => next_step(scene, *solver, before, control, scratch)?,
            None => step(scene, *solver, &scene.initial_state(), control, scratch)?,
        };
        if let Some(before) = last.replace(record) {
            scratch.recycle(before);
        }
        Ok(())
    }

    fn state(&self) -> State {
        self.last.as_ref().map_or_else(|| self.scene.initial_state(), |last| last.after.clone())
    }
}
