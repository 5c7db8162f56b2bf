//! The engines that take part.

use tangency::{BACKENDS, SceneDef, backend};
use tangency_bench::engine::Engine;
use tangency_bench::own::{Tangency, Variant};

/// Backends that take scenes of any size.
fn backends() -> impl Iterator<Item = &'static str> {
    BACKENDS.iter().copied().filter(|name| *name != "lemke")
}

/// This engine: every backend with joints as defined, and the first with joints projected.
pub(super) fn own() -> Vec<Tangency> {
    let mut all: Vec<Tangency> =
        backends().filter_map(|name| stepping(name, Variant::AsDefined)).collect();
    all.extend(backends().next().and_then(|name| stepping(name, Variant::Projected)));
    all
}

/// This engine's other ways of stepping, on the first backend.
pub(super) fn modes() -> Vec<Tangency> {
    let all = [Variant::ImpactResolved, Variant::Accurate];
    let on = |variant| stepping(backends().next()?, variant);
    all.into_iter().filter_map(on).collect()
}

fn stepping(name: &'static str, variant: Variant) -> Option<Tangency> {
    Some(Tangency { backend: name, solver: backend(name)?, variant })
}

/// Other engines of this build: in the sweep fewer settings of each.
#[cfg(feature = "peers")]
pub(super) fn peers(sweep: bool) -> Vec<Box<dyn Engine>> {
    use tangency_bench::peers::{Phyz, Rapier};
    let iterations: &[usize] = if sweep { &[4, 16] } else { &[1, 4, 16, 64] };
    let rapiers = iterations.iter().map(|n| Box::new(Rapier { iterations: *n }) as Box<dyn Engine>);
    rapiers.chain([Box::new(Phyz) as Box<dyn Engine>]).collect()
}

/// Other engines of this build: none.
#[cfg(not(feature = "peers"))]
pub(super) fn peers(_sweep: bool) -> Vec<Box<dyn Engine>> {
    Vec::new()
}

pub(super) fn all<'a>(own: &'a [Tangency], others: &'a [Box<dyn Engine>]) -> Vec<&'a dyn Engine> {
    let own = own.iter().map(|engine| engine as &dyn Engine);
    own.chain(others.iter().map(|engine| &**engine)).collect()
}

/// Ours that make a difference in a scene, and all others.
pub(super) fn fitting<'a>(
    own: impl IntoIterator<Item = &'a Tangency>,
    others: &'a [Box<dyn Engine>],
    def: &SceneDef,
) -> Vec<&'a dyn Engine> {
    let own = own.into_iter().filter(|engine| engine.fits(def)).map(|engine| engine as &dyn Engine);
    own.chain(others.iter().map(|engine| &**engine)).collect()
}
