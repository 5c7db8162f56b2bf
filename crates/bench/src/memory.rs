//! Memory that something takes, as the system sees it.

use memory_stats::memory_stats;
use tangency_core::SceneDef;

use crate::engine::{Engine, Refusal};

/// Memory per copy, bytes, of something that is built `copies` times, or `None` where the system does
/// not tell.
///
/// ```text
///  (memory after 2 n copies − memory after n copies) / n
/// ```
///
/// The first n fill what earlier work has given back to the allocator, so that the second n come from
/// the system. Where that was more than n copies take, too little is found: weigh in a process that has
/// done little before. What is counted are pages: let all copies together take some MiB.
///
/// # Errors
/// What `build` is refused by.
pub fn per_copy<T, E>(
    copies: usize,
    mut build: impl FnMut() -> Result<T, E>,
) -> Result<Option<f64>, E> {
    let mut held = Vec::with_capacity(2 * copies);
    let mut taken = [None; 2];
    for taken in &mut taken {
        for _ in 0..copies {
            held.push(build()?);
        }
        *taken = memory_stats().map(|memory| memory.physical_mem as f64);
    }
    std::hint::black_box(&held);
    let [first, second] = taken;
    Ok(second.zip(first).map(|(second, first)| (second - first) / copies as f64))
}

/// Worlds that are held together, twice.
const WORLDS: usize = 2;

/// Memory of a large scene in motion, bytes, or `None` where the system does not tell.
///
/// # Errors
/// A [`Refusal`] where the engine refuses the scene or a step.
pub fn of_world(engine: &dyn Engine, def: &SceneDef) -> Result<Option<f64>, Refusal> {
    per_copy(WORLDS, || {
        let mut world = engine.build(def)?;
        (0..3).try_for_each(|_| world.step())?;
        Ok(world)
    })
}
