//! The problems of other people's collections in `tests/data/lcp-problems`.

use nalgebra::{DMatrix, DVector};
use serde_json::Value;
use tangency::lcp::{LcpError, RawFriction, RawLcp, RawSolution, RawSolver};
use tangency::raw_solvers;

/// A problem of the collection.
enum Problem {
    Lcp(RawLcp),
    Friction(RawFriction),
}

impl Problem {
    fn read(value: &Value) -> Self {
        let numbers = |key: &str| -> Vec<f64> {
            let list = value[key].as_array().expect(key);
            list.iter().map(|x| x.as_f64().expect("a number")).collect()
        };
        let q = DVector::from_vec(numbers("q"));
        let matrix = |key: &str| {
            let mut matrix = DMatrix::zeros(q.len(), q.len());
            for entry in value[key].as_array().expect(key) {
                let at = |k: usize| {
                    usize::try_from(entry[k].as_u64().expect("an index")).expect("a small one")
                };
                matrix[(at(0), at(1))] = entry[2].as_f64().expect("a number");
            }
            matrix
        };
        if value["kind"] == "lcp" {
            Self::Lcp(RawLcp { free: 0, matrix: matrix("M"), q })
        } else {
            Self::Friction(RawFriction { matrix: matrix("W"), mu: numbers("mu"), q })
        }
    }

    fn solve(&self, solver: &dyn RawSolver) -> Result<RawSolution, LcpError> {
        match self {
            Self::Lcp(problem) => solver.solve_raw(problem),
            Self::Friction(problem) => solver.solve_friction(problem),
        }
    }

    /// The residual of what a solver calls a solution.
    fn residual(&self, solution: &RawSolution) -> f64 {
        match self {
            Self::Lcp(problem) => problem.residual(&solution.z),
            Self::Friction(problem) => problem.residual(&problem.reactions(&solution.z)),
        }
    }
}

fn collection() -> Vec<(String, Problem, bool)> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/lcp-problems");
    let entries = std::fs::read_dir(folder).expect("the collection");
    let mut files: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
    files.retain(|file| file.extension().is_some_and(|e| e == "json"));
    files.sort();
    let read = |file: std::path::PathBuf| {
        let text = std::fs::read_to_string(&file).expect("a file");
        let value: Value = serde_json::from_str(&text).expect("JSON");
        let trusted = ["known_solution", "reference_z", "reference_reaction"]
            .iter()
            .any(|key| !value[*key].is_null());
        let name = value["name"].as_str().expect("a name").to_owned();
        (name, Problem::read(&value), trusted)
    };
    files.into_iter().map(read).collect()
}

/// What has a trusted reference is solved by at least one backend; what any backend calls solved is.
#[test]
fn problems_of_others() {
    let all = collection();
    assert!(all.len() >= 32, "{} problems", all.len());
    let solvers = raw_solvers();
    assert!(!solvers.is_empty(), "this build has no backend");
    let convex_only = solvers.iter().all(|solver| solver.name() == "clarabel");
    let mut unsolved = Vec::new();
    for (name, problem, trusted) in &all {
        let mut solved = false;
        let mut outside = false;
        for solver in &solvers {
            match problem.solve(&**solver) {
                Ok(solution) => {
                    let residual = problem.residual(&solution);
                    assert!(residual <= 1e-10, "{name}, {}: {residual:e}", solver.name());
                    solved = true;
                }
                Err(error) => {
                    outside |= matches!(error, LcpError::OutsideClass { .. });
                }
            }
        }
        if *trusted && !solved && !(convex_only && outside) {
            unsolved.push(name);
        }
    }
    assert!(unsolved.is_empty(), "{unsolved:?}");
}
