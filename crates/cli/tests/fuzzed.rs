//! Problem files that are nearly right, from fixed seeds. The directory `fuzz` looks for more.

use std::fs;
use std::path::{Path, PathBuf};

use tangency_bench::mutation::mutated;
use tangency_bench::problems::Random;

#[path = "fuzzed/lcp_file.rs"]
mod lcp_file;

/// Mutated files per problem of the collection.
const EACH: usize = 100;
/// Larger files are left out: a change of theirs is one of many numbers.
const MOST_BYTES: usize = 6000;

const MARKET: &str = "%%MatrixMarket matrix coordinate real symmetric\n% M\n3 3 4\n1 1 2\n2 1 -1\n\
                      2 2 2.5\n3 3 1e0\n%%MatrixMarket matrix array real general\n3 1\n-4\n-3\n2\n";

fn collection() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/lcp-problems");
    let entries = fs::read_dir(folder).expect("the problems are shipped");
    let mut files: Vec<_> = entries.map(|entry| entry.expect("a file").path()).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "json"));
    files.sort();
    files
}

#[test]
fn mutated_problem_files() {
    let texts = collection().into_iter().map(|file| fs::read(file).expect("a problem"));
    let small = texts.filter(|text| text.len() <= MOST_BYTES);
    let (mut random, mut tried, mut read) = (Random(2), 0, 0);
    for text in small.chain([MARKET.as_bytes().to_vec()]) {
        for _ in 0..EACH {
            tried += 1;
            read += usize::from(lcp_file::check(&mutated(&text, &mut random)));
        }
    }
    assert!(4 * read > tried, "only {read} of {tried} files made a problem");
}
