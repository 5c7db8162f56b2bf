//! The tables, as CSV and for the page.

use std::path::Path;

use tangency_bench::growth::Size;
use tangency_bench::paths::METHODS;
use tangency_bench::timing::Quartiles;

use super::outcome::Outcome;
use super::row::Row;
use crate::Failure;
use crate::grid::Grid;

/// Writes all tables that have rows.
pub(super) fn save_all(outcome: &Outcome, folder: &Path) -> Result<(), Failure> {
    race(&outcome.race).write_csv(&folder.join("race.csv"))?;
    paths(outcome).write_csv(&folder.join("paths.csv"))?;
    precision(outcome).write_csv(&folder.join("precision.csv"))?;
    growth(outcome).write_csv(&folder.join("growth.csv"))?;
    solvers(outcome).write_csv(&folder.join("solvers.csv"))?;
    lean(outcome).write_csv(&folder.join("lean.csv"))
}

/// A number as CSV has it; empty where there is none.
fn cell<T: ToString>(number: Option<T>) -> String {
    number.map_or_else(String::new, |number| number.to_string())
}

fn quartiles(time: &Quartiles, unit: f64) -> [String; 4] {
    [time.median, time.lower, time.upper, time.least].map(|time| (time * unit).to_string())
}

fn race(rows: &[Row]) -> Grid {
    let mut grid = Grid::new([
        "engine",
        "scene",
        "dt",
        "steps",
        "us_per_step",
        "us_lower",
        "us_upper",
        "us_least",
        "penetration",
        "drift",
        "residual",
        "factorisations",
        "iterations",
        "gradient",
        "note",
    ]);
    for row in rows {
        let numbers = [
            row.us_per_step,
            row.us_lower,
            row.us_upper,
            row.us_least,
            row.penetration,
            row.drift,
            row.residual,
            row.factorisations,
            row.iterations,
            row.gradient,
        ];
        let (dt, steps) = (row.dt.to_string(), cell(row.steps));
        let start = [row.engine.clone(), row.scene.clone(), dt, steps];
        grid.row(start.into_iter().chain(numbers.map(cell)).chain([row.note.clone()]));
    }
    grid
}

/// Paths in numbers per step, the methods in problems per step.
pub(super) fn paths(outcome: &Outcome) -> Grid {
    let start = ["engine", "scene", "dt", "steps", "rows", "contacts"];
    let end = ["factorisations", "iterations", "displacements", "residual"];
    let methods = METHODS.iter().map(|(_, name)| *name);
    let heading = start.into_iter().chain(methods).chain(end).map(str::to_owned).collect();
    let mut grid = Grid::with_heading(heading);
    for row in &outcome.paths {
        let paths = &row.paths;
        let start = [row.engine.clone(), row.scene.clone(), short(row.dt), paths.steps.to_string()];
        let counts = [paths.rows, paths.contacts].into_iter().chain(paths.solves);
        let counts = counts.chain([paths.factorisations, paths.iterations, paths.displacements]);
        let counts = counts.map(|count| short(paths.per_step(count)));
        grid.row(start.into_iter().chain(counts).chain([format!("{:.1e}", paths.residual)]));
    }
    grid
}

