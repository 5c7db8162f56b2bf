//! `tangency lcp`: solves a complementarity problem from a file with every backend of the build.

mod file;
mod matrix_market;

use std::fmt::Write as _;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use nalgebra::{DMatrix, DVector};
use tangency::lcp::{LcpError, RawSolution, RawSolver};
use tangency::{BACKENDS, raw_solvers};

pub use file::{LcpFileError, Problem, parse_json, parse_matrix_market, read_problem};

use crate::{Console, Failure, Table};

/// The options of `lcp`.
#[derive(Args, Debug)]
pub struct Arguments {
    /// JSON with `kind` `lcp` or `friction2d_local`, or a Matrix Market file with M
    pub file: PathBuf,
    /// The vector q, a Matrix Market file; needed if and only if FILE is one
    #[arg(long)]
    pub q: Option<PathBuf>,
    /// How many leading unknowns are free, with an equation each [default: the file's `free`, or 0]
    #[arg(long)]
    pub free: Option<usize>,
    /// Only this backend [default: all of this build]
    #[arg(long)]
    pub backend: Option<String>,
    /// Print the derivative of the solution by q
    #[arg(long)]
    pub sensitivity: bool,
}

/// Runs the subcommand.
///
/// # Errors
/// Bad input, or a problem that no backend solved.
pub fn run(arguments: &Arguments, console: &Console) -> Result<(), Failure> {
    let problem = read_problem(&arguments.file, arguments.q.as_deref(), arguments.free)?;
    console.say(format_args!("{}: {}", arguments.file.display(), problem.describe()));
    let mut solved = false;
    for (name, solver) in chosen(arguments.backend.as_deref())? {
        let start = Instant::now();
        let answer = problem.solve(solver.as_ref());
        let time = start.elapsed();
        let mut table = Table::default();
        table.row("backend", name);
        table.row("time", format_args!("{time:.1?}"));
        let text = match &answer {
            Ok(solution) => {
                solved = true;
                told(&problem, solution, &mut table, arguments.sensitivity)
            }
            Err(error) => {
                table.row("not solved", error);
                String::new()
            }
        };
        console.say(format_args!("\n{table}{text}"));
    }
    if solved { Ok(()) } else { Err(Failure::Unsolved { file: arguments.file.clone() }) }
}

/// A backend with its name.
type Named = (&'static str, Box<dyn RawSolver>);

fn chosen(name: Option<&str>) -> Result<Vec<Named>, Failure> {
    let all = BACKENDS.iter().copied().zip(raw_solvers());
    let chosen: Vec<_> = all.filter(|(known, _)| name.is_none_or(|name| name == *known)).collect();
    match name {
        Some(name) if chosen.is_empty() => {
            Err(Failure::UnknownBackend { name: name.to_owned(), known: BACKENDS.join(", ") })
        }
        _ => Ok(chosen),
    }
}

/// Fills the table of a solution; what follows it.
fn told(problem: &Problem, solution: &RawSolution, table: &mut Table, sensitivity: bool) -> String {
    table.row("residual", format_args!("{:.1e}", problem.residual(solution)));
    table.row("iterations", solution.iterations);
    if solution.pivots > 0 {
        table.row("pivots", solution.pivots);
    }
    table.row("locally unique", if solution.rank_defect == 0 { "yes" } else { "not shown" });
    if !solution.weak.is_empty() {
        table.row("on a switch", format_args!("unknowns {:?}", solution.weak));
    }
    let [(x, unknowns), (y, remainders)] = problem.pair(solution);
    table.row(x, listed(&unknowns));
    table.row(y, listed(&remainders));
    if !sensitivity {
        return String::new();
    }
    match problem.derivative(solution) {
        Ok(derivative) => format!("\nd{x}/dq\n{}", lines(&derivative)),
        Err(LcpError::NotConverged { .. }) => {
            let why = "the active columns depend on each other";
            format!("\nd{x}/dq does not exist: {why}")
        }
        Err(error) => format!("\nd{x}/dq: {error}"),
    }
}

fn listed(vector: &DVector<f64>) -> String {
    let numbers: Vec<String> = vector.iter().map(f64::to_string).collect();
    numbers.join(" ")
}

fn lines(matrix: &DMatrix<f64>) -> String {
    let mut text = String::new();
    for row in matrix.row_iter() {
        for entry in row.iter() {
            let _ = write!(text, " {entry:>14.6e}");
        }
        text.push('\n');
    }
    text
}
