//! Which ways the steps of a run took, and what they cost in factorisations and iterations.

use tangency_core::lcp::{LcpSolver, Method};
use tangency_core::{Scene, Simulator, StepError};

/// The methods, in the order of [`Paths::solves`].
pub const METHODS: [(Method, &str); 7] = [
    (Method::Linear, "one linear solve"),
    (Method::Warm, "modes of the step before"),
    (Method::ActiveSet, "modes at the free velocities"),
    (Method::InteriorPoint, "interior point"),
    (Method::Walk, "walk"),
    (Method::Pivoting, "pivoting"),
    (Method::Enumeration, "enumeration"),
];

/// Counts of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Paths {
    /// Steps.
    pub steps: usize,
    /// Problems solved by each of [`METHODS`], displacements that mend positions included.
    pub solves: [usize; 7],
    /// Matrix factorisations.
    pub factorisations: usize,
    /// Iterations of interior points.
    pub iterations: usize,
    /// Rows of the velocity problems.
    pub rows: usize,
    /// Contacts in reach.
    pub contacts: usize,
    /// Displacements that mended positions.
    pub displacements: usize,
    /// Worst residual.
    pub residual: f64,
}

impl Paths {
    /// Runs a scene from its initial state with all controls zero, and counts.
    ///
    /// # Errors
    /// The first step that was refused.
    pub fn of(scene: &Scene, solver: &dyn LcpSolver, steps: usize) -> Result<Self, StepError> {
        let control = vec![0.0; scene.controls().len()];
        let mut simulator = Simulator::new(scene, solver);
        let mut paths = Self { steps, ..Self::default() };
        for _ in 0..steps {
            let record = simulator.step(&control)?;
            let counts = record.counts(scene);
            paths.factorisations += counts.factorisations;
            paths.iterations += counts.iterations;
            paths.rows += counts.rows;
            paths.contacts += counts.contacts;
            paths.displacements += counts.displacements;
            paths.residual = paths.residual.max(record.residual());
            let post = record.post.iter().flat_map(|post| &post.islands);
            for island in record.islands.iter().chain(post) {
                paths.count(island.solution.stats.method);
            }
        }
        Ok(paths)
    }

    fn count(&mut self, method: Method) {
        let known = METHODS.iter().zip(&mut self.solves);
        known.filter(|((m, _), _)| *m == method).for_each(|(_, count)| *count += 1);
    }

    /// A count per step.
    #[must_use]
    pub fn per_step(&self, count: usize) -> f64 {
        count as f64 / self.steps.max(1) as f64
    }
}
