//! Random problems of the hard classes, by proptest.

use proptest::prelude::*;
use tangency_bench::problems::{CLASSES, Class, Random};

use super::compare::compare;

/// Every class with every seed: those that solve it agree, and the interior point does.
fn agree(name: &str, class: Class, seed: u64) -> Result<(), TestCaseError> {
    let solvers = tangency::all_solvers();
    let problem = class(&mut Random(seed));
    match compare(&problem, &solvers) {
        Ok(verdict) => {
            prop_assert!(!verdict.failed.contains(&"interior point"), "{name} {seed}: not solved");
        }
        Err(wrong) => prop_assert!(false, "{name} {seed}: {}", wrong.join("; ")),
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(200) })]

    #[test]
    fn backends_agree_on_random_problems(class in 0..CLASSES.len(), seed: u64) {
        let (name, class) = CLASSES[class];
        agree(name, class, seed)?;
    }
}
