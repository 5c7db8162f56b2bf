//! How a tape is differentiated: as it is, or smoothed.

use std::sync::Arc;

use tangency_core::{IslandRecord, Rollout, StepRecord};
use tangency_lcp::{CentralPoint, Lcp, LcpError, LcpSolution, Scratch};

use crate::error::DiffError;
use crate::lcp::LcpDiffError;

/// What derivatives say about contacts that may open or close, stick or slide.
///
/// A mode prepares a tape; every derivative that is taken of the tape afterwards is of that mode, forward
/// and reverse. States and values of losses stay as they are.
///
/// ```
/// # use tangency_core::{BodyDef, Scene, SceneDef, simulate};
/// # use tangency_diff::{GradientMode, StateVector, gradient};
/// # let solver = tangency_lcp_ipm::InteriorPoint::default();
/// # let name = "stone".into();
/// # let stone = BodyDef { name, mass: Some(1.0), inertia: Some(1.0), ..BodyDef::default() };
/// # let scene = Scene::new(&SceneDef { bodies: vec![stone], ..SceneDef::default() })?;
/// let mut run = simulate(&scene, &solver, 100)?;
/// GradientMode::Smoothed { kappa: 1e-3 }.prepare(&mut run)?;
/// let found = gradient(&scene, &run, |k, s| (k == 100).then(|| StateVector::like(s)))?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum GradientMode {
    /// The derivative of the motion that was computed: of an open contact nothing, of a sticking one no
    /// motion.
    #[default]
    Exact,
    /// Every problem with inequalities is differentiated at the point of its central path where all
    /// complementary products are `kappa` s*², s*² being the energy scale of what moves and is driven. Open contacts
    /// within reach of the step (or of the scene's `contact_reach`) push a little, sticking ones give a
    /// little.
    ///
    /// Flows of accurate steps have no such problems: what slides in them, and which way, is told by
    /// velocities. Their derivatives are the exact ones; those of their impacts are smoothed.
    ///
    /// Away from switches this differs from the exact derivative by O(κ), at switches by O(√κ). Where
    /// nothing moves, is driven or has a right-hand side (s* = 0), the derivative is the exact one.
    Smoothed {
        /// κ, without unit: √κ is the share of the problem's speeds by which switches are blurred; 1e-6
        /// (hardly) to 1e-1 (widely).
        kappa: f64,
    },
}

impl GradientMode {
    /// Makes all derivatives of a rollout those of this mode.
    ///
    /// # Errors
    /// [`DiffError::Step`] with the step and a [`LcpDiffError`]: κ is no positive, finite number, or a
    /// problem has no smoothed point. The tape is then prepared in part.
    pub fn prepare(self, run: &mut Rollout) -> Result<(), DiffError> {
        let mut scratch = Scratch::default();
        for (k, record) in run.records.iter_mut().enumerate() {
            self.record(record, &mut scratch).map_err(|source| DiffError::from(source).at(k))?;
        }
        Ok(())
    }

    /// The same for one step.
    ///
    /// # Errors
    /// As [`prepare_solution`](Self::prepare_solution).
    pub fn prepare_step(self, record: &mut StepRecord) -> Result<(), DiffError> {
        Ok(self.record(record, &mut Scratch::default())?)
    }

    /// The same for the solution of one problem.
    ///
    /// # Errors
    /// [`LcpDiffError::Kappa`], or [`LcpDiffError::NoCentralPoint`].
    pub fn prepare_solution(
        self,
        problem: &Lcp,
        solution: &mut LcpSolution,
    ) -> Result<(), LcpDiffError> {
        self.solution(problem, solution, &mut Scratch::default())
    }

    fn record(self, record: &mut StepRecord, scratch: &mut Scratch) -> Result<(), LcpDiffError> {
        for part in &mut record.parts {
            self.record(part, scratch)?;
        }
        let post = record.post.iter_mut().flat_map(|post| &mut post.islands);
        for IslandRecord { problem, solution, .. } in record.islands.iter_mut().chain(post) {
            self.solution(problem, solution, scratch)?;
        }
        Ok(())
    }

    fn solution(
        self,
        problem: &Lcp,
        solution: &mut LcpSolution,
        scratch: &mut Scratch,
    ) -> Result<(), LcpDiffError> {
        solution.central = None;
        let Self::Smoothed { kappa } = self else { return Ok(()) };
        if !(kappa > 0.0 && kappa.is_finite()) {
            return Err(LcpDiffError::Kappa { kappa });
        }
        let energy = CentralPoint::energy(problem, kappa);
        if problem.is_linear() || energy < f64::MIN_POSITIVE {
            return Ok(());
        }
        let found = CentralPoint::new(problem, solution, energy, scratch);
        solution.central = Some(Arc::new(found.map_err(|error| refusal(kappa, &error))?));
        Ok(())
    }
}

fn refusal(kappa: f64, error: &LcpError) -> LcpDiffError {
    let (steps, residual) = match *error {
        LcpError::NotConverged { iterations, residual } => (iterations, residual),
        _ => (0, f64::INFINITY),
    };
    LcpDiffError::NoCentralPoint { kappa, steps, residual }
}
