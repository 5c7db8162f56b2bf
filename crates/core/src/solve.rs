//! The islands of a step, each solved in the first of its stages that has a solution.

use tangency_lcp::{
    Guess, Lcp, LcpError, LcpSolution, LcpSolver, Metric, Residual, Scratch, solve_assembled,
};

use crate::StepError;
use crate::guess::{Places, guess_likely};
use crate::island::Island;
use crate::record::{IslandRecord, Path, StepRecord};
use crate::row::{RowContext, RowSource, Stage};
use crate::scratch::StepScratch;

/// Solves the islands; `before` is the step before, if there was one.
pub(crate) fn solve(
    context: &RowContext<'_>,
    solver: &dyn LcpSolver,
    time: f64,
    before: Option<&StepRecord>,
    mut islands: Vec<Island>,
    scratch: &mut StepScratch,
) -> Result<Vec<IslandRecord>, StepError> {
    let mut records = scratch.records.take();
    let refuse = |(bodies, source): (Vec<u32>, _)| refusal(context, time, &bodies, source);
    #[cfg(feature = "parallel")]
    if crate::shares::pays(&islands) {
        let StepScratch { places, shares, lcp, .. } = scratch;
        let count = islands.len();
        for (index, island) in islands.drain(..).enumerate() {
            let guess =
                |island: &Island, to: &mut Guess| guess(context, before, index, island, places, to);
            shares.add(index, island, guess);
        }
        for record in shares.solve(context, solver, count, lcp) {
            records.push(record.map_err(refuse)?);
        }
    }
    for (index, island) in islands.drain(..).enumerate() {
        let StepScratch { places, guess: to, lcp, .. } = scratch;
        let guessed = guess(context, before, index, &island, places, to);
        let record = solve_island(context, solver, island, guessed.then_some(to), lcp);
        records.push(record.map_err(refuse)?);
    }
    scratch.islands.give(islands);
    Ok(records)
}

/// Whether there is a guess of an island's modes, which is then in `to`: from the step before, or of
/// displacements from what they are to mend.
pub(crate) fn guess(
    context: &RowContext<'_>,
    before: Option<&StepRecord>,
    index: usize,
    island: &Island,
    places: &mut Places,
    to: &mut Guess,
) -> bool {
    match before {
        _ if island.problem.is_linear() => return false,
        Some(before) => places.guess(before, index, island, context.scene.joints.len(), to),
        None if !island.stage.is_velocity() => guess_likely(island, to),
        None => return false,
    }
    true
}

pub(crate) fn refusal(
    context: &RowContext<'_>,
    time: f64,
    bodies: &[u32],
    source: LcpError,
) -> StepError {
    let names = bodies.iter().map(|b| context.scene.bodies[*b as usize].name.as_str());
    StepError::Lcp { time, bodies: names.collect::<Vec<_>>().join(", "), source }
}

/// A solution more than this times faster than what drives it comes from rows that nearly
/// contradict each other, and a later stage is tried.
fn wild(stage: Stage) -> f64 {
    if stage.is_velocity() { 8.0 } else { 4.0 }
}

/// A later stage counts if its solution is calmer by this much: a lever is no contradiction.
const CALMER: f64 = 4.0;

/// Joints that are far from contradicting each other move as they must, however fast.
pub(crate) fn is_lever(problem: &Lcp, solution: &LcpSolution) -> bool {
    let regular = solution.system.as_ref().is_some_and(|system| system.is_regular());
    regular && problem.is_linear()
}

/// The record of one island; of a refusal its bodies and the first stage's error.
pub(crate) fn solve_island(
    context: &RowContext<'_>,
    solver: &dyn LcpSolver,
    island: Island,
    guess: Option<&Guess>,
    scratch: &mut Scratch,
) -> Result<IslandRecord, (Vec<u32>, LcpError)> {
    let tolerance = context.scene.tolerance();
    match solve_assembled(solver, &island.problem, guess, scratch, tolerance) {
        Ok((solution, residual))
            if !gives_too_much(context, &island, &solution)
                && (is_lever(&island.problem, &solution)
                    || island.problem.is_calm(&solution, wild(island.stage))) =>
        {
            Ok(record(island, solution, residual.max()))
        }
        first => solve_in_stages(context, solver, island, first, scratch),
    }
}

/// The calmest solution of the island's stages, given the first stage's answer.
fn solve_in_stages(
    context: &RowContext<'_>,
    solver: &dyn LcpSolver,
    island: Island,
    first: Result<(LcpSolution, Residual), LcpError>,
    scratch: &mut Scratch,
) -> Result<IslandRecord, (Vec<u32>, LcpError)> {
    let (mut calmest, mut least) = (None, f64::INFINITY);
    let mut refusal: Option<(Vec<u32>, LcpError)> = None;
    let mut next = Some((island, first));
    while let Some((island, answer)) = next {
        let later = match answer {
            Ok((solution, _)) if gives_too_much(context, &island, &solution) => {
                giving_way(context, &island)
            }
            Ok((solution, residual)) => {
                let amplification = island.problem.amplification(&solution);
                let calm = amplification <= wild(island.stage);
                let later = if calm { None } else { giving_way(context, &island) };
                if calmest.is_none() || CALMER * amplification < least {
                    least = amplification;
                    calmest = Some(record(island, solution, residual.max()));
                }
                later
            }
            Err(error) => {
                let later = giving_way(context, &island);
                refusal = refusal.or(Some((island.bodies, error)));
                later
            }
        };
        next = later.map(|island| {
            let tolerance = context.scene.tolerance();
            let answer = solve_assembled(solver, &island.problem, None, scratch, tolerance);
            (island, answer)
        });
    }
    calmest.ok_or_else(|| refusal.unwrap_or((Vec::new(), NOTHING_TRIED)))
}

/// Joints that may drift and give way by more than this, relative to the problem's scale, are
/// driven against each other. Drift alone takes at most ½ √(1e-8).
const DRIVEN: f64 = 1e-3;

fn gives_too_much(context: &RowContext<'_>, island: &Island, solution: &LcpSolution) -> bool {
    if !island.stage.drifts() {
        return false;
    }
    let metric = Metric::new(&island.problem);
    let context = RowContext { stage: island.stage, ..*context };
    let gives = |(row, source): (usize, &RowSource)| {
        context.softness(*source) * metric.impulse(row, solution.impulses[row]).abs()
    };
    island.sources.iter().enumerate().map(gives).any(|gives| gives > DRIVEN * metric.scale)
}

const NOTHING_TRIED: LcpError = LcpError::NotConverged { iterations: 0, residual: f64::INFINITY };

/// The island in its next stage that asks for something else.
fn giving_way(context: &RowContext<'_>, island: &Island) -> Option<Island> {
    let mut stage = island.stage;
    while let Some(next) = stage.next() {
        if let Some(island) = island.at(&RowContext { stage: next, ..*context }) {
            return Some(island);
        }
        stage = next;
    }
    None
}

pub(crate) fn record(island: Island, solution: LcpSolution, residual: f64) -> IslandRecord {
    let Island { bodies, sources, problem, stage } = island;
    let path = Path::of(&problem);
    IslandRecord { bodies, sources, problem, solution, path, stage, residual }
}
