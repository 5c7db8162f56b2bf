//! Bytes as a scene file: `tests/it/fuzzed/scene_file.rs` says what must hold.

#![no_main]

#[path = "../../tests/it/fuzzed/scene_file.rs"]
mod scene_file;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    scene_file::check(bytes);
});
