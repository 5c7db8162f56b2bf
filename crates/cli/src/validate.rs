//! `tangency validate`: measures physics with known answers on the backends of this build.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use tangency::{BACKENDS, raw_solvers, solvers};
use tangency_validation::report::{Line, Report, Took, markdown, write_csv};
use tangency_validation::{Backend, Case, Verdict, cases, measure};

use crate::{Console, Failure};

/// The options of `validate`.
#[derive(Args, Debug)]
pub struct Arguments {
    /// Only these cases, as in `V05` [default: all]
    pub cases: Vec<String>,
    /// Only this backend [default: all of this build that take scenes of any size]
    #[arg(long)]
    pub backend: Option<String>,
    /// Also the parts that take minutes
    #[arg(long)]
    pub long: bool,
    /// Folder for validation.csv and validation.md
    #[arg(long, default_value = "out/validate")]
    pub out: PathBuf,
}

/// Runs the subcommand.
///
/// # Errors
/// A name that nothing has, a figure outside its tolerance, or a file that cannot be written.
pub fn run(arguments: &Arguments, console: &Console) -> Result<(), Failure> {
    let chosen = chosen_cases(&arguments.cases)?;
    let backends = chosen_backends(arguments.backend.as_deref())?;
    let progress = console.progress(chosen.len() * backends.len(), "cases");
    let mut reports = Vec::new();
    for backend in &backends {
        let mut report = Report { backend: backend.name.into(), ..Report::default() };
        for case in &chosen {
            let (figures, tally) = measure(case, backend, arguments.long);
            report.figures.extend(figures);
            report.tally.add(&tally);
            progress.inc(1);
        }
        reports.push(report);
    }
    progress.finish_and_clear();
    for report in &reports {
        tell(report, console);
    }
    let page = write(&reports, &chosen, &arguments.out)?;
    console.say(format_args!("\nthe whole table: {}", page.display()));
    let failed = reports.iter().map(|report| report.count(Verdict::Failed)).sum();
    if failed == 0 { Ok(()) } else { Err(Failure::Invalid { failed }) }
}

fn chosen_cases(names: &[String]) -> Result<Vec<&'static Case>, Failure> {
    let all = cases();
    let find = |name: &String| {
        all.iter().copied().find(|case| case.id.eq_ignore_ascii_case(name)).ok_or_else(|| {
            let known = all.iter().map(|case| case.id).collect::<Vec<_>>().join(", ");
            Failure::UnknownCase { name: name.clone(), known }
        })
    };
    if names.is_empty() { Ok(all.clone()) } else { names.iter().map(find).collect() }
}

fn chosen_backends(name: Option<&str>) -> Result<Vec<Backend>, Failure> {
    let solvers = BACKENDS.iter().zip(solvers().into_iter().zip(raw_solvers()));
    let mut all: Vec<Backend> =
        solvers.map(|(name, (solver, raw))| Backend { name, solver, raw }).collect();
    let known = all.iter().map(|backend| backend.name).collect::<Vec<_>>().join(", ");
    all.retain(|backend| name.is_none_or(|name| name == backend.name));
    match name {
        Some(name) if all.is_empty() => {
            Err(Failure::UnknownBackend { name: name.to_owned(), known })
        }
        _ => Ok(all),
    }
}

fn tell(report: &Report, console: &Console) {
    for figure in report.failures() {
        console.say(format_args!("{} {} {}", report.backend, figure.case, Line(figure)));
    }
    console.say(format_args!("\n{}: {}", report.backend, report.summary()));
    console.say(Took(&report.tally));
}

fn write(reports: &[Report], cases: &[&Case], out: &Path) -> Result<PathBuf, Failure> {
    let failed = |file: &Path| {
        let file = file.to_path_buf();
        move |source| Failure::Write { file, source }
    };
    fs::create_dir_all(out).map_err(failed(out))?;
    let table = out.join("validation.csv");
    let file = fs::File::create(&table).map_err(failed(&table))?;
    write_csv(reports, file).map_err(|error| failed(&table)(std::io::Error::other(error)))?;
    let page = out.join("validation.md");
    let titles: Vec<(&str, &str)> = cases.iter().map(|case| (case.id, case.title)).collect();
    fs::write(&page, markdown(reports, &titles)).map_err(failed(&page))?;
    Ok(page)
}
