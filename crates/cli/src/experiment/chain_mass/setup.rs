//! The scene, what is observed of it, and the recipe.

use nalgebra::Vector3;
use rand::SeedableRng as _;
use rand::rngs::StdRng;
use rand_distr::{Distribution as _, Normal};
use tangency::diff::Parameter;
use tangency::lcp::LcpSolver;
use tangency::{GradientMode, Scene, simulate};
use tangency_bench::scenes::paper_chain;

use crate::Failure;
use crate::loss::Loss;
use crate::objective::Objective;
use crate::observations::Observations;
use crate::optimise::Settings;

/// Total mass of the links.
pub(super) const TRUE_MASS: f64 = 7.0;
/// Where the paper starts.
pub(super) const START: f64 = 1.0;
/// Gradient descent's updates, rate and clip in the paper.
pub(super) const RECIPE: Settings =
    Settings { iterations: 30, rate: 0.01, clip: 100.0, continuation: false };
/// 10 s.
const STEPS: usize = 300;

/// The chain with its true mass, observed.
pub(super) struct Setup<'a> {
    pub(super) links: usize,
    pub(super) solver: &'a dyn LcpSolver,
    /// The scene with the true mass.
    pub(super) truth: Scene,
    /// The total mass.
    pub(super) parameters: Vec<Parameter>,
    /// All poses of links and ball.
    pub(super) observed: Observations,
}

impl<'a> Setup<'a> {
    pub(super) fn new(links: usize, solver: &'a dyn LcpSolver) -> Result<Self, Failure> {
        let mut truth = Scene::new(&paper_chain(links, TRUE_MASS))?;
        let parameters = vec![Parameter::parse(&truth, "total_mass:links")?];
        // Set as the fits set it: the last bit of 7/n counts where a loss is to vanish.
        parameters[0].set(&mut truth, TRUE_MASS)?;
        let observed = observe(&truth, solver)?;
        Ok(Self { links, solver, truth, parameters, observed })
    }

    /// The loss as a function of the total mass.
    pub(super) fn objective(&self) -> Objective<'_> {
        self.objective_of(&self.parameters)
    }

    /// The loss as a function of other parameters.
    pub(super) fn objective_of<'b>(&'b self, parameters: &'b [Parameter]) -> Objective<'b> {
        Objective {
            scene: &self.truth,
            parameters,
            solver: self.solver,
            steps: STEPS,
            checkpoints: false,
            mode: GradientMode::Exact,
        }
    }

    /// One mass for each link.
    pub(super) fn link_masses(&self) -> Result<Vec<Parameter>, Failure> {
        let names: Vec<String> = (0..self.links).map(|i| format!("mass:link{i}")).collect();
        Ok(Parameter::parse_all(&self.truth, &names)?)
    }

    pub(super) fn loss(&self) -> Loss {
        Loss::Observed(self.observed.clone())
    }

    /// What a camera of this precision would have seen: σ on x and y, and on angles.
    pub(super) fn noisy(&self, seed: u64, [sigma, sigma_angle]: [f64; 2]) -> Observations {
        let mut rng = StdRng::seed_from_u64(seed);
        let normal = |sigma| Normal::new(0.0, sigma).expect("the noise has a finite size");
        let (position, angle) = (normal(sigma), normal(sigma_angle));
        let mut seen = self.observed.clone();
        for pose in seen.frames.iter_mut().flat_map(|frame| &mut frame.poses) {
            let noise = [&position, &position, &angle].map(|normal| normal.sample(&mut rng));
            *pose += Vector3::from(noise);
        }
        seen
    }
}

/// All poses of all bodies of a scene, at every step.
pub(super) fn observe(scene: &Scene, solver: &dyn LcpSolver) -> Result<Observations, Failure> {
    let rollout = simulate(scene, solver, STEPS)?;
    Ok(Observations::of(&rollout, (0..scene.bodies().len()).collect()))
}
