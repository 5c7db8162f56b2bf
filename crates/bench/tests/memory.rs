//! Memory as the system sees it, in a process in which nothing else runs.

use tangency_bench::memory::per_copy;

/// A number that is written takes its eight bytes. What is so large comes from the system page by page,
/// whatever the allocator does with small things.
#[test]
fn what_vectors_take() {
    let length = 1_u32 << 20;
    let build = || Ok::<_, ()>(vec![1.0_f64; length as usize]);
    if let Some(found) = per_copy(8, build).expect("nothing is refused") {
        let expected = 8.0 * f64::from(length);
        assert!((found / expected - 1.0).abs() < 0.05, "{found} bytes for {expected}");
    }
}
