//! Untracked: random scenes in bulk.
use std::collections::BTreeMap;
use tangency::lcp::LcpError;
use tangency::{Scene, StepError, StepScratch, step};
use tangency_validation::Tally;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let (from, to, steps): (u64, u64, usize) =
        (a[1].parse().unwrap(), a[2].parse().unwrap(), a[3].parse().unwrap());
    let backend = a.get(4).map_or("ipm", |s| s.as_str());
    let solver = tangency::backend(backend).unwrap();
    let verbose = a.get(5).is_some();
    let mut tally = Tally::default();
    let mut why: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let t0 = std::time::Instant::now();
    let mut slow = (0.0, 0);
    for seed in from..to {
        let driven = tangency_bench::is_driven(seed);
        let n = 1 + (seed as usize * 7919) % 30;
        let def = tangency_bench::random_scene(seed, n);
        let scene = match Scene::new(&def) {
            Ok(s) => s,
            Err(e) => {
                why.entry(format!("scene {e}")).or_default().push(format!("{seed}"));
                continue;
            }
        };
        let mut state = scene.initial_state();
        let mut scratch = StepScratch::default();
        let t = std::time::Instant::now();
        for k in 0..steps {
            match step(&scene, &*solver, &state, &vec![0.0; scene.controls().len()], &mut scratch) {
                Ok(r) => {
                    tally.add_step(&r);
                    state = r.after;
                }
                Err(e) => {
                    tally.refused += 1;
                    let key = match &e {
                        StepError::Lcp { source: LcpError::Infeasible { .. }, .. } => {
                            "infeasible".to_string()
                        }
                        StepError::Lcp { source: LcpError::NotConverged { .. }, .. } => {
                            "not converged".to_string()
                        }
                        StepError::Lcp { source, .. } => format!("{source}"),
                        StepError::Collision { .. } => "collision".into(),
                        _ => format!("{e}"),
                    };
                    let mut cure = String::new();
                    for (name, f) in [
                        ("e=0", 1),
                        ("joints none", 2),
                        ("post off", 4),
                        ("e=0,joints none", 3),
                        ("e=0, post off", 5),
                        ("joints none, post off", 6),
                        ("all three", 7),
                        ("all, mu=0", 15),
                        ("mu=0", 8),
                    ] {
                        let mut d = def.clone();
                        if f & 1 > 0 {
                            for b in &mut d.bodies {
                                b.restitution = 0.0;
                            }
                        }
                        if f & 2 > 0 {
                            d.stabilisation.joints = tangency::Correction::None;
                        }
                        if f & 4 > 0 {
                            d.stabilisation.contacts = tangency::Correction::None;
                        }
                        if f & 8 > 0 {
                            for b in &mut d.bodies {
                                b.friction = 0.0;
                            }
                        }
                        let sc = Scene::new(&d).unwrap();
                        if step(&sc, &*solver, &state, &[], &mut scratch).is_ok() {
                            cure = name.into();
                            break;
                        }
                    }
                    let key = format!("{driven} {key}, cured by {cure:?}");
                    if verbose {
                        println!("{seed} n={n} step {k} [{cure}]: {e}");
                    }
                    why.entry(key).or_default().push(format!("{seed}:{k}"));
                    break;
                }
            }
        }
        let s = t.elapsed().as_secs_f64();
        if s > slow.0 {
            slow = (s, seed);
        }
    }
    println!("{:?} {tally:?} slowest {slow:?}", t0.elapsed());
    for (k, v) in why {
        println!("{k}: {} e.g. {:?}", v.len(), &v[..v.len().min(12)]);
    }
}
