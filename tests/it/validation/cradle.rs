//! V08 Five discs in a row, V23 many impacts at once.

use tangency::{BodyDef, SceneDef};
use tangency_bench::scenes::{cradle, disc, floor, material, unit_scene};

use crate::engine::{backends, built, first_step, near, run, with_dt};
use crate::slope::{pick, slope};

/// The simultaneous law for touching bodies.
#[track_caller]
fn check_touching(n: usize, e: f64, velocities: &[f64], impulses: &[f64]) {
    for solver in backends() {
        let record = first_step(&built(&cradle(n, 0.0, 0.0, e)), &*solver);
        for (v, exact) in record.after.v.iter().zip(velocities) {
            near("V08 touching, v", v.x, *exact, 1e-10);
        }
        for (impulse, exact) in record.contact_impulses().iter().zip(impulses) {
            near("V08 touching, impulse", impulse.normal, *exact, 1e-10);
        }
    }
}

#[test]
fn v08_touching() {
    check_touching(5, 1.0, &[-0.6, 0.4, 0.4, 0.4, 0.4], &[1.6, 1.2, 0.8, 0.4]);
    check_touching(3, 1.0, &[-1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0], &[]);
    check_touching(5, 0.5, &[-0.2, 0.3, 0.3, 0.3, 0.3], &[]);
}

#[test]
fn v08_with_gaps() {
    for solver in backends() {
        let scene = built(&with_dt(cradle(5, 0.01, 0.3, 1.0), 1e-3));
        let tape = run(&scene, &*solver, 500);
        for (ball, exact) in [0.0, 0.0, 0.0, 0.0, 1.0].into_iter().enumerate() {
            near("V08 with gaps, v", tape.last().v[ball].x, exact, 1e-10);
        }
        near("V08 energy", scene.energy(tape.last()), 0.5, 1e-10);
    }
}

#[test]
fn v08_derivatives() {
    for solver in backends() {
        for (gap, start, n, exact) in [(0.01, 0.3, 500, 1.0), (0.0, 0.0, 1, 0.4)] {
            let scene = built(&with_dt(cradle(5, gap, start, 1.0), 1e-3));
            let tape = run(&scene, &*solver, n);
            let seed = pick(&scene, |s| s.v[4].x = 1.0);
            let by_first = [(tangency::Param::Velocity(0, 0), 1.0)];
            let found = slope(&scene, &tape, &seed, &by_first);
            near("V08 d(last)/d(first)", found, exact, 1e-10);
        }
    }
}

fn falling(name: &str, position: [f64; 2], radius: f64) -> BodyDef {
    let ball = disc(name, radius, position);
    BodyDef { mass: Some(1.0), velocity: [0.0, -1.0], ..ball }
}

fn landing(bodies: Vec<BodyDef>, e: f64) -> SceneDef {
    let bodies = std::iter::once(floor()).chain(bodies).collect();
    material(unit_scene("many impacts", bodies), 0.0, e)
}

#[test]
fn v23_row_of_touching_discs() {
    let row = (0..100).map(|i| falling(&format!("d{i}"), [f64::from(i) * 0.5, 0.25], 0.25));
    let scene = built(&landing(row.collect(), 0.5));
    for solver in backends() {
        let record = first_step(&scene, &*solver);
        for v in &record.after.v[1..] {
            near("V23 row", (v - nalgebra::Vector3::new(0.0, 0.5, 0.0)).norm(), 0.0, 1e-9);
        }
        let side = |i: &tangency::ContactImpulse| i.direction.y.abs() < 0.5;
        let impulses = record.contact_impulses();
        let worst = impulses.iter().filter(|i| side(i)).map(|i| i.normal).fold(0.0, f64::max);
        near("V23 side impulses", worst, 0.0, 1e-9);
    }
}

#[test]
fn v23_column() {
    let disc = |i: u32| falling(&format!("d{i}"), [0.0, 0.25 + f64::from(i) * 0.5], 0.25);
    let scene = built(&landing((0..50).map(disc).collect(), 1.0));
    for solver in backends() {
        let record = first_step(&scene, &*solver);
        record.after.v[1..].iter().for_each(|v| near("V23 column, v", v.y, 1.0, 1e-9));
        for (k, impulse) in record.contact_impulses().iter().enumerate() {
            near("V23 column, impulse", impulse.normal, 100.0 - 2.0 * k as f64, 1e-9);
        }
    }
}

#[test]
fn v23_separate_discs_as_if_alone() {
    for e in [0.0, 0.5, 1.0] {
        let disc = |i: u32| falling(&format!("d{i}"), [f64::from(i), 0.25], 0.25);
        let scene = built(&landing((0..1000).map(disc).collect(), e));
        for solver in backends() {
            let record = first_step(&scene, &*solver);
            assert_eq!(record.islands.len(), 1000);
            let worst = record.after.v[1..].iter().map(|v| (v.y - e).abs());
            near("V23 separate", worst.fold(0.0, f64::max), 0.0, 1e-9);
        }
    }
}
