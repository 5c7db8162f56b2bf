//! Every shipped scene runs on every backend.

use std::path::PathBuf;

use tangency::{Scene, inspect, load_scene};

use crate::engine::{backends, run, steps};

/// The scenes of the folder `scenes`, in the order of their names.
pub(crate) fn shipped() -> Vec<(PathBuf, Scene)> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes");
    let entries = std::fs::read_dir(folder).expect("the folder `scenes`");
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    files.retain(|file| file.extension().is_some_and(|e| e == "toml" || e == "json"));
    files.sort();
    let load = |file: PathBuf| {
        let scene = load_scene(&file).unwrap_or_else(|error| panic!("{error}"));
        (file, scene)
    };
    files.into_iter().map(load).collect()
}

#[test]
fn at_least_twelve_scenes_ship() {
    assert!(shipped().len() >= 12, "{} scenes", shipped().len());
}

/// Residual and finite states are checked by `run`.
#[test]
fn shipped_scenes_run() {
    for solver in backends() {
        for (file, scene) in shipped() {
            let count = steps(scene.def().duration, scene.dt()).min(200);
            let tape = run(&scene, &*solver, count);
            let drift = tape.states().map(|s| scene.joint_drift(s)).fold(0.0, f64::max);
            let sizes = (0..scene.bodies().len()).map(|b| scene.size(b)).filter(|s| s.is_finite());
            let size = sizes.fold(0.0, f64::max);
            assert!(drift <= 0.05 * size.max(1.0), "{}: a joint drifts by {drift}", file.display());
            inspect(&scene, tape.last())
                .unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        }
    }
}

/// Where velocities are unique all backends agree on them.
#[test]
fn backends_agree_on_the_first_step() {
    for (file, scene) in shipped() {
        let ends: Vec<_> =
            backends().iter().map(|solver| run(&scene, &**solver, 1).last().clone()).collect();
        for end in &ends[1..] {
            for (one, other) in ends[0].v.iter().zip(&end.v) {
                assert!((one - other).norm() <= 1e-8 * (1.0 + one.norm()), "{}", file.display());
            }
        }
    }
}
