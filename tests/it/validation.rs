//! The validation cases, those of `tangency validate`: every figure is within its tolerance on every backend.
//! Tolerances are those of the cases and are never loosened.

use tangency_validation::report::Line;
use tangency_validation::{Backend, Figure, Verdict, cases, measure};

/// Every backend of this build that takes scenes of any size.
fn backends() -> Vec<Backend> {
    let solvers = tangency::solvers().into_iter().zip(tangency::raw_solvers());
    let backends = tangency::BACKENDS.iter().zip(solvers);
    let list: Vec<_> =
        backends.map(|(name, (solver, raw))| Backend { name, solver, raw }).collect();
    assert!(!list.is_empty(), "this build has no backend: turn on the feature `ipm`");
    list
}

/// What is not reached: bounces that would end within a step end at its beginning, so that the time at which the
/// last of infinitely many is over is right to a step only.
const NOT_REACHED: [(&str, &str); 1] = [("V04", "motion ends")];

/// `cargo test -- --nocapture` prints the table.
#[track_caller]
#[expect(clippy::print_stdout, reason = "captured unless the test fails or the table is asked for")]
fn check(id: &str) {
    let cases = cases();
    let case = cases.iter().find(|case| case.id == id).expect("a case of this name");
    for backend in backends() {
        let (figures, _) = measure(case, &backend, false);
        assert!(!figures.is_empty(), "{id} measures nothing");
        for figure in &figures {
            println!("{id} {}: {}", backend.name, Line(figure));
        }
        let missed = |figure: &&Figure| match figure.verdict {
            Verdict::Failed => true,
            Verdict::NotReached => !NOT_REACHED.contains(&(id, &figure.quantity)),
            Verdict::Passed | Verdict::Refused => false,
        };
        let failed: Vec<&Figure> = figures.iter().filter(missed).collect();
        assert!(failed.is_empty(), "{id} on {}: {failed:#?}", backend.name);
    }
}

/// A test per case, and one that none is left out.
macro_rules! tests {
    ($($name:ident $id:literal)*) => {
        $(#[test] fn $name() { check($id); })*

        #[test]
        fn every_case_has_its_test() {
            let tested = [$($id),*];
            let ids: Vec<&str> = cases().iter().map(|case| case.id).collect();
            assert_eq!(ids, tested);
        }
    };
}

tests! {
    v01 "V01"
    v02 "V02"
    v03 "V03"
    v04 "V04"
    v05 "V05"
    v06 "V06"
    v07 "V07"
    v08 "V08"
    v09 "V09"
    v10 "V10"
    v11 "V11"
    v12 "V12"
    v13 "V13"
    v14 "V14"
    v15 "V15"
    v16 "V16"
    v17 "V17"
    v18 "V18"
    v19 "V19"
    v20 "V20"
    v21 "V21"
    v22 "V22"
    v23 "V23"
    v24 "V24"
    v25 "V25"
    v26 "V26"
    v27 "V27"
    v28 "V28"
    v29 "V29"
    v30 "V30"
    v31 "V31"
    v32 "V32"
    v33 "V33"
    v34 "V34"
    v35 "V35"
    v36 "V36"
    v37 "V37"
    v38 "V38"
}
