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
    /// Of ours, bytes.
    tape: Option<f64>,
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
    let raced = told(outcome).map(|row| (&*row.scene, &*row.engine));
    let mut places: Vec<(&str, &str)> = raced.collect();
    for study in &outcome.gradients {
        let place = (&*study.scene, &*study.engine);
        if !places.contains(&place) {
            places.push(place);
        }
    }
    places.into_iter().map(|(scene, engine)| of(outcome, scene, engine)).collect()
}

fn of<'a>(outcome: &'a Outcome, scene: &'a str, engine: &'a str) -> GradientRow<'a> {
    let race = |engine: &str| told(outcome).find(|r| r.scene == scene && r.engine == engine);
    let own_us = race(&outcome.own).and_then(|row| row.gradient_us);
    let study = outcome.gradients.iter().find(|it| it.scene == scene && it.engine == engine);
    let tape = outcome.tape(scene).filter(|_| engine == outcome.own);
    GradientRow { scene, engine, race: race(engine), own_us, study, tape }
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
            ("tape_kib", |row| number(row.tape, |bytes| digits(bytes / 1024.0))),
            ("note", |row| row.race.map_or_else(String::new, |row| row.note.clone())),
        ],
    )
}
