//! The threads of this process.
//!
//! A forked child has none of its parent's threads, and a pool that waits for them would wait for ever:
//! each process makes a pool of its own when it first needs one. `RAYON_NUM_THREADS` sets its size.

use std::sync::{Arc, Mutex, PoisonError};

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use tangency::Scene;

/// The process that made the pool, and the pool.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Scenes of fewer bodies never have islands that are worth a thread of their own.
const MANY_BODIES: usize = 16;

/// Does work over all cores, without Python's lock.
pub(crate) fn side_by_side<T: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    let pool = pool()?;
    Ok(py.detach(|| pool.install(work)))
}

/// Does work on one scene without Python's lock: on this thread, or over all cores if that may pay.
pub(crate) fn alone<T: Send>(
    py: Python<'_>,
    scene: &Scene,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    if scene.bodies().len() < MANY_BODIES { Ok(py.detach(work)) } else { side_by_side(py, work) }
}

fn pool() -> PyResult<Arc<ThreadPool>> {
    let process = std::process::id();
    let mut held = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, pool)) = held.as_ref().filter(|(owner, _)| *owner == process) {
        return Ok(pool.clone());
    }
    let pool = ThreadPoolBuilder::new().build().map_err(crate::errors::step)?;
    let pool = Arc::new(pool);
    // The parent's threads are not here to be stopped.
    std::mem::forget(held.replace((process, pool.clone())));
    Ok(pool)
}
