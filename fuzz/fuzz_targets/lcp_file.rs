//! Bytes as a complementarity problem: `crates/cli/tests/fuzzed/lcp_file.rs` says what must hold.

#![no_main]

#[path = "../../crates/cli/tests/fuzzed/lcp_file.rs"]
mod lcp_file;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    lcp_file::check(bytes);
});
