//! A case: its parts, and how one is measured on a backend.

use tangency_lcp::{LcpSolver, RawSolver};

use crate::{Figure, Lab, Tally};

/// A backend under test.
pub struct Backend {
    /// Its name, as the command line has it.
    pub name: &'static str,
    /// Its solver of time steps.
    pub solver: Box<dyn LcpSolver>,
    /// Its solver of raw problems.
    pub raw: Box<dyn RawSolver>,
}

/// Why a part ended early.
pub use tangency_bench::engine::Refusal as Stop;

/// Some quantities of a case that are measured together.
#[derive(Clone, Copy)]
pub struct Part {
    /// What it is about.
    pub name: &'static str,
    /// Whether it takes minutes; left out unless asked for.
    pub long: bool,
    /// Measures.
    pub run: fn(&mut Lab<'_>) -> Result<(), Stop>,
}

impl Part {
    /// A part that takes seconds at most.
    #[must_use]
    pub const fn new(name: &'static str, run: fn(&mut Lab<'_>) -> Result<(), Stop>) -> Self {
        Self { name, long: false, run }
    }

    /// A part that takes minutes.
    #[must_use]
    pub const fn long(name: &'static str, run: fn(&mut Lab<'_>) -> Result<(), Stop>) -> Self {
        Self { name, long: true, run }
    }
}

/// Physics with a known answer.
#[derive(Clone, Copy)]
pub struct Case {
    /// Its identifier, as in `V05`.
    pub id: &'static str,
    /// What it is about.
    pub title: &'static str,
    /// Its parts.
    pub parts: &'static [Part],
}

/// What a case came to on a backend.
#[must_use]
pub fn measure(case: &Case, backend: &Backend, long: bool) -> (Vec<Figure>, Tally) {
    let mut lab = Lab::new(backend, case.id);
    for part in case.parts.iter().filter(|part| long || !part.long) {
        if let Err(stop) = (part.run)(&mut lab) {
            lab.stopped(part.name, &stop);
        }
    }
    (lab.figures, lab.tally)
}
