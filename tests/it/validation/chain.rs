//! V16 (c) A hanging chain is struck by a disc.

use tangency::Param;
use tangency_bench::scenes::{hanging_chain_hit, slender_inertia};

use crate::engine::{backends, built, first_step, near, run, with_dt};
use crate::slope::{pick, slope};

const DISC: usize = 10;
const LOWEST: usize = 9;
const DIVISOR: f64 = 943_009.0;

#[test]
fn v16_c_velocities() {
    for solver in backends() {
        for dt in [1e-4, 1e-3, 1e-2] {
            let v = first_step(&built(&with_dt(hanging_chain_hit(), dt)), &*solver).after.v;
            near("V16 (c) lowest rate", v[LOWEST].z.abs(), 12_640_680.0 / DIVISOR, 1e-9);
            near("V16 (c) topmost rate", v[0].z.abs(), 180.0 / DIVISOR, 1e-9);
            near("V16 (c) disc", v[DISC].x, 837_670.0 / DIVISOR, 1e-9);
        }
    }
}

#[test]
fn v16_c_derivatives_by_the_shared_mass() {
    for solver in backends() {
        let scene = built(&with_dt(hanging_chain_hit(), 1e-3));
        let tape = run(&scene, &*solver, 1);
        let inertia = slender_inertia(1.0, 0.2);
        let link = |i| [(Param::Mass(i), 1.0), (Param::Inertia(i), inertia)];
        let links: Vec<(Param, f64)> = (0..10).flat_map(link).collect();
        let sign = tape.last().v[LOWEST].z.signum();
        let rate = pick(&scene, |s| s.v[LOWEST].z = sign);
        let disc = pick(&scene, |s| s.v[DISC].x = 1.0);
        let check = |what: &str, seed, exact: f64| {
            near(what, slope(&scene, &tape, seed, &links), exact, 1e-9 * exact.abs());
        };
        check("V16 (c) d lowest/d link mass", &rate, -37.254_972_029_979_4);
        check("V16 (c) d disc/d link mass", &disc, -8.027_330_828_593_91);
    }
}
