//! Solvers by themselves, on the problems that runs of scenes solve.

use tangency_core::lcp::{Lcp, LcpError, LcpSolver, Method, Scratch};
use tangency_core::{Scene, StepScratch, step};

use crate::timing::{Patience, Quartiles, Work, interleaved, timed};

/// A solver with the tolerance that it was given.
pub struct Candidate {
    /// Its name.
    pub name: &'static str,
    /// Its tolerance.
    pub tolerance: f64,
    /// The solver.
    pub solver: Box<dyn LcpSolver>,
}

/// The complementarity problems of a scene's first `steps` steps. Ends early where a step is refused.
#[must_use]
pub fn problems(scene: &Scene, solver: &dyn LcpSolver, steps: usize) -> Vec<Lcp> {
    let (mut state, mut scratch) = (scene.initial_state(), StepScratch::default());
    let control = vec![0.0; scene.controls().len()];
    let mut all = Vec::new();
    for _ in 0..steps {
        let Ok(record) = step(scene, solver, &state, &control, &mut scratch) else { break };
        let post = record.post.into_iter().flat_map(|post| post.islands);
        all.extend(record.islands.into_iter().chain(post).map(|island| island.problem));
        state = record.after;
    }
    all.retain(|problem| !problem.is_linear());
    all
}

/// At most so many of them, evenly spread.
#[must_use]
pub fn spread(problems: Vec<Lcp>, most: usize) -> Vec<Lcp> {
    let stride = problems.len().div_ceil(most.max(1)).max(1);
    problems.into_iter().step_by(stride).collect()
}

/// Those that a solver leaves to its interior point, or to what comes after it, when it has no guess.
#[must_use]
pub fn hard(problems: &[Lcp], solver: &dyn LcpSolver) -> Vec<Lcp> {
    let mut scratch = Scratch::default();
    let mut is_hard = |problem: &&Lcp| match solver.solve(problem, None, &mut scratch) {
        Ok(solution) => !matches!(solution.stats.method, Method::Linear | Method::ActiveSet),
        Err(_) => true,
    };
    problems.iter().filter(|problem| is_hard(problem)).cloned().collect()
}

/// What a solver made of some problems.
#[derive(Clone, Copy, Debug, Default)]
pub struct Score {
    /// Time per problem, s.
    pub time: Quartiles,
    /// Worst natural residual of what it solved.
    pub residual: f64,
    /// Iterations per problem.
    pub iterations: f64,
    /// Most iterations of one problem.
    pub most_iterations: u32,
    /// Factorisations per problem.
    pub factorisations: f64,
    /// Problems that it refused.
    pub refused: usize,
}

/// Lets the candidates take turns on the same problems, without guesses.
///
/// A solver that refuses a problem is timed on it all the same.
#[must_use]
pub fn compare(problems: &[Lcp], candidates: &[Candidate], patience: &Patience) -> Vec<Score> {
    let works = candidates.iter().map(|c| {
        let mut scratch = Scratch::default();
        let work: Work<'_, LcpError> = Box::new(move || {
            let solve = |problem: &Lcp| drop(c.solver.solve(problem, None, &mut scratch));
            Ok(timed(|| problems.iter().for_each(solve)).0)
        });
        work
    });
    let times = interleaved(works.collect(), patience);
    let scores = candidates.iter().zip(times).map(|(candidate, time)| {
        let time = time.unwrap_or_default().scaled(1.0 / problems.len().max(1) as f64);
        Score { time, ..judge(problems, &*candidate.solver) }
    });
    scores.collect()
}

fn judge(problems: &[Lcp], solver: &dyn LcpSolver) -> Score {
    let (mut score, mut scratch) = (Score::default(), Scratch::default());
    let share = 1.0 / problems.len().max(1) as f64;
    for problem in problems {
        match solver.solve(problem, None, &mut scratch) {
            Ok(solution) => {
                score.residual = score.residual.max(problem.residual(&solution).max());
                score.iterations += share * f64::from(solution.stats.iterations);
                score.most_iterations = score.most_iterations.max(solution.stats.iterations);
                score.factorisations += share * f64::from(solution.stats.factorisations);
            }
            Err(_) => score.refused += 1,
        }
    }
    score
}
