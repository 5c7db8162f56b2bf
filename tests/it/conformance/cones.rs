//! Clarabel with the friction cone as rows and as second-order cones.

#[cfg(feature = "clarabel")]
#[test]
fn both_descriptions_of_the_cone_give_the_same() {
    use tangency::LcpSolver;
    use tangency::lcp_clarabel::{Clarabel, FrictionCone};
    use tangency_bench::problems::{CLASSES, Random};

    let rows = Clarabel::default();
    let cones = Clarabel { cone: FrictionCone::SecondOrder, ..rows };
    let pair: [Box<dyn LcpSolver>; 2] = [Box::new(rows), Box::new(cones)];
    let mut compared = 0;
    for (name, class) in CLASSES {
        for seed in 0..20 {
            let problem = class(&mut Random(seed * 104_729 + 5));
            let verdict = super::compare::compare(&problem, &pair)
                .unwrap_or_else(|wrong| panic!("{name} {seed}: {}", wrong.join("; ")));
            compared += usize::from(verdict.solved == 2);
        }
    }
    assert!(compared >= 190, "{compared} of 200 solved both ways");
}
