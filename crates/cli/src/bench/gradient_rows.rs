//! What gradients cost and how exact they are: times from the race, all else from the part `gradients`.

use tangency_bench::gradients::Study;

use super::digits::{cell, digits, number, small};
use super::outcome::Outcome;
use super::row::Row;
use crate::grid::Grid;

/// One engine's gradient at one scene.
struct GradientRow<'a> {
    scene: &'a str,
    engine: &'a str,
    race: Option<&'a Row>,
    /// Of the same gradient by ours, µs.
    own_us: Option<f64>,
    study: Option<&'a Study>,
}

impl GradientRow<'_> {
    fn over_ours(&self) -> Option<f64> {
        Some(self.race?.gradient_us? / self.own_us?)
    }
}

/// The rows of race.csv that tell of a gradient.
fn told(outcome: &Outcome) -> impl Iterator<Item = &Row> {
    outcome.race.iter().filter(|row| row.gradient.is_some())
}

fn rows(outcome: &Outcome) -> Vec<GradientRow<'_>> {
    let study = |scene: &str, engine: &str| {
        outcome.gradients.iter().find(|study| study.scene == scene && study.engine == engine)
    };
    let own_us = |scene: &str| {
        let own = told(outcome).find(|row| row.scene == scene && row.engine == outcome.own);
        own.and_then(|row| row.gradient_us)
    };
    let raced = told(outcome).map(|row| {
        let (scene, engine) = (&*row.scene, &*row.engine);
        let (own_us, study) = (own_us(scene), study(scene, engine));
        GradientRow { scene, engine, race: Some(row), own_us, study }
    });
    let alone = outcome.gradients.iter().filter(|study| {
        !told(outcome).any(|row| row.scene == study.scene && row.engine == study.engine)
    });
    let alone = alone.map(|study| {
        let (scene, engine) = (&*study.scene, &*study.engine);
        GradientRow { scene, engine, race: None, own_us: None, study: Some(study) }
    });
    raced.chain(alone).collect()
}

/// One row per gradient; what was not measured is empty.
pub(super) fn grid(outcome: &Outcome) -> Grid {
    Grid::of(
        rows(outcome),
        &[
            ("scene", |row| row.scene.into()),
            ("engine", |row| row.engine.into()),
            ("us_value_and_gradient", |row| number(row.race.and_then(|r| r.gradient_us), digits)),
            ("over_value", |row| number(row.race.and_then(|r| r.gradient), digits)),
            ("over_ours", |row| number(row.over_ours(), digits)),
            ("numbers", |row| cell(row.study.map(|study| study.numbers))),
            ("compared", |row| cell(row.study.map(|study| study.compared))),
            ("error", |row| number(row.study.map(|study| study.error), small)),
            ("tape_kib", |row| {
                number(row.study.and_then(|study| study.tape), |b| digits(b / 1024.0))
            }),
            ("note", |row| row.race.map_or_else(String::new, |row| row.note.clone())),
        ],
    )
}
