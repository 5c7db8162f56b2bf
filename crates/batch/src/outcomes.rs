//! What became of each environment.

use crate::{BatchError, Failure};

/// Results of those environments that have one, and the reasons of those that failed.
#[derive(Debug)]
pub struct Outcomes<T> {
    /// One place per environment, empty where it failed.
    pub results: Vec<Option<T>>,
    /// Failures, in the order of the environments.
    pub failures: Vec<Failure>,
}

impl<T> Outcomes<T> {
    /// The results of all environments, if none failed.
    ///
    /// # Errors
    /// [`BatchError::Failed`] with all failures.
    pub fn all(self) -> Result<Vec<T>, BatchError> {
        let Self { results, failures } = self;
        let of = results.len();
        if failures.is_empty() {
            Ok(results.into_iter().flatten().collect())
        } else {
            Err(BatchError::Failed { of, failures })
        }
    }
}

impl<T> FromIterator<Result<T, Failure>> for Outcomes<T> {
    fn from_iter<I: IntoIterator<Item = Result<T, Failure>>>(all: I) -> Self {
        let mut failures = Vec::new();
        let keep = |result: Result<T, Failure>| result.map_err(|it| failures.push(it)).ok();
        let results = all.into_iter().map(keep).collect();
        Self { results, failures }
    }
}
