//! Random problems of the hard classes, by proptest.

use proptest::{prelude::*, test_runner::RngSeed};
use tangency_bench::problems::{CLASSES, Class, Random};

use super::compare::compare;

/// All that solve it agree, and a failure is one that claims no conflict. How many are solved is the
/// question of `reliability`.
fn agree(name: &str, class: Class, seed: u64) -> Result<(), TestCaseError> {
    let wrong = compare(&class(&mut Random(seed)), &tangency::all_solvers()).err();
    prop_assert!(wrong.is_none(), "{name} {seed}: {}", wrong.unwrap_or_default().join("; "));
    Ok(())
}

/// The same problems in every run.
fn fixed() -> ProptestConfig {
    let rng_seed = RngSeed::Fixed(20);
    ProptestConfig { rng_seed, failure_persistence: None, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(fixed())]

    #[test]
    fn backends_agree_on_random_problems(class in 0..CLASSES.len(), seed: u64) {
        let (name, class) = CLASSES[class];
        agree(name, class, seed)?;
    }
}
