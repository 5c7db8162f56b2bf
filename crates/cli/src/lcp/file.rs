//! Files with complementarity problems: JSON as the collection in `tests/data/lcp-problems` has it,
//! and Matrix Market.
//!
//! ```text
//!  {"kind": "lcp", "n": 2, "M": [[0, 0, 2.0], [1, 1, 1.0]], "q": [-1, 0], "free": 0}
//!  {"kind": "friction2d_local", "n_contacts": 1, "W": [...], "q": [-1, 0.3], "mu": [0.5]}
//! ```
//!
//! Matrices are triplets `[row, column, value]` from zero; entries that are not given are zero, those
//! given twice add up. Other fields are ignored.

use std::io;
use std::path::{Path, PathBuf};

use nalgebra::{DMatrix, DVector};
use serde::Deserialize;
use tangency::lcp::{LcpError, RawFriction, RawLcp, RawSolution, RawSolver};

use super::matrix_market::matrix_of;

/// Dense matrices larger than this are refused.
pub(super) const MOST_UNKNOWNS: usize = 4000;

/// Of what was found this many characters are quoted.
const QUOTED: usize = 100;

/// Why a file is no problem.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LcpFileError {
    /// The file cannot be read.
    #[error("{}: cannot be read", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The bytes are no text.
    #[error("{}: the byte at offset {offset} is not UTF-8; save the file as UTF-8", file.display())]
    NotUtf8 {
        /// The file.
        file: PathBuf,
        /// How many bytes before it are text.
        offset: usize,
    },
    /// The file is not JSON, or a field is missing or of another type.
    #[error("{}: {source}; see `tests/data/lcp-problems/README.md` for the format", file.display())]
    Json {
        /// The file.
        file: PathBuf,
        /// What is wrong, with line and column.
        source: serde_json::Error,
    },
    /// A field's value is wrong.
    #[error("{}: `{field}` is wrong: {found}; {remedy}", file.display())]
    Field {
        /// The file.
        file: PathBuf,
        /// The field, for instance `M[3]`.
        field: String,
        /// What was found.
        found: String,
        /// What to do.
        remedy: String,
    },
    /// The problem's numbers do not fit each other.
    #[error("{}: the problem is not valid", file.display())]
    Problem {
        /// The file.
        file: PathBuf,
        /// What is wrong.
        source: LcpError,
    },
}

/// A problem of a file.
#[derive(Clone, Debug, PartialEq)]
pub enum Problem {
    /// w = M z + q.
    Lcp(RawLcp),
    /// u = W r + q with Coulomb's law.
    Friction(RawFriction),
}

#[derive(Deserialize)]
#[serde(tag = "kind")]
enum Json {
    #[serde(rename = "lcp")]
    Lcp {
        #[serde(rename = "M")]
        matrix: Vec<(usize, usize, f64)>,
        q: Vec<f64>,
        #[serde(default)]
        free: usize,
    },
    #[serde(rename = "friction2d_local")]
    Friction {
        #[serde(rename = "W")]
        matrix: Vec<(usize, usize, f64)>,
        q: Vec<f64>,
        mu: Vec<f64>,
    },
}

/// Reads a problem: JSON, or the matrix of a Matrix Market file and q of another.
///
/// # Errors
/// An [`LcpFileError`] that names file and field.
pub fn read_problem(
    file: &Path,
    q: Option<&Path>,
    free: Option<usize>,
) -> Result<Problem, LcpFileError> {
    let at = At { file };
    if file.extension().is_none_or(|extension| extension != "mtx") {
        if q.is_some() {
            return Err(at.field("q", "given twice", "leave `--q` to Matrix Market files"));
        }
        return parse_json(file, &at.text()?, free);
    }
    let Some(q) = q else {
        let remedy = "give the vector q as `--q FILE.mtx`";
        return Err(at.field("q", "not given", remedy));
    };
    parse_matrix_market([file, q], [&at.text()?, &At { file: q }.text()?], free)
}

/// Reads a problem from the text of a JSON file.
///
/// # Errors
/// As [`read_problem`].
pub fn parse_json(file: &Path, text: &str, free: Option<usize>) -> Result<Problem, LcpFileError> {
    let at = At { file };
    let json = serde_json::from_str(text)
        .map_err(|source| LcpFileError::Json { file: file.to_owned(), source })?;
    let problem = match json {
        Json::Lcp { matrix, q, free: leading } => {
            let matrix = at.square("M", &matrix, q.len())?;
            let free = free.unwrap_or(leading);
            Problem::Lcp(RawLcp { free, matrix, q: DVector::from_vec(q) })
        }
        Json::Friction { .. } if free.is_some() => {
            let remedy = "friction problems have no free unknowns; leave it out";
            return Err(at.field("--free", "given", remedy));
        }
        Json::Friction { matrix, q, mu } => {
            let matrix = at.square("W", &matrix, q.len())?;
            Problem::Friction(RawFriction { matrix, q: DVector::from_vec(q), mu })
        }
    };
    at.checked(problem)
}

