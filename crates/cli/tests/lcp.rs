//! `tangency lcp`: files, answers and refusals.

use std::fs;
use std::path::{Path, PathBuf};

use tangency::lcp::RawSolver;
use tangency::raw_solvers;
use tangency_cli::lcp::{LcpFileError, Problem, read_problem};

fn solvers() -> Vec<Box<dyn RawSolver>> {
    let list = raw_solvers();
    assert!(!list.is_empty(), "this build has no backend");
    list
}

/// A file of this name and text in a folder that lives as long as the test.
fn written(folder: &tempfile::TempDir, name: &str, text: &str) -> PathBuf {
    let file = folder.path().join(name);
    fs::write(&file, text).expect("the temporary folder is writable");
    file
}

#[track_caller]
fn refused(file: &Path, q: Option<&Path>, words: &[&str]) {
    let error = read_problem(file, q, None).expect_err("refused").to_string();
    assert!(error.starts_with(&*file.display().to_string()) || q.is_some(), "{error}");
    for word in words {
        assert!(error.contains(word), "{word:?} is not in {error:?}");
    }
}

const MIXED: &str = r#"{"kind": "lcp", "n": 2, "M": [[0,0,2], [0,1,-1], [1,0,1]], "q": [-4, -3],
                        "free": 1}"#;

#[test]
fn a_mixed_problem_as_json_and_as_matrix_market() {
    // w₁ = 2 z₁ − z₂ − 4 = 0,   w₂ = z₁ − 3 ≥ 0 ⟂ z₂: z = (3, 2).
    let folder = tempfile::tempdir().expect("a folder");
    let json = read_problem(&written(&folder, "p.json", MIXED), None, None).expect("a problem");
    let matrix =
        "%%MatrixMarket matrix coordinate real general\n% M\n2 2 3\n1 1 2\n1 2 -1\n2 1 1\n";
    let q = written(&folder, "q.mtx", "%%MatrixMarket matrix array real general\n2 1\n-4\n-3\n");
    let matrix = written(&folder, "M.mtx", matrix);
    let market = read_problem(&matrix, Some(&q), Some(1)).expect("a problem");
    assert_eq!(json, market);
    for solver in solvers() {
        let solution = json.solve(&*solver).expect("solved");
        assert!((solution.z[0] - 3.0).abs() + (solution.z[1] - 2.0).abs() < 1e-12);
        let derivative = json.derivative(&solution).expect("regular");
        let exact = [0.0, 1.0, -1.0, -2.0]; // z₁ = −q₂, z₂ = 2 z₁ + q₁, by columns
        for (found, exact) in derivative.iter().zip([exact[0], exact[1], exact[2], exact[3]]) {
            assert!((found - exact).abs() < 1e-12, "{derivative}");
        }
    }
    assert_eq!(json.describe(), "mixed complementarity problem, 2 unknowns, 1 of them free");
}

#[test]
fn one_sliding_contact() {
    let text = r#"{"kind": "friction2d_local", "n_contacts": 1, "W": [[0,0,2],[1,1,0.5]],
                   "q": [-1, 3], "mu": [0.4]}"#;
    let folder = tempfile::tempdir().expect("a folder");
    let problem = read_problem(&written(&folder, "p.json", text), None, None).expect("a problem");
    for solver in solvers() {
        let solution = problem.solve(&*solver).expect("solved");
        assert!(problem.residual(&solution) <= 1e-12);
        let [(_, r), (_, u)] = problem.pair(&solution);
        assert!((r[0] - 0.5).abs() + (r[1] + 0.2).abs() + (u[1] - 2.9).abs() < 1e-12, "{r} {u}");
        // rₙ = −qₙ/2 and r_t = −μ rₙ.
        let derivative = problem.derivative(&solution).expect("regular");
        for (found, exact) in derivative.iter().zip([-0.5, 0.2, 0.0, 0.0]) {
            assert!((found - exact).abs() < 1e-12, "{derivative}");
        }
    }
}

#[test]
fn wrong_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| written(&folder, name, text);
    refused(&folder.path().join("none.json"), None, &["cannot be read"]);
    refused(&write("a.json", "{"), None, &["line 1", "README"]);
    refused(&write("b.json", r#"{"kind": "lcp", "M": []}"#), None, &["`q`"]);
    refused(&write("c.json", r#"{"kind": "milp", "q": []}"#), None, &["milp", "lcp"]);
    let outside = r#"{"kind": "lcp", "M": [[0, 2, 1.0]], "q": [1, 1]}"#;
    refused(&write("d.json", outside), None, &["M[0]", "row 0, column 2", "end at 1"]);
    let mu = r#"{"kind": "friction2d_local", "W": [], "q": [1, 1], "mu": [-1]}"#;
    let error = read_problem(&write("e.json", mu), None, None).expect_err("refused");
    assert!(matches!(error, LcpFileError::Problem { .. }), "{error}");
    let matrix = write("M.mtx", "%%MatrixMarket matrix coordinate real general\n1 1 1\n2 1 1\n");
    refused(&matrix, None, &["`q`", "--q"]);
    refused(&matrix, Some(&matrix), &["line 3", "counted from 1"]);
    let complex = write("C.mtx", "%%MatrixMarket matrix coordinate complex general\n");
    refused(&complex, Some(&complex), &["line 1", "real"]);
    let short = write("S.mtx", "%%MatrixMarket matrix array real symmetric\n2 2\n1\n2\n");
    refused(&short, Some(&short), &["2 entries", "says 3"]);
    let wide = "%%MatrixMarket matrix coordinate real symmetric\n1 2 1\n1 2 1\n";
    let wide = write("W.mtx", wide);
    refused(&wide, Some(&wide), &["line 2", "1 rows, 2 columns", "is square"]);
    let skew = "%%MatrixMarket matrix coordinate real skew-symmetric\n2 2 1\n1 1 1\n";
    let skew = write("K.mtx", skew);
    refused(&skew, Some(&skew), &["line 3", "diagonal", "leave it out"]);
    let long = write("L.mtx", &"x".repeat(10_000));
    let error = read_problem(&long, Some(&long), None).expect_err("refused").to_string();
    assert!(error.len() < 1000, "{} bytes are no message", error.len());
}

#[test]
fn encodings() {
    let folder = tempfile::tempdir().expect("a folder");
    let marked = written(&folder, "marked.json", &format!("\u{feff}{MIXED}"));
    read_problem(&marked, None, None).expect("a byte order mark is no fault");
    let file = folder.path().join("latin.json");
    fs::write(&file, b"{\"kind\": \"\xfc\"}").expect("the temporary folder is writable");
    refused(&file, None, &["offset 10", "not UTF-8", "save the file as UTF-8"]);
}

/// A fault of the problem's, not of the file's: every backend says that there is no solution.
#[test]
fn an_infeasible_problem() {
    let infeasible = r#"{"kind": "lcp", "M": [[0,1,-1], [1,0,1]], "q": [-1, 0]}"#;
    let folder = tempfile::tempdir().expect("a folder");
    let file = written(&folder, "p.json", infeasible);
    let problem: Problem = read_problem(&file, None, None).expect("a problem");
    for solver in solvers() {
        problem.solve(&*solver).expect_err("infeasible");
    }
}
