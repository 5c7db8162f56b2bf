//! The native half of the Python package `tangency`: every function converts, calls the engine, and
//! converts back. The documentation of its classes and functions is what Python's `help` shows; their types
//! stand in `python/tangency/_native.pyi`.

#![expect(clippy::doc_markdown, reason = "documentation of classes and functions is Python's")]
#![expect(clippy::needless_pass_by_value, reason = "what comes from Python was made for the call")]

mod arrays;
mod batch;
mod controls;
mod errors;
mod gradient;
mod impulse;
mod lcp;
mod picture;
mod plan;
mod plan_callbacks;
mod report;
mod rollout;
mod rollouts;
mod scene;
mod seeds;
mod simulator;
mod solver;
mod state;
mod step_jacobian;
mod threads;

use pyo3::prelude::*;

/// The native half of `tangency`.
#[pymodule]
mod _native {
    #[pymodule_export]
    use crate::batch::Batch;
    #[pymodule_export]
    use crate::errors::{GradientError, PlanError, SceneError, SolveError, StepError};
    #[pymodule_export]
    use crate::gradient::{Gradient, GradientBatch};
    #[pymodule_export]
    use crate::impulse::Impulse;
    #[pymodule_export]
    use crate::lcp::{LcpSolution, solve_lcp};
    #[pymodule_export]
    use crate::plan::{Plan, plan};
    #[pymodule_export]
    use crate::report::GradientReport;
    #[pymodule_export]
    use crate::rollout::{Rollout, rollout};
    #[pymodule_export]
    use crate::rollouts::Rollouts;
    #[pymodule_export]
    use crate::scene::Scene;
    #[pymodule_export]
    use crate::simulator::Simulator;
    #[pymodule_export]
    use crate::solver::backends;
    #[pymodule_export]
    use crate::step_jacobian::StepJacobian;

    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        crate::errors::complete(module.py())
    }
}
