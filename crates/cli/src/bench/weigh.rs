//! Memory, weighed in a process of its own, whose allocator holds nothing that other work gave back.

use std::env;
use std::process::Command;

use clap::ValueEnum;
use tangency::SceneDef;
use tangency_bench::gradients::tape;
use tangency_bench::memory::of_world;
use tangency_bench::race::heats;

use super::engines::own;
use super::outcome::MANY;
use crate::{Console, Failure};

/// What is weighed of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Weight {
    /// A tape, as gradients need it
    Tape,
    /// The scene in motion
    World,
}

/// The bytes that a process of its own found; `None` where it could not tell.
pub(super) fn in_own_process(weight: Weight, scene: &str) -> Option<f64> {
    let program = env::current_exe().ok()?;
    let name = weight.to_possible_value()?;
    let arguments = ["bench", "--weigh", name.get_name(), "--of", scene];
    let output = Command::new(program).args(arguments).output().ok()?;
    String::from_utf8(output.stdout).ok()?.trim().parse().ok()
}

/// Weighs, and prints bytes; nothing where there is no such scene or the system does not tell.
pub(super) fn run(weight: Weight, scene: &str, console: &Console) -> Result<(), Failure> {
    let engine = own().into_iter().next();
    if let (Some(def), Some(engine)) = (raced(scene), engine) {
        let bytes = match weight {
            Weight::Tape => tape(&engine, &def),
            Weight::World => of_world(&engine, &def),
        };
        let bytes = bytes.map_err(|source| Failure::Bench { part: "memory", source })?;
        if let Some(bytes) = bytes {
            console.say(bytes);
        }
    }
    Ok(())
}

/// The first scene of the race that has this name.
fn raced(name: &str) -> Option<SceneDef> {
    heats(MANY, 0).into_iter().find(|heat| heat.name == name).map(|heat| heat.def)
}
