//! Only what a scene needs: counts that must hold, and ratios of times within one run.

use tangency_core::lcp::LcpSolver;
use tangency_core::{BodyDef, Counts, PairDef, Scene, SceneDef, StepRecord, StepScratch, step};

use crate::check::Check;
use crate::engine::{Engine, Refusal};
use crate::own::Tangency;
use crate::scenes;
use crate::timing::{Patience, Work, interleaved, timed};

/// All counts and ratios.
///
/// # Errors
/// A [`Refusal`] where a scene or step is refused.
pub fn checks(engine: &Tangency, patience: &Patience) -> Result<Vec<Check>, Refusal> {
    let mut all = counts(&*engine.solver)?;
    all.extend(ratios(engine, patience)?);
    Ok(all)
}

fn first_step(def: &SceneDef, solver: &dyn LcpSolver) -> Result<(Counts, StepRecord), Refusal> {
    let scene = Scene::new(def)?;
    let control = vec![0.0; scene.controls().len()];
    let (state, mut scratch) = (scene.initial_state(), StepScratch::default());
    let record = step(&scene, solver, &state, &control, &mut scratch)?;
    Ok((record.counts(&scene), record))
}

fn counts(solver: &dyn LcpSolver) -> Result<Vec<Check>, Refusal> {
    let of = |def: &SceneDef| first_step(def, solver).map(|(counts, _)| counts);
    let flight = of(&scenes::free_flight())?;
    let smooth = of(&scenes::sliding_box(1.0, 0.0, 1.0))?;
    let rough = of(&scenes::sliding_box(1.0, 0.3, 1.0))?;
    let mixed = of(&half_rough())?;
    let joints = of(&scenes::chain(10, 0.2, 0.1))?;
    Ok(vec![
        Check::exactly("free flight: rows", flight.rows, 0),
        Check::exactly("free flight: factorisations", flight.factorisations, 0),
        Check::exactly("box without friction, two contacts: rows", smooth.rows, 2),
        Check::exactly("box with friction, two contacts: rows", rough.rows, 4),
        Check::exactly("one box with and one without friction: rows", mixed.rows, 6),
        Check::exactly("joints alone: complementarity problems", joints.lcp_islands, 0),
        Check::exactly("joints alone: iterations", joints.iterations, 0),
        Check::exactly("joints alone: factorisations", joints.factorisations, 1),
    ])
}

/// Two sliding boxes far apart, the second one without friction on the floor.
fn half_rough() -> SceneDef {
    let mut def = scenes::sliding_box(1.0, 0.3, 1.0);
    let smooth = BodyDef { name: "smooth".into(), position: [50.0, 0.1], ..def.bodies[1].clone() };
    let bodies = [def.bodies[0].name.clone(), smooth.name.clone()];
    def.bodies.push(smooth);
    def.pairs.push(PairDef { bodies, friction: Some(0.0), ..PairDef::default() });
    def
}

/// Steps per run of a ratio.
const STEPS: usize = 50;

fn ratios(engine: &Tangency, patience: &Patience) -> Result<Vec<Check>, Refusal> {
    let single = scenes::race_stack(3);
    let copies = compare(engine, &single, &scenes::copies(&single, 32, 100.0), patience)?;
    let littered = compare(engine, &single, &littered(&single, 5000), patience)?;
    Ok(vec![
        Check::at_most("32 distant copies of a stack over 32 single ones", copies / 32.0, 1.3),
        Check::at_most("5000 static bodies out of reach over none", littered, 1.2),
    ])
}

/// The scene with static blocks far above it.
fn littered(def: &SceneDef, count: usize) -> SceneDef {
    let mut all = def.clone();
    all.bodies.extend((0..count).map(|k| {
        let place = [3.0 * k as f64, 1000.0];
        scenes::fixed_block(&format!("litter{k}"), [1.0; 2], place)
    }));
    all
}

/// Time of `other` over that of `base`.
fn compare(
    engine: &Tangency,
    base: &SceneDef,
    other: &SceneDef,
    patience: &Patience,
) -> Result<f64, Refusal> {
    let works = [base, other].map(|def| {
        let work: Work<'_, Refusal> = Box::new(move || {
            let mut world = engine.build(def)?;
            let (time, result) = timed(|| (0..STEPS).try_for_each(|_| world.step()));
            result.map(|()| time)
        });
        work
    });
    ratio(interleaved(works.into(), patience))
}

/// The second least time over the first.
fn ratio(times: Vec<Result<crate::timing::Quartiles, Refusal>>) -> Result<f64, Refusal> {
    let mut least = Vec::new();
    for time in times {
        least.push(time?.least);
    }
    Ok(least[1] / least[0])
}
