//! How often the solver reaches the target on hard problems, and at what cost.

use tangency_lcp::{LcpSolver, Scratch};
use tangency_lcp_ipm::InteriorPoint;

use crate::problems::{CLASSES, Random};

#[test]
fn sweep() {
    let per: u64 = std::env::var("PER").ok().and_then(|s| s.parse().ok()).unwrap_or(100);
    for (name, class) in CLASSES {
        let (mut ok, mut its, mut facs, mut worst) = (0, vec![], vec![], 0.0_f64);
        let start = std::time::Instant::now();
        let mut rows = 0;
        for seed in 0..per {
            let p = class(&mut Random(seed * 7919 + 1));
            rows += p.rows.len();
            match InteriorPoint::default().solve(&p, None, &mut Scratch::default()) {
                Ok(s) => {
                    ok += 1;
                    worst = worst.max(p.residual(&s).max());
                    its.push(s.stats.iterations);
                    facs.push(s.stats.factorisations);
                }
                Err(e) => eprintln!("  {name} {seed} rows {}: {e}", p.rows.len()),
            }
        }
        its.sort();
        facs.sort();
        let q = |v: &Vec<u32>, f: f64| v.get((v.len() as f64 * f) as usize).copied().unwrap_or(0);
        eprintln!(
            "{name:14} {ok}/{per} worst {worst:.1e} its {} {} {} facs {} {} {} rows {} us {:.0}",
            q(&its, 0.5), q(&its, 0.9), q(&its, 0.99), q(&facs, 0.5), q(&facs, 0.9), q(&facs, 0.99),
            rows as u64 / per,
            start.elapsed().as_secs_f64() * 1e6 / per as f64
        );
    }
}
