//! How long the benches measure.

use std::time::Duration;

use criterion::Criterion;

/// A second each.
pub(crate) fn brief() -> Criterion {
    let [warm_up, measured] = [200, 800].map(Duration::from_millis);
    Criterion::default().sample_size(20).warm_up_time(warm_up).measurement_time(measured)
}
