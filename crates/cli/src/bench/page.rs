//! The page: one HTML file with all tables and figures, readable without a network.

use std::fmt::Write as _;

use tangency_view::escape_html;

use super::digits::{digits, grouped, number, short, small};
use super::figures::{Section, Shown};
use super::goals::goals;
use super::gradient_rows;
use super::outcome::Outcome;
use super::plan::Plan;
use super::provenance::Provenance;
use super::row::Row;
use super::tables::{batch, checks, exponents, paths, solvers};
use crate::grid::Grid;

const TEMPLATE: &str = include_str!("page.html");

/// The page's text.
pub(super) fn page(
    outcome: &Outcome,
    figures: &[Shown],
    provenance: &Provenance,
    plan: &Plan,
) -> String {
    let facts = provenance
        .facts
        .iter()
        .map(|(name, value)| format!("<tr><th>{name}</th><td>{}</td></tr>", escape_html(value)));
    let settings = outcome.settings.iter().map(|(engine, settings)| {
        format!("<tr><th>{}</th><td>{}</td></tr>", escape_html(engine), escape_html(settings))
    });
    let extent = if plan.quick {
        "A quick run: few rounds and small scenes, to see that everything works. For figures to quote, \
         run without --quick."
    } else {
        ""
    };
    let fill = [
        ("@FACTS@", facts.collect()),
        ("@SETTINGS@", settings.collect()),
        ("@EXTENT@", extent.to_owned()),
        ("@ROUNDS@", plan.patience.rounds.to_string()),
        ("@RACE@", race(&outcome.race)),
        ("@PATHS@", table(&paths(outcome))),
        ("@PRECISION@", charts(figures, Section::Precision)),
        ("@STOPPED@", stopped(outcome)),
        ("@GROWTH@", charts(figures, Section::Growth)),
        ("@EXPONENTS@", table(&exponents(outcome))),
        ("@SOLVERS@", charts(figures, Section::Solvers)),
        ("@SCORES@", table(&solvers(outcome))),
        ("@LEAN@", table(&checks(&outcome.lean))),
        ("@GOALS@", table(&checks(&goals(outcome)))),
        ("@GRADIENTS@", table(&gradient_rows::grid(outcome))),
        ("@BATCH@", table(&batch(outcome))),
    ];
    fill.iter().fold(TEMPLATE.to_owned(), |page, (mark, text)| page.replace(mark, text))
}

fn charts(figures: &[Shown], section: Section) -> String {
    let mine = figures.iter().filter(|figure| figure.section == section);
    let figure = |figure: &Shown| {
        format!("<figure aria-label=\"{}\">{}</figure>\n", escape_html(&figure.title), figure.svg)
    };
    mine.map(figure).collect()
}

/// A grid as a table of HTML; numbers to the right.
fn table(grid: &Grid) -> String {
    let mut rows = grid.rows().iter();
    let Some(heading) = rows.next() else { return String::new() };
    if rows.len() == 0 {
        return "<p>Not measured in this run.</p>".into();
    }
    let mut html = String::from("<div class=\"wide\"><table><thead><tr>");
    for cell in heading {
        let _ = write!(html, "<th>{}</th>", escape_html(&cell.replace('_', " ")));
    }
    html.push_str("</tr></thead><tbody>");
    for row in rows {
        html.push_str("<tr>");
        html.extend(row.iter().map(|text| cell(text)));
        html.push_str("</tr>\n");
    }
    html.push_str("</tbody></table></div>");
    html
}

fn cell(text: &str) -> String {
    let class = if text.parse::<f64>().is_ok() { " class=\"number\"" } else { "" };
    format!("<td{class}>{}</td>", escape_html(text))
}

/// The race: a group of rows per scene, the fastest first.
fn race(rows: &[Row]) -> String {
    if rows.is_empty() {
        return "<tbody><tr><td colspan=\"11\">Not measured in this run.</td></tr></tbody>".into();
    }
    let mut html = String::new();
    let mut groups: Vec<(&str, f64)> = Vec::new();
    for row in rows {
        if !groups.contains(&(&row.scene, row.dt)) {
            groups.push((&row.scene, row.dt));
        }
    }
    for (scene, dt) in groups {
        let mut mine: Vec<&Row> =
            rows.iter().filter(|row| row.scene == scene && row.dt == dt).collect();
        let time = |row: &Row| row.us_least.unwrap_or(f64::INFINITY);
        mine.sort_by(|a, b| time(a).total_cmp(&time(b)));
        let own = mine.iter().find(|row| row.engine.starts_with("tangency"));
        let own = own.and_then(|row| row.us_least);
        let _ = write!(
            html,
            "<tbody><tr class=\"group\"><th colspan=\"11\">{}, dt = {} s</th></tr>",
            escape_html(scene),
            short(dt)
        );
        html.extend(mine.iter().map(|row| line(row, own)));
        html.push_str("</tbody>\n");
    }
    html
}

fn line(row: &Row, own: Option<f64>) -> String {
    let spread = match (row.us_lower, row.us_upper) {
        (Some(lower), Some(upper)) => format!("{} – {}", digits(lower), digits(upper)),
        _ => String::new(),
    };
    let ratio = row.us_least.zip(own).map(|(us, own)| us / own);
    let cells = [
        number(row.us_least, digits),
        number(row.us_per_step, digits),
        spread,
        number(row.us_least, |us| grouped(1e6 / us)),
        number(ratio, |ratio| format!("{ratio:.2}")),
        number(row.penetration, small),
        number(row.drift, small),
        number(row.residual, small),
        number(row.factorisations, |x| format!("{x:.2}")),
        row.gradient.map_or_else(|| absent(&row.note).into(), |multiple| format!("{multiple:.1}")),
    ];
    let class = if row.engine.starts_with("tangency") { " class=\"own\"" } else { "" };
    let mut html = format!("<tr{class}><th>{}", escape_html(&row.engine));
    if !row.note.is_empty() && absent(&row.note).is_empty() {
        let _ = write!(html, " <small>{}</small>", escape_html(&row.note));
    }
    html.push_str("</th>");
    for cell in cells {
        let _ = write!(html, "<td class=\"number\">{cell}</td>");
    }
    html + "</tr>\n"
}

/// What a note says of a gradient that is not there, if it says nothing else.
fn absent(note: &str) -> &'static str {
    match note {
        "no gradient" => "none",
        "gradient refused" => "refused",
        _ => "",
    }
}

/// Engines that ended a sweep early, and why.
fn stopped(outcome: &Outcome) -> String {
    let mut html = String::new();
    for (case, fronts) in &outcome.precision {
        for front in fronts {
            if let Some(refusal) = &front.stopped {
                let text = escape_html(&refusal.to_string());
                let _ =
                    write!(html, "<li>{}, {}: {text}</li>", case.id, escape_html(&front.engine));
            }
        }
    }
    if html.is_empty() { html } else { format!("<p>Not run, or not further:</p><ul>{html}</ul>") }
}
