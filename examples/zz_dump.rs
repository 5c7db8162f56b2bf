//! Untracked: the rows of the failing island.
use std::sync::Mutex;
use tangency::lcp::*;
use tangency::{Scene, StepScratch, step};
struct Spy {
    inner: Box<dyn LcpSolver>,
    last: Mutex<Option<(Lcp, String)>>,
    all: Mutex<usize>,
}
impl LcpSolver for Spy {
    fn name(&self) -> &'static str {
        "spy"
    }
    fn solve(&self, p: &Lcp, g: Option<&Guess>, s: &mut Scratch) -> Result<LcpSolution, LcpError> {
        *self.all.lock().unwrap() += 1;
        let r = self.inner.solve(p, g, s);
        if let Err(e) = &r {
            *self.last.lock().unwrap() = Some((p.clone(), format!("{e}")));
        }
        r
    }
}
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let seed: u64 = a[1].parse().unwrap();
    let steps: usize = a[2].parse().unwrap();
    let n = 1 + (seed as usize * 7919) % 30;
    let def = tangency_bench::random_scene(seed, n);
    let scene = Scene::new(&def).unwrap();
    let spy = Spy {
        inner: tangency::backend("ipm").unwrap(),
        last: Mutex::new(None),
        all: Mutex::new(0),
    };
    let mut state = scene.initial_state();
    println!(
        "dt {} model {:?} mu {:?}",
        def.dt,
        def.contact_model,
        def.bodies.iter().map(|b| b.friction).collect::<Vec<_>>()
    );
    for b in &def.bodies {
        println!(
            "{} {:?} m {:?} e {} v {:?} shapes {:?} at {:?} {}",
            b.name, b.kind, b.mass, b.restitution, b.velocity, b.shapes, b.position, b.angle
        );
    }
    for j in &def.joints {
        println!("{:?}", j);
    }
    for k in 0..=steps {
        match step(&scene, &spy, &state, &[], &mut StepScratch::default()) {
            Ok(r) => state = r.after,
            Err(e) => {
                println!("step {k}: {e}");
                let l = spy.last.lock().unwrap();
                if let Some((p, _)) = &*l {
                    for (i, m) in p.mass.iter().enumerate() {
                        println!(
                            "body {i} m {:?} v0 {:?}",
                            m.as_slice(),
                            p.momentum[i].component_div(m).as_slice()
                        );
                    }
                    for (i, r) in p.rows.iter().enumerate() {
                        println!(
                            "{i} {:?} {:?} rhs {:.3e} c {:.1e} {:?} {:?}",
                            r.bodies,
                            r.law,
                            r.rhs,
                            r.compliance,
                            r.jacobian[0].as_slice(),
                            r.jacobian[1].as_slice()
                        );
                    }
                    std::fs::write("/tmp/fail.json", serde_json::to_string(p).unwrap()).unwrap();
                }
                return;
            }
        }
    }
}
