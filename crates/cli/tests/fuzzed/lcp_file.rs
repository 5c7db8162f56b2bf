//! What must hold of any bytes that are offered as the file of a complementarity problem.

use std::path::Path;

use tangency_cli::lcp::{Problem, parse_json, parse_matrix_market};

/// Greatest residual of a solution.
const ACCEPTED: f64 = 1e-10;
/// Larger problems are not solved: they would say the same, slowly.
const MOST_UNKNOWNS: usize = 30;

const HEADER: &str = "%%MatrixMarket";

/// The bytes are refused by a typed error, or make a problem for which every backend finds a
/// solution, which its residual confirms, or says that it found none. Says whether a problem came of
/// them.
pub(crate) fn check(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    let file = Path::new("fuzzed");
    // Two Matrix Market files stand one after the other.
    let problem = match text.strip_prefix(HEADER).and_then(|rest| rest.find(HEADER)) {
        Some(at) => {
            let (matrix, q) = text.split_at(at + HEADER.len());
            parse_matrix_market([file; 2], [matrix, q], None)
        }
        None => parse_json(file, text, None),
    };
    let Ok(problem) = problem else { return false };
    if size(&problem) <= MOST_UNKNOWNS {
        check_problem(&problem);
    }
    true
}

fn size(problem: &Problem) -> usize {
    match problem {
        Problem::Lcp(problem) => problem.q.len(),
        Problem::Friction(problem) => problem.q.len(),
    }
}

fn check_problem(problem: &Problem) {
    for solver in tangency::raw_solvers() {
        let name = solver.name();
        match problem.solve(&*solver) {
            Ok(solution) => {
                let residual = problem.residual(&solution);
                assert!(residual <= ACCEPTED, "{name}: residual {residual:e}, {problem:?}");
                let pair = problem.pair(&solution);
                let numbers = pair.iter().flat_map(|(_, x)| x.iter());
                assert!(numbers.into_iter().all(|x| x.is_finite()), "{name}: {problem:?}");
                if let Ok(derivative) = problem.derivative(&solution) {
                    let finite = derivative.iter().all(|x| x.is_finite());
                    assert!(finite, "{name}: derivative {derivative}, {problem:?}");
                }
            }
            Err(refusal) => assert!(!refusal.to_string().is_empty()),
        }
    }
}
