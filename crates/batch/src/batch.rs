//! The environments of a batch, and what may be read and changed about each.

use std::sync::Arc;

use tangency_core::{Param, Scene, SceneError, State, StepRecord};
use tangency_diff::GradientMode;
use tangency_lcp::LcpSolver;

use crate::BatchError;
use crate::environment::Environment;
use crate::workspace::Workspaces;

/// Many environments that are stepped, rolled out and differentiated side by side.
///
/// All have the same number of control channels; they may differ in everything else.
///
/// ```
/// use tangency_batch::{Batch, Controls};
/// use tangency_core::{BodyDef, Param, Scene, SceneDef};
/// use tangency_lcp::LcpSolver;
/// # fn default_solver() -> Box<dyn LcpSolver> { Box::new(tangency_lcp_ipm::InteriorPoint::default()) }
///
/// // 100 stones fall, each on a planet of its own. Where is each after a second?
/// let name = "stone".into();
/// let stone = BodyDef { name, mass: Some(1.0), inertia: Some(1.0), ..BodyDef::default() };
/// let scene = Scene::new(&SceneDef { bodies: vec![stone], dt: 0.01, ..SceneDef::default() })?;
/// let mut batch = Batch::new(scene, 100, default_solver());
/// for planet in 0..100 {
///     batch.set(planet, Param::Gravity(1), -0.1 * planet as f64)?;
/// }
/// let found = batch.value_and_gradient(100, Controls::Zero, |_planet, k, state, bar| {
///     if k < 100 {
///         return 0.0;
///     }
///     bar.q[0].y += 1.0; // the loss is the height at the end
///     state.q[0].y
/// })?;
/// let by_gravity = |i: usize| {
///     let found = found.results[i].as_ref()?;
///     Some(found.gradient.by.by(batch.scene(i), Param::Gravity(1)))
/// };
/// assert!((by_gravity(7).unwrap() - 0.505).abs() < 1e-12); // ½ t² + ½ t dt
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Batch {
    pub(crate) environments: Vec<Environment>,
    pub(crate) channels: usize,
    pub(crate) solver: Arc<dyn LcpSolver>,
    pub(crate) workspaces: Workspaces,
    pub(crate) mode: GradientMode,
}

impl Batch {
    /// So many environments of one scene, each in the scene's initial state. The scene is held once
    /// until numbers of single environments are [set](Self::set).
    #[must_use]
    pub fn new(scene: Scene, environments: usize, solver: impl Into<Arc<dyn LcpSolver>>) -> Self {
        let channels = scene.controls().len();
        let scene = Arc::new(scene);
        let environments = (0..environments).map(|_| Environment::new(scene.clone())).collect();
        let (workspaces, mode) = (Workspaces::default(), GradientMode::Exact);
        Self { environments, channels, solver: solver.into(), workspaces, mode }
    }

    /// One environment per scene, each in its scene's initial state. Copies of one scene, changed by
    /// [`Scene::set`], share what was prepared for its shapes and step faster than scenes built apart.
    ///
    /// # Errors
    /// [`BatchError::Channels`] if the scenes differ in their number of control channels.
    pub fn of_scenes(
        scenes: Vec<Scene>,
        solver: impl Into<Arc<dyn LcpSolver>>,
    ) -> Result<Self, BatchError> {
        let expected = scenes.first().map_or(0, |scene| scene.controls().len());
        for (environment, scene) in scenes.iter().enumerate() {
            let found = scene.controls().len();
            if found != expected {
                return Err(BatchError::Channels { environment, expected, found });
            }
        }
        let environments = scenes.into_iter().map(|s| Environment::new(Arc::new(s))).collect();
        let (solver, workspaces) = (solver.into(), Workspaces::default());
        let mode = GradientMode::Exact;
        Ok(Self { environments, channels: expected, solver, workspaces, mode })
    }

    /// Makes the derivatives of the rollouts that follow exact (as at first) or smoothed.
    pub fn set_gradient_mode(&mut self, mode: GradientMode) {
        self.mode = mode;
    }

    /// Number of environments.
    #[must_use]
    pub fn len(&self) -> usize {
        self.environments.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.environments.is_empty()
    }

    /// Control channels per environment.
    #[must_use]
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// The scene of an environment.
    ///
    /// # Panics
    /// If there is no such environment; so do all methods that take an index.
    #[must_use]
    pub fn scene(&self, environment: usize) -> &Scene {
        &self.environments[environment].scene
    }

    /// The scenes of all environments, in their order; those that were never changed are one.
    pub fn scenes(&self) -> impl ExactSizeIterator<Item = &Arc<Scene>> {
        self.environments.iter().map(|environment| &environment.scene)
    }

    /// The state that an environment has come to.
    ///
    /// # Panics
    /// If there is no such environment.
    #[must_use]
    pub fn state(&self, environment: usize) -> &State {
        self.environments[environment].state()
    }

    /// The states that all environments have come to, in their order.
    pub fn states(&self) -> impl ExactSizeIterator<Item = &State> {
        self.environments.iter().map(Environment::state)
    }

    /// The last step of an environment, with its contacts and impulses; none since it was built or
    /// reset.
    ///
    /// # Panics
    /// If there is no such environment.
    #[must_use]
    pub fn record(&self, environment: usize) -> Option<&StepRecord> {
        self.environments[environment].record()
    }

    /// Changes a number of one environment's scene. Initial positions and velocities show at its next
    /// [reset](Self::reset), all else from its next step on.
    ///
    /// # Errors
    /// As [`Scene::set`]; nothing has then changed.
    ///
    /// # Panics
    /// If there is no such environment.
    pub fn set(&mut self, environment: usize, param: Param, value: f64) -> Result<(), SceneError> {
        Arc::make_mut(&mut self.environments[environment].scene).set(param, value)
    }

    /// Puts one environment into its scene's initial state.
    ///
    /// # Panics
    /// If there is no such environment.
    pub fn reset(&mut self, environment: usize) {
        let environment = &mut self.environments[environment];
        environment.put(environment.scene.initial_state());
    }

    /// Puts one environment into a state.
    ///
    /// # Errors
    /// [`BatchError::State`] if the state does not fit the scene or is not finite; the environment
    /// then stays where it was.
    ///
    /// # Panics
    /// If there is no such environment.
    pub fn reset_to(&mut self, environment: usize, state: State) -> Result<(), BatchError> {
        let bodies = self.scene(environment).bodies().len();
        state.check(bodies).map_err(|source| BatchError::State { environment, source })?;
        self.environments[environment].put(state);
        Ok(())
    }
}