/// Reads a problem from the texts of two Matrix Market files: M and q.
///
/// # Errors
/// As [`read_problem`].
pub fn parse_matrix_market(
    files: [&Path; 2],
    texts: [&str; 2],
    free: Option<usize>,
) -> Result<Problem, LcpFileError> {
    let [at, at_q] = files.map(|file| At { file });
    let (matrix, q) = (matrix_of(&at, texts[0])?, matrix_of(&at_q, texts[1])?);
    if q.ncols() != 1 {
        let found = format!("{} columns", q.ncols());
        return Err(at_q.field("q", &found, "give a matrix with one column"));
    }
    let q = q.column(0).into_owned();
    at.checked(Problem::Lcp(RawLcp { free: free.unwrap_or(0), matrix, q }))
}

/// Errors know the file.
pub(super) struct At<'a> {
    pub(super) file: &'a Path,
}

impl At<'_> {
    pub(super) fn text(&self) -> Result<String, LcpFileError> {
        let file = || self.file.to_owned();
        let bytes = std::fs::read(self.file)
            .map_err(|source| LcpFileError::Read { file: file(), source })?;
        let text = String::from_utf8(bytes).map_err(|error| LcpFileError::NotUtf8 {
            file: file(),
            offset: error.utf8_error().valid_up_to(),
        })?;
        // Some editors begin a file with a byte order mark.
        Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
    }

    fn checked(&self, problem: Problem) -> Result<Problem, LcpFileError> {
        let valid = match &problem {
            Problem::Lcp(problem) => problem.validate(),
            Problem::Friction(problem) => problem.validate(),
        };
        valid.map_err(|source| LcpFileError::Problem { file: self.file.to_owned(), source })?;
        Ok(problem)
    }

    pub(super) fn field(&self, field: &str, found: &str, remedy: &str) -> LcpFileError {
        let (file, field) = (self.file.to_owned(), field.to_owned());
        let mut quoted: String = found.chars().take(QUOTED).collect();
        if quoted.len() < found.len() {
            quoted.push_str(" …");
        }
        LcpFileError::Field { file, field, found: quoted, remedy: remedy.to_owned() }
    }

    fn square(
        &self,
        name: &str,
        entries: &[(usize, usize, f64)],
        n: usize,
    ) -> Result<DMatrix<f64>, LcpFileError> {
        if n > MOST_UNKNOWNS {
            let remedy = format!("matrices are dense here; at most {MOST_UNKNOWNS} unknowns");
            return Err(self.field("q", &format!("{n} entries"), &remedy));
        }
        let mut matrix = DMatrix::zeros(n, n);
        for (k, &(i, j, value)) in entries.iter().enumerate() {
            if i >= n || j >= n {
                let remedy = format!("indices count from 0 and end at {}", n.saturating_sub(1));
                let found = format!("row {i}, column {j}, but q has {n} entries");
                return Err(self.field(&format!("{name}[{k}]"), &found, &remedy));
            }
            matrix[(i, j)] += value;
        }
        Ok(matrix)
    }
}

impl Problem {
    /// Kind and size.
    #[must_use]
    pub fn describe(&self) -> String {
        match self {
            Self::Lcp(problem) if problem.free > 0 => {
                let (n, free) = (problem.q.len(), problem.free);
                format!("mixed complementarity problem, {n} unknowns, {free} of them free")
            }
            Self::Lcp(problem) => format!("complementarity problem, {} unknowns", problem.q.len()),
            Self::Friction(problem) => {
                format!("planar friction problem, {} contacts", problem.mu.len())
            }
        }
    }

    /// Solves by a backend.
    ///
    /// # Errors
    /// What the backend says.
    pub fn solve(&self, solver: &dyn RawSolver) -> Result<RawSolution, LcpError> {
        match self {
            Self::Lcp(problem) => solver.solve_raw(problem),
            Self::Friction(problem) => {
                problem.judged(solver.name(), solver.solve_friction(problem)?)
            }
        }
    }

    /// Natural residual, free of units.
    #[must_use]
    pub fn residual(&self, solution: &RawSolution) -> f64 {
        match self {
            Self::Lcp(problem) => problem.residual(&solution.z),
            Self::Friction(problem) => problem.residual(&problem.reactions(&solution.z)),
        }
    }

    /// Unknowns and remainders with their letters.
    #[must_use]
    pub fn pair(&self, solution: &RawSolution) -> [(&'static str, DVector<f64>); 2] {
        match self {
            Self::Lcp(_) => [("z", solution.z.clone()), ("w", solution.w.clone())],
            Self::Friction(problem) => {
                let r = problem.reactions(&solution.z);
                let u = &problem.matrix * &r + &problem.q;
                [("r", r), ("u", u)]
            }
        }
    }

    /// Derivative of the unknowns by q.
    ///
    /// # Errors
    /// [`LcpError::NotConverged`] if the active block is singular.
    pub fn derivative(&self, solution: &RawSolution) -> Result<DMatrix<f64>, LcpError> {
        match self {
            Self::Lcp(problem) => problem.derivative(solution),
            Self::Friction(problem) => problem.derivative(solution),
        }
    }
}
