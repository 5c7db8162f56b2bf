//! The figures.

use std::path::Path;

use tangency_bench::growth::Curve as Growth;
use tangency_bench::precision::{Case, Front};

use super::outcome::{ALL, Outcome, SolverRow};
use super::tables::LARGE;
use crate::Failure;
use crate::plot::{Axis, Chart, Curve, save};

/// A figure that the page shows.
pub(super) struct Shown {
    /// The section that it belongs to.
    pub(super) section: Section,
    /// What it shows, for readers who cannot see it.
    pub(super) title: String,
    /// The file's text.
    pub(super) svg: String,
}

/// Sections with figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Section {
    Precision,
    Growth,
    Solvers,
}

/// Draws and writes all figures, and returns them.
pub(super) fn save_all(outcome: &Outcome, folder: &Path) -> Result<Vec<Shown>, Failure> {
    let mut shown = Vec::new();
    let mut add = |section, chart: Chart, stem: String| {
        let [svg, _] = save(&chart, &folder.join(stem))?;
        let text = std::fs::read_to_string(&svg)
            .map_err(|source| Failure::Read { file: svg.clone(), source })?;
        shown.push(Shown { section, title: chart.title, svg: text });
        Ok::<(), Failure>(())
    };
    for (case, fronts) in &outcome.precision {
        add(Section::Precision, precision(case, fronts), format!("precision-{}", case.id))?;
    }
    for (family, curves) in &outcome.growth {
        add(Section::Growth, growth(family, curves), format!("growth-{family}"))?;
    }
    if outcome.solvers.iter().any(|row| row.scene == ALL) {
        add(Section::Solvers, solvers(&outcome.solvers), "solvers".into())?;
    }
    Ok(shown)
}

/// Colour and dash of an engine, the same in every figure.
fn style(engine: &str) -> (usize, bool) {
    match engine {
        _ if engine.ends_with("projected") => (5, false),
        _ if engine.contains("clarabel") => (2, false),
        _ if engine.starts_with("tangency") || engine == "interior point" => (0, false),
        _ if engine.contains("16 it") => (4, false),
        _ if engine.starts_with("rapier") => (1, false),
        _ => (3, false),
    }
}

fn curve(engine: &str, points: Vec<(f64, f64)>) -> Curve {
    let (color, dashed) = style(engine);
    Curve { label: engine.into(), points, color, marks: true, dashed }
}

/// Smaller errors are drawn here; a logarithmic axis has no zero.
const FLOOR: f64 = 1e-16;

fn precision(case: &Case, fronts: &[Front]) -> Chart {
    let mut curves = Vec::new();
    let shown = fronts.iter().filter(|front| !front.points.is_empty());
    for front in shown {
        let error = |point: &tangency_bench::precision::Point| point.error.state().max(FLOOR);
        let value = front.points.iter().map(|p| (error(p), 1e3 * p.time.least)).collect();
        curves.push(curve(&front.engine, value));
        let first = curves.len() == 1;
        let both = front
            .points
            .iter()
            .filter_map(|p| p.with_gradient.map(|time| (error(p), 1e3 * time.least)));
        let both: Vec<(f64, f64)> = if first { both.collect() } else { Vec::new() };
        if !both.is_empty() {
            let label = format!("{}, value and gradient (dashed)", front.engine);
            curves.push(Curve { label, dashed: true, ..curve(&front.engine, both) });
        }
    }
    Chart {
        title: format!("{} {}: time against error", case.id, case.title),
        subtitle: format!(
            "a mark per time step, 1/30 s and halves of it; {} s long; reference: {}",
            case.duration, case.source
        ),
        x: Axis::log("worst error of position, angle and velocity, scaled"),
        y: Axis::log("least time per simulated second, ms"),
        curves,
        level: None,
    }
}

fn growth(family: &str, growths: &[Growth]) -> Chart {
    let line = |growth: &Growth| {
        let place = |size: &tangency_bench::growth::Size| {
            size.step.as_ref().ok().map(|step| (size.bodies as f64, 1e6 * step.least))
        };
        let points = growth.sizes.iter().filter_map(place).collect();
        let exponent = growth.exponent(LARGE);
        let label = exponent
            .map_or_else(|| growth.engine.clone(), |p| format!("{}: n^{p:.2}", growth.engine));
        Curve { label, ..curve(&growth.engine, points) }
    };
    Chart {
        title: format!("Time per step over the size of a {family}"),
        subtitle: format!("dt = 1/60 s; exponents fitted from {LARGE} bodies on"),
        x: Axis::log("bodies"),
        y: Axis::log("least time per step, µs"),
        curves: growths.iter().map(line).collect(),
        level: None,
    }
}

/// Time against the residual reached, over tolerances, on all recorded problems.
fn solvers(rows: &[SolverRow]) -> Chart {
    let mut curves: Vec<Curve> = Vec::new();
    for row in rows.iter().filter(|row| row.scene == ALL) {
        let point = (row.score.residual.max(FLOOR), 1e6 * row.score.time.least);
        match curves.iter_mut().find(|curve| curve.label == row.solver) {
            Some(curve) => curve.points.push(point),
            None => curves.push(curve(row.solver, vec![point])),
        }
    }
    Chart {
        title: "Solvers alone on recorded problems".into(),
        subtitle: "without guesses; tolerances 10⁻³, 10⁻⁶, 10⁻⁹ and 10⁻¹²".into(),
        x: Axis::log("worst natural residual of all solutions"),
        y: Axis::log("least mean time per problem, µs"),
        curves,
        level: None,
    }
}
