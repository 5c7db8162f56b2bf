//! Scene files that are nearly right, from fixed seeds. The directory `fuzz` looks for more of them.

use std::fs;
use std::path::{Path, PathBuf};

use tangency_bench::mutation::mutated;
use tangency_bench::problems::Random;

mod scene_file;

/// Mutated files per shipped scene.
const EACH: usize = 100;

fn shipped() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let entries = fs::read_dir(folder).expect("the scenes are shipped");
    let mut files: Vec<_> = entries.map(|entry| entry.expect("a file").path()).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "toml"));
    files.sort();
    files
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
    assert!(4 * built > tried, "only {built} of {tried} files made a scene");
}
