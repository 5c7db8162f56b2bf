//! Memory of the threads.

use std::ops::{Deref, DerefMut};
use std::sync::{Mutex, MutexGuard};

use tangency_core::StepScratch;

/// What one thread needs to step environments one after the other; it never changes a result.
///
/// One per environment would have to be read from memory at every step: cheap steps of a thousand
/// environments then take twice as long.
#[derive(Default)]
pub(crate) struct Workspace {
    pub(crate) scratch: StepScratch,
    /// Room for the control of one step.
    pub(crate) control: Vec<f64>,
}

/// Workspaces that nobody uses at the moment: never more than threads worked at once.
///
/// They are not bound to threads, since a thread that waits for others inside a policy or a loss may
/// begin a second task before its first has ended.
#[derive(Default)]
pub(crate) struct Workspaces(Mutex<Vec<Workspace>>);

/// A workspace on loan.
pub(crate) struct Loan<'a> {
    workspace: Workspace,
    from: &'a Workspaces,
}

impl Workspaces {
    pub(crate) fn lend(&self) -> Loan<'_> {
        let workspace = self.free().pop().unwrap_or_default();
        Loan { workspace, from: self }
    }

    fn free(&self) -> MutexGuard<'_, Vec<Workspace>> {
        self.0.lock().expect("nothing panics while it holds the lock")
    }
}

impl Deref for Loan<'_> {
    type Target = Workspace;

    fn deref(&self) -> &Workspace {
        &self.workspace
    }
}

impl DerefMut for Loan<'_> {
    fn deref_mut(&mut self) -> &mut Workspace {
        &mut self.workspace
    }
}

impl Drop for Loan<'_> {
    fn drop(&mut self) {
        self.from.free().push(std::mem::take(&mut self.workspace));
    }
}

/// Tasks per thread: enough that threads that are done early find more to do.
const TASKS: usize = 32;

/// Environments per task at most: whole runs of them, so that sharing them out costs nothing beside
/// stepping them.
pub(crate) fn task_length(environments: usize) -> usize {
    environments.div_ceil(TASKS * rayon::current_num_threads()).max(1)
}