/// Three digits at most after the point, without zeros at the end.
pub(super) fn short(number: f64) -> String {
    let text = format!("{number:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn precision(outcome: &Outcome) -> Grid {
    let mut grid = Grid::new([
        "case",
        "title",
        "engine",
        "dt",
        "steps",
        "seconds_per_second",
        "lower",
        "upper",
        "least",
        "with_gradient",
        "position",
        "angle",
        "velocity",
        "energy",
        "penetration",
        "drift",
        "residual",
        "factorisations",
        "iterations",
    ]);
    for (case, fronts) in &outcome.precision {
        for front in fronts {
            for point in &front.points {
                let error = &point.error;
                let errors = [
                    error.position,
                    error.angle,
                    error.velocity,
                    error.energy,
                    error.penetration,
                    error.drift,
                ];
                let start = [case.id.to_owned(), case.title.to_owned(), front.engine.clone()];
                let gradient = point.with_gradient.map(|time| time.median);
                let counts = [
                    point.paths.map(|paths| paths.residual),
                    point.paths.map(|paths| paths.per_step(paths.factorisations)),
                    point.paths.map(|paths| paths.per_step(paths.iterations)),
                ];
                grid.row(
                    start
                        .into_iter()
                        .chain([point.dt.to_string(), point.steps.to_string()])
                        .chain(quartiles(&point.time, 1.0))
                        .chain([cell(gradient)])
                        .chain(errors.map(|error| error.to_string()))
                        .chain(counts.map(cell)),
                );
            }
        }
    }
    grid
}

fn growth(outcome: &Outcome) -> Grid {
    let mut grid = Grid::new([
        "family",
        "engine",
        "bodies",
        "steps",
        "us_per_step",
        "us_lower",
        "us_upper",
        "us_least",
        "note",
    ]);
    for (family, curves) in &outcome.growth {
        for curve in curves {
            for Size { bodies, steps, step } in &curve.sizes {
                let start = [(*family).to_owned(), curve.engine.clone()];
                let (times, note) = match step {
                    Ok(time) => (quartiles(time, 1e6), String::new()),
                    Err(left) => (Default::default(), left.to_string()),
                };
                let size = [bodies.to_string(), steps.to_string()];
                grid.row(start.into_iter().chain(size).chain(times).chain([note]));
            }
        }
    }
    grid
}

/// Bodies from which on exponents are fitted.
pub(super) const LARGE: usize = 100;

/// The exponents of the growth curves.
pub(super) fn exponents(outcome: &Outcome) -> Grid {
    let mut grid =
        Grid::new(["family", "engine", "largest size", "µs per step there", "exponent", "note"]);
    for (family, curves) in &outcome.growth {
        for curve in curves {
            let mut done = curve.sizes.iter().filter_map(|size| {
                size.step.as_ref().ok().map(|step| (size.bodies, 1e6 * step.least))
            });
            let largest = done.next_back();
            let exponent = curve.exponent(LARGE).map(|p| format!("{p:.2}"));
            let left = curve.sizes.iter().find_map(|size| size.step.as_ref().err());
            grid.row([
                (*family).to_owned(),
                curve.engine.clone(),
                cell(largest.map(|(bodies, _)| bodies)),
                cell(largest.map(|(_, us)| format!("{us:.1}"))),
                exponent.unwrap_or_default(),
                cell(left),
            ]);
        }
    }
    grid
}

pub(super) fn solvers(outcome: &Outcome) -> Grid {
    let mut grid = Grid::new([
        "scene",
        "problems",
        "rows",
        "solver",
        "tolerance",
        "us_per_problem",
        "us_lower",
        "us_upper",
        "us_least",
        "over_native",
        "residual",
        "iterations",
        "most_iterations",
        "factorisations",
        "refused",
    ]);
    for row in &outcome.solvers {
        let score = &row.score;
        let start = [
            row.scene.clone(),
            row.problems.to_string(),
            short(row.rows),
            row.solver.to_owned(),
            format!("{:e}", row.tolerance),
        ];
        let us = quartiles(&score.time, 1e6).map(|us| us.parse().map_or(us, short));
        // At the same tolerance; the native solver comes first.
        let native = outcome
            .solvers
            .iter()
            .find(|other| other.scene == row.scene && other.tolerance == row.tolerance);
        let ratio = native.map(|native| short(score.time.least / native.score.time.least));
        let end = [
            ratio.unwrap_or_default(),
            format!("{:.1e}", score.residual),
            short(score.iterations),
            score.most_iterations.to_string(),
            short(score.factorisations),
            score.refused.to_string(),
        ];
        grid.row(start.into_iter().chain(us).chain(end));
    }
    grid
}

pub(super) fn lean(outcome: &Outcome) -> Grid {
    let mut grid = Grid::new(["what", "found", "goal", "holds"]);
    for check in &outcome.lean {
        let relation = if check.count { "=" } else { "≤" };
        let goal = format!("{relation} {}", check.goal);
        let holds = if check.holds() { "yes" } else { "no" };
        grid.row([check.what.to_owned(), short(check.found), goal, holds.to_owned()]);
    }
    grid
}

/// For the terminal: times per step of the race.
pub(super) fn summary(outcome: &Outcome) -> Grid {
    let mut grid = Grid::new(["scene", "dt", "engine", "µs per step, least", "gradient"]);
    for row in &outcome.race {
        let time = row.us_least.map_or_else(|| row.note.clone(), |us| format!("{us:.3}"));
        let gradient = cell(row.gradient.map(|multiple| format!("{multiple:.1} ×")));
        grid.row([row.scene.clone(), short(row.dt), row.engine.clone(), time, gradient]);
    }
    grid
}
