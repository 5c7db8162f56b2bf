//! The tables, as CSV and for the page.

use std::path::Path;

use tangency_bench::check::Check;
use tangency_bench::growth::{Curve, Size};
use tangency_bench::paths::METHODS;
use tangency_bench::precision::{Case, Front, Point};
use tangency_bench::timing::Quartiles;

use super::digits::{cell, digits, number, short, small};
use super::goals::goals;
use super::gradient_rows;
use super::outcome::{Outcome, SolverRow};
use super::row;
use crate::Failure;
use crate::grid::Grid;

/// Writes all tables.
pub(super) fn save_all(outcome: &Outcome, folder: &Path) -> Result<(), Failure> {
    row::write_all(&outcome.race, &folder.join("race.csv"))?;
    let grids = [
        ("goals", checks(&goals(outcome))),
        ("paths", paths(outcome)),
        ("precision", precision(outcome)),
        ("growth", growth(outcome)),
        ("solvers", solvers(outcome)),
        ("lean", checks(&outcome.lean)),
        ("gradients", gradient_rows::grid(outcome)),
        ("batch", batch(outcome)),
    ];
    grids.iter().try_for_each(|(stem, grid)| grid.write_csv(&folder.join(format!("{stem}.csv"))))
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

fn precision(outcome: &Outcome) -> Grid {
    let points = outcome.precision.iter().flat_map(|(case, fronts)| {
        fronts.iter().flat_map(move |front| front.points.iter().map(move |p| (case, front, p)))
    });
    Grid::of::<(&Case, &Front, &Point)>(
        points,
        &[
            ("case", |(case, ..)| case.id.into()),
            ("title", |(case, ..)| case.title.into()),
            ("engine", |(_, front, _)| front.engine.clone()),
            ("dt", |(.., p)| p.dt.to_string()),
            ("steps", |(.., p)| p.steps.to_string()),
            ("seconds_per_second", |(.., p)| p.time.median.to_string()),
            ("lower", |(.., p)| p.time.lower.to_string()),
            ("upper", |(.., p)| p.time.upper.to_string()),
            ("least", |(.., p)| p.time.least.to_string()),
            ("with_gradient", |(.., p)| cell(p.with_gradient.map(|time| time.median))),
            ("position", |(.., p)| p.error.position.to_string()),
            ("angle", |(.., p)| p.error.angle.to_string()),
            ("velocity", |(.., p)| p.error.velocity.to_string()),
            ("energy", |(.., p)| p.error.energy.to_string()),
            ("penetration", |(.., p)| p.error.penetration.to_string()),
            ("drift", |(.., p)| p.error.drift.to_string()),
            ("residual", |(.., p)| cell(p.paths.map(|paths| paths.residual))),
            ("factorisations", |(.., p)| cell(p.paths.map(|it| it.per_step(it.factorisations)))),
            ("iterations", |(.., p)| cell(p.paths.map(|it| it.per_step(it.iterations)))),
        ],
    )
}

fn curves(outcome: &Outcome) -> impl Iterator<Item = (&'static str, &Curve)> {
    let families = outcome.growth.iter();
    families.flat_map(|(family, curves)| curves.iter().map(move |curve| (*family, curve)))
}

fn growth(outcome: &Outcome) -> Grid {
    fn us(size: &Size, part: fn(&Quartiles) -> f64) -> String {
        cell(size.step.as_ref().ok().map(|time| 1e6 * part(time)))
    }
    let sizes = curves(outcome).flat_map(|(family, curve)| {
        curve.sizes.iter().map(move |size| (family, &*curve.engine, size))
    });
    Grid::of::<(&str, &str, &Size)>(
        sizes,
        &[
            ("family", |(family, ..)| (*family).into()),
            ("engine", |(_, engine, _)| (*engine).into()),
            ("bodies", |(.., size)| size.bodies.to_string()),
            ("steps", |(.., size)| size.steps.to_string()),
            ("us_per_step", |(.., size)| us(size, |time| time.median)),
            ("us_lower", |(.., size)| us(size, |time| time.lower)),
            ("us_upper", |(.., size)| us(size, |time| time.upper)),
            ("us_least", |(.., size)| us(size, |time| time.least)),
            ("note", |(.., size)| cell(size.step.as_ref().err())),
        ],
    )
}

/// Bodies from which on exponents are fitted.
pub(super) const LARGE: usize = 100;

/// The exponents of the growth curves.
pub(super) fn exponents(outcome: &Outcome) -> Grid {
    fn largest(curve: &Curve) -> Option<(usize, f64)> {
        let timed = |size: &Size| size.step.as_ref().ok().map(|step| (size.bodies, step.least));
        curve.sizes.iter().filter_map(timed).next_back()
    }
    fn microseconds(curve: &Curve) -> Option<f64> {
        largest(curve).map(|(_, step)| 1e6 * step)
    }
    Grid::of::<(&str, &Curve)>(
        curves(outcome),
        &[
            ("family", |(family, _)| (*family).into()),
            ("engine", |(_, curve)| curve.engine.clone()),
            ("largest size", |(_, curve)| cell(largest(curve).map(|(bodies, _)| bodies))),
            ("µs per step there", |(_, it)| number(microseconds(it), |us| format!("{us:.1}"))),
            ("exponent", |(_, curve)| number(curve.exponent(LARGE), |p| format!("{p:.2}"))),
            ("note", |(_, it)| cell(it.sizes.iter().find_map(|size| size.step.as_ref().err()))),
        ],
    )
}

pub(super) fn solvers(outcome: &Outcome) -> Grid {
    let rows = outcome.solvers.iter().map(|row| (row, outcome.over_native(row)));
    Grid::of::<(&SolverRow, Option<f64>)>(
        rows,
        &[
            ("scene", |(row, _)| row.scene.clone()),
            ("problems", |(row, _)| row.problems.to_string()),
            ("rows", |(row, _)| short(row.rows)),
            ("solver", |(row, _)| row.solver.into()),
            ("tolerance", |(row, _)| format!("{:e}", row.tolerance)),
            ("us_per_problem", |(row, _)| short(1e6 * row.score.time.median)),
            ("us_lower", |(row, _)| short(1e6 * row.score.time.lower)),
            ("us_upper", |(row, _)| short(1e6 * row.score.time.upper)),
            ("us_least", |(row, _)| short(1e6 * row.score.time.least)),
            ("over_native", |(_, ratio)| number(*ratio, short)),
            ("residual", |(row, _)| format!("{:.1e}", row.score.residual)),
            ("iterations", |(row, _)| short(row.score.iterations)),
            ("most_iterations", |(row, _)| row.score.most_iterations.to_string()),
            ("factorisations", |(row, _)| short(row.score.factorisations)),
            ("refused", |(row, _)| row.score.refused.to_string()),
        ],
    )
}

/// Numbers beside their goals.
pub(super) fn checks(checks: &[Check]) -> Grid {
    fn figure(found: f64) -> String {
        if found.abs() < 1e-3 { small(found) } else { short(found) }
    }
    fn goal(check: &Check) -> String {
        let (sign, goal) = (check.relation.sign(), check.goal);
        if goal != 0.0 && goal < 1e-3 {
            format!("{sign} {goal:e}")
        } else {
            format!("{sign} {goal}")
        }
    }
    Grid::of::<&Check>(
        checks,
        &[
            ("what", |check| check.what.clone()),
            ("found", |check| number(check.found, figure)),
            ("goal", |check| goal(check)),
            ("holds", |check| match check.holds() {
                Some(true) => "yes".into(),
                Some(false) => "no".into(),
                None => "not measured".into(),
            }),
        ],
    )
}

pub(super) fn batch(outcome: &Outcome) -> Grid {
    Grid::of(
        &outcome.batch,
        &[
            ("scene", |row| row.scene.clone()),
            ("environments", |row| row.environments.to_string()),
            ("threads", |row| row.threads.to_string()),
            ("us_per_environment_step", |row| digits(1e6 * row.step.least)),
            ("steps_per_second", |row| format!("{:.0}", 1.0 / row.step.least)),
            ("efficiency", |row| short(row.efficiency)),
        ],
    )
}

/// For the terminal: the goals that this run says something of.
pub(super) fn judged(outcome: &Outcome) -> Grid {
    let mut found = goals(outcome);
    found.retain(|check| check.found.is_some());
    checks(&found)
}

/// For the terminal: times per step of the race.
pub(super) fn summary(outcome: &Outcome) -> Grid {
    Grid::of(
        &outcome.race,
        &[
            ("scene", |row| row.scene.clone()),
            ("dt", |row| short(row.dt)),
            ("engine", |row| row.engine.clone()),
            ("µs per step, least", |row| {
                row.us_least.map_or_else(|| row.note.clone(), |us| format!("{us:.3}"))
            }),
            ("gradient", |row| number(row.gradient, |multiple| format!("{multiple:.1} ×"))),
        ],
    )
}
