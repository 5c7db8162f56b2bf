//! The tables in short, as Markdown: what docs/performance.md quotes.

use std::fmt::Write as _;

use tangency_bench::precision::Front;

use super::digits::{digits, number, short, small};
use super::goals::goals;
use super::gradient_rows;
use super::outcome::{ALL, HARD, Outcome};
use super::provenance::Provenance;
use super::row::Row;
use super::tables::{batch, checks, exponents};
use crate::grid::Grid;

/// All tables that have rows.
pub(super) fn markdown(outcome: &Outcome, provenance: &Provenance) -> String {
    let mut text = String::new();
    for (name, value) in &provenance.facts {
        let _ = writeln!(text, "- {name}: {value}");
    }
    let tables = [
        ("Goals", checks(&goals(outcome))),
        ("Race", race(&outcome.race)),
        ("Time against error", precision(outcome)),
        ("Growth", exponents(outcome)),
        ("Solvers alone", solvers(outcome)),
        ("Only what a scene needs", checks(&outcome.lean)),
        ("Gradients", gradient_rows::grid(outcome)),
        ("Batches", batch(outcome)),
    ];
    for (title, grid) in tables {
        if grid.rows().len() > 1 {
            let _ = write!(text, "\n### {title}\n\n{}", grid.markdown());
        }
    }
    text
}

fn race(rows: &[Row]) -> Grid {
    let mut grid = Grid::new([
        "scene",
        "dt, ms",
        "engine",
        "µs per step",
        "over ours",
        "penetration, m",
        "joint error, m",
        "residual",
        "factorisations",
        "gradient, × value",
    ]);
    for row in rows {
        let same = |other: &&Row| other.scene == row.scene && other.dt == row.dt;
        let own = rows.iter().filter(same).filter(|other| other.engine.starts_with("tangency"));
        let own = own.filter_map(|other| other.us_least).fold(f64::INFINITY, f64::min);
        let time = row.us_least.map_or_else(|| row.note.clone(), digits);
        grid.row([
            row.scene.clone(),
            short(1e3 * row.dt),
            row.engine.clone(),
            time,
            number(row.us_least.map(|us| us / own), digits),
            number(row.penetration, small),
            number(row.drift, small),
            number(row.residual, small),
            number(row.factorisations, |x| format!("{x:.2}")),
            number(row.gradient, |x| format!("{x:.1}")),
        ]);
    }
    grid
}

/// Errors, worst of position, angle and velocity, for which times are told.
const ERRORS: [f64; 3] = [1e-1, 1e-2, 1e-3];

/// The least time at which an engine is as accurate, for each of [`ERRORS`].
fn precision(outcome: &Outcome) -> Grid {
    let mut grid =
        Grid::new(["case", "engine", "ms per s to 10⁻¹", "to 10⁻²", "to 10⁻³", "least error"]);
    for (case, fronts) in &outcome.precision {
        for front in fronts.iter().filter(|front| !front.points.is_empty()) {
            let least = front.points.iter().map(|p| p.error.state()).fold(f64::INFINITY, f64::min);
            let times = ERRORS.map(|error| time_to(front, error));
            let start = [format!("{} {}", case.id, case.title), front.engine.clone()];
            grid.row(start.into_iter().chain(times).chain([format!("{least:.1e}")]));
        }
    }
    grid
}

fn time_to(front: &Front, error: f64) -> String {
    let enough = front.points.iter().filter(|point| point.error.state() <= error);
    let least = enough.map(|point| 1e3 * point.time.least).fold(f64::INFINITY, f64::min);
    if least.is_finite() { digits(least) } else { "—".into() }
}

fn solvers(outcome: &Outcome) -> Grid {
    let mut grid = Grid::new([
        "problems",
        "solver",
        "tolerance",
        "µs per problem",
        "residual",
        "iterations",
        "most",
        "factorisations",
        "refused",
    ]);
    for row in outcome.solvers.iter().filter(|row| row.scene == ALL || row.scene == HARD) {
        let score = &row.score;
        grid.row([
            format!("{} {}", row.problems, row.scene),
            row.solver.to_owned(),
            format!("{:e}", row.tolerance),
            digits(1e6 * score.time.least),
            format!("{:.1e}", score.residual),
            short(score.iterations),
            score.most_iterations.to_string(),
            short(score.factorisations),
            score.refused.to_string(),
        ]);
    }
    grid
}
