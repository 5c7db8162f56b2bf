//! Scene files that are nearly right, from fixed seeds. The directory `fuzz` looks for more of them.

use std::fs;
use std::path::{Path, PathBuf};

use tangency_bench::mutation::mutated;
use tangency_bench::problems::Random;

mod scene_file;

/// Mutated files per shipped scene.
const EACH: usize = 150;

fn shipped() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let entries = fs::read_dir(folder).expect("the scenes are shipped");
    let mut files: Vec<_> = entries.map(|entry| entry.expect("a file").path()).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "toml"));
    files.sort();
    files
}

/// What was found once: a shipped scene, and the change that a panic or a number that is not finite
/// came of.
#[test]
fn findings() {
    for (name, from, to) in [
        ("conveyor", "angular_velocity = -5.0", "angular_velocity = 1e50"),
        ("chain_and_ball", "end = 0.1", "end = inf"),
    ] {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{name}.toml"));
        let text = fs::read_to_string(file).expect("a scene");
        assert!(text.contains(from), "{name} has no {from}");
        scene_file::check(text.replacen(from, to, 1).as_bytes());
    }
}

#[test]
fn mutated_scene_files() {
    let (mut random, mut tried, mut built) = (Random(1), 0, 0);
    for file in shipped() {
        let text = fs::read(&file).expect("a scene");
        for _ in 0..EACH {
            tried += 1;
            built += usize::from(scene_file::check(&mutated(&text, &mut random)));
        }
    }
    assert!(5 * built > tried, "only {built} of {tried} files made a scene");
}
