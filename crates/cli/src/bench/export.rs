//! The scenes of the race as JSON, for engines in other languages.

use std::path::Path;

use serde::Serialize;
use serde_json::value::RawValue;
use tangency::scene_to_json;
use tangency_bench::race::{GRADIENT_STEPS, heats};

use crate::Failure;

#[derive(Serialize)]
struct Exported {
    /// What the column `scene` says.
    scene: String,
    dt: f64,
    steps: usize,
    /// Steps of a value and gradient; 0 where none is asked for.
    gradient_steps: usize,
    /// The scene as our scene files have it.
    definition: Box<RawValue>,
}

/// Writes the scenes.
pub(super) fn write(file: &Path) -> Result<(), Failure> {
    let failed =
        |error: serde_json::Error| Failure::Write { file: file.to_owned(), source: error.into() };
    let mut all = Vec::new();
    for heat in heats(200, 20) {
        let definition = RawValue::from_string(scene_to_json(&heat.def)).map_err(failed)?;
        let gradient_steps = if heat.gradient { GRADIENT_STEPS } else { 0 };
        let (scene, dt, steps) = (heat.name, heat.def.dt, heat.steps);
        all.push(Exported { scene, dt, steps, gradient_steps, definition });
    }
    super::write(file, &serde_json::to_string(&all).map_err(failed)?)
}
