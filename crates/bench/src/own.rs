//! This engine among those that are timed.

use tangency_core::lcp::LcpSolver;
use tangency_core::{
    Correction, Scene, SceneDef, Stabilisation, State, StepScratch, simulate, step,
};
use tangency_diff::{StateVector, gradient};

use crate::engine::{Engine, Refusal, ValueAndGradient, World};
use crate::paths::Paths;

/// How joint errors are removed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Joints {
    /// As the scene says; by default within the velocity solve, to first order.
    AsDefined,
    /// By a projection after every move.
    Projected,
}

/// This engine on one backend.
pub struct Tangency {
    /// The backend's name.
    pub backend: &'static str,
    /// The backend.
    pub solver: Box<dyn LcpSolver>,
    /// How joint errors are removed.
    pub joints: Joints,
}

impl Tangency {
    /// The scene as this variant runs it.
    ///
    /// # Errors
    /// [`Refusal::Scene`].
    pub fn scene(&self, def: &SceneDef) -> Result<Scene, Refusal> {
        let mut def = def.clone();
        if self.joints == Joints::Projected {
            def.stabilisation = Stabilisation { joints: Correction::Post, ..def.stabilisation };
        }
        Ok(Scene::new(&def)?)
    }
}

impl Engine for Tangency {
    fn name(&self) -> String {
        match self.joints {
            Joints::AsDefined => format!("tangency {}", self.backend),
            Joints::Projected => format!("tangency {}, projected", self.backend),
        }
    }

    fn settings(&self) -> String {
        let joints = match self.joints {
            Joints::AsDefined => "joint errors removed within the velocity solve",
            Joints::Projected => "joint errors removed by a projection after every move",
        };
        format!("backend {}; residual ≤ 1e-10 in every step; {joints}", self.backend)
    }

    fn build(&self, def: &SceneDef) -> Result<Box<dyn World + '_>, Refusal> {
        let scene = self.scene(def)?;
        let control = vec![0.0; scene.controls().len()];
        let (state, scratch) = (scene.initial_state(), StepScratch::default());
        Ok(Box::new(OwnWorld { scene, solver: &*self.solver, state, control, scratch }))
    }

    fn value_and_gradient(
        &self,
        def: &SceneDef,
        steps: usize,
    ) -> Result<Option<ValueAndGradient<'_>>, Refusal> {
        let scene = self.scene(def)?;
        Ok(Some(Box::new(move || {
            let run = simulate(&scene, &*self.solver, steps)?;
            let by = gradient(&scene, &run, |k, state| (k == steps).then(|| last_x(state)))?.by;
            std::hint::black_box(&by);
            Ok(run.last().q.last().map_or(0.0, |q| q.x))
        })))
    }

    fn paths(&self, def: &SceneDef, steps: usize) -> Option<Paths> {
        Paths::of(&self.scene(def).ok()?, &*self.solver, steps).ok()
    }
}

/// The gradient of the last body's x by the state.
fn last_x(state: &State) -> StateVector {
    let mut seed = StateVector::like(state);
    if let Some(q) = seed.q.last_mut() {
        q.x = 1.0;
    }
    seed
}

struct OwnWorld<'a> {
    scene: Scene,
    solver: &'a dyn LcpSolver,
    state: State,
    control: Vec<f64>,
    scratch: StepScratch,
}

impl World for OwnWorld<'_> {
    fn step(&mut self) -> Result<(), Refusal> {
        let Self { scene, solver, state, control, scratch } = self;
        *state = step(scene, *solver, state, control, scratch)?.after;
        Ok(())
    }

    fn state(&self) -> State {
        self.state.clone()
    }
}
