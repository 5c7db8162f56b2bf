//! The table of all figures, as CSV and as a page of Markdown.

use std::fmt::{self, Display, Write as _};
use std::io;

use crate::{Figure, Grade, Relation, Tally, Verdict};

/// What all cases came to on one backend.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// The backend's name.
    pub backend: String,
    /// The figures, in the order of the cases.
    pub figures: Vec<Figure>,
    /// What the steps took.
    pub tally: Tally,
}

impl Report {
    /// Number of figures of a verdict.
    #[must_use]
    pub fn count(&self, verdict: Verdict) -> usize {
        self.figures.iter().filter(|figure| figure.verdict == verdict).count()
    }

    /// Figures of plain stepping that are outside their tolerance.
    pub fn failures(&self) -> impl Iterator<Item = &Figure> {
        self.figures.iter().filter(|figure| figure.verdict == Verdict::Failed)
    }

    /// One line: how many passed, failed, are not reached and were refused.
    #[must_use]
    pub fn summary(&self) -> String {
        let [passed, failed, open, refused] =
            [Verdict::Passed, Verdict::Failed, Verdict::NotReached, Verdict::Refused]
                .map(|verdict| self.count(verdict));
        format!("{passed} passed, {failed} failed, {open} not reached yet, {refused} refused")
    }
}

/// Writes the figures of all reports as CSV, a header first.
///
/// # Errors
/// What writing reports.
pub fn write_csv(reports: &[Report], to: impl io::Write) -> Result<(), csv::Error> {
    let mut csv = csv::Writer::from_writer(to);
    csv.write_record([
        "backend",
        "case",
        "quantity",
        "grade",
        "relation",
        "expected",
        "got",
        "error",
        "tolerance",
        "verdict",
        "note",
    ])?;
    for report in reports {
        for f in &report.figures {
            let numbers = [f.expected, f.got, f.error, f.tolerance].map(|x| x.to_string());
            let [expected, got, error, tolerance] = &numbers;
            csv.write_record([
                &report.backend,
                f.case,
                &f.quantity,
                grade(f.grade),
                relation(f.relation),
                expected,
                got,
                error,
                tolerance,
                verdict(f.verdict),
                &f.note,
            ])?;
        }
    }
    csv.flush()?;
    Ok(())
}

/// The page: per backend a summary, what the steps took, and the table.
#[must_use]
pub fn markdown(reports: &[Report], titles: &[(&str, &str)]) -> String {
    let mut page = String::from(INTRODUCTION);
    for report in reports {
        let _ = write!(page, "\n## {}\n\n{}.\n\n", report.backend, report.summary());
        let _ = writeln!(page, "{}.\n", Took(&report.tally));
        page.push_str(&overview(report, titles));
        let mut case = "";
        for figure in &report.figures {
            if figure.case != case {
                case = figure.case;
                let title = titles.iter().find(|(id, _)| *id == case).map_or("", |(_, t)| t);
                let _ = write!(page, "\n### {case} {title}\n\n{HEADER}");
            }
            let _ = writeln!(page, "{}", Line(figure));
        }
    }
    page
}

/// A line per case: how many figures came to what.
fn overview(report: &Report, titles: &[(&str, &str)]) -> String {
    let mut table = String::from(
        "| case | | passed | failed | not reached yet | refused |\n|---|---|--:|--:|--:|--:|\n",
    );
    for (case, title) in titles {
        let count = |verdict| {
            let of_case = report.figures.iter().filter(|f| f.case == *case);
            of_case.filter(|f| f.verdict == verdict).count()
        };
        let [passed, failed, open, refused] =
            [Verdict::Passed, Verdict::Failed, Verdict::NotReached, Verdict::Refused].map(count);
        let _ = writeln!(table, "| {case} | {title} | {passed} | {failed} | {open} | {refused} |");
    }
    table
}

const INTRODUCTION: &str = "# Validation

Physics with known answers: closed forms, conservation laws, exact rational solutions and references of
high precision, against what the engine makes of them. `tangency validate --long` writes this page and the
same table as CSV; `tangency validate V05` measures one case. The tests run the same cases.

A figure without further words is one that plain fixed stepping must meet. Those marked *fine* and *impact*
belong to steppings that locate events inside a step: in V34, V36 and V37 they are measured with steps divided
at impacts, elsewhere with `accurate` steps of a millisecond. What is *not reached yet* stands in the list, so that
nothing hides: of V04 the time at which infinitely many bounces are over, which is right to a step. *Refused*
means that a backend said that a matrix is not of the class that it solves.
";

const HEADER: &str =
    "| quantity | expected | got | error | tolerance | |\n|---|--:|--:|--:|--:|---|\n";

/// A line of the table.
pub struct Line<'a>(pub &'a Figure);

impl Display for Line<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Figure { quantity, expected, got, error, tolerance, note, .. } = self.0;
        let quantity = quantity.replace('|', "\\|");
        let told = told(self.0);
        if expected.is_nan() {
            let note = note.replace('|', "\\|").replace('\n', " ");
            return write!(f, "| {quantity} | | | | | {told}: {note} |");
        }
        let sign = match self.0.relation {
            Relation::Near => "",
            Relation::AtLeast => "≥ ",
            Relation::AtMost => "≤ ",
        };
        let (expected, got) = (number(*expected), number(*got));
        write!(
            f,
            "| {quantity} | {sign}{expected} | {got} | {error:.1e} | {tolerance:.1e} | {told} |"
        )
    }
}

/// What the steps took, in words.
pub struct Took<'a>(pub &'a Tally);

impl Display for Took<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Tally { steps, refused, problems, residual, factorisations } = self.0;
        write!(f, "{steps} steps, {refused} refused; worst residual {residual:.1e}; problems: ")?;
        let counts = problems.iter().map(|(method, n)| format!("{n} by {}", Tally::name(*method)));
        let counts: Vec<String> = counts.collect();
        write!(f, "{}; {factorisations} factorisations", counts.join(", "))
    }
}

/// Up to 12 digits, without those that say nothing.
fn number(x: f64) -> String {
    if x == 0.0 || (1e-4..1e7).contains(&x.abs()) {
        let text = format!("{x:.12}");
        let text = text.trim_end_matches('0').trim_end_matches('.');
        return text.to_owned();
    }
    format!("{x:.6e}")
}

fn told(figure: &Figure) -> &'static str {
    match (figure.verdict, figure.grade) {
        (Verdict::Passed, Grade::Step) => "passed",
        (Verdict::Passed, Grade::Fine) => "passed (fine)",
        (Verdict::Passed, Grade::Impact) => "passed (impact)",
        (Verdict::Failed, _) => "**failed**",
        (Verdict::NotReached, Grade::Impact) => "not reached yet (impact)",
        (Verdict::NotReached, _) => "not reached yet (fine)",
        (Verdict::Refused, _) => "refused",
    }
}

fn grade(grade: Grade) -> &'static str {
    match grade {
        Grade::Step => "step",
        Grade::Fine => "fine",
        Grade::Impact => "impact",
    }
}

fn relation(relation: Relation) -> &'static str {
    match relation {
        Relation::Near => "near",
        Relation::AtLeast => "at least",
        Relation::AtMost => "at most",
    }
}

fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Passed => "passed",
        Verdict::Failed => "failed",
        Verdict::NotReached => "not reached",
        Verdict::Refused => "refused",
    }
}
