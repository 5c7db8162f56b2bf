//! V09 Exact collisions.

use tangency::{LcpSolver, Param, SceneDef, State};
use tangency_bench::scenes::{head_on, line_collision, oblique_collision, rod_hit, spinning_disc};

use crate::engine::{backends, built, first_step, near, order, run, steps, with_dt};
use crate::slope::{pick, slope};

/// Velocities after one step of a scene that begins in contact.
#[track_caller]
fn check(what: &str, def: &SceneDef, expected: &[[f64; 3]]) {
    for solver in backends() {
        for dt in [1e-4, 1e-2, 0.1] {
            let scene = built(&with_dt(def.clone(), dt));
            let after = first_step(&scene, &*solver).after;
            let moving = (0..scene.bodies().len()).filter(|i| scene.is_dynamic(*i));
            for (body, exact) in moving.zip(expected) {
                for (found, exact) in after.v[body].iter().zip(exact) {
                    near(&format!("V09 {what}"), *found, *exact, 1e-10);
                }
            }
        }
    }
}

#[test]
fn v09_a_line() {
    check("(a)", &line_collision(), &[[-0.5, 0.0, 0.0], [2.0, 0.0, 0.0]]);
    for solver in backends() {
        let scene = built(&line_collision());
        let tape = run(&scene, &*solver, 1);
        let seed = pick(&scene, |s| s.v[0].x = 1.0);
        let both = |param: fn(usize) -> Param| vec![(param(0), 1.0), (param(1), 1.0)];
        for (what, direction, exact) in [
            ("m1", vec![(Param::Mass(0), 1.0)], 0.9),
            ("m2", vec![(Param::Mass(1), 1.0)], -0.6),
            ("e", both(Param::Restitution), -3.0),
            ("v1", vec![(Param::Velocity(0, 0), 1.0)], 0.1),
            ("v2", vec![(Param::Velocity(1, 0), 1.0)], 0.9),
        ] {
            let found = slope(&scene, &tape, &seed, &direction);
            near(&format!("V09 (a) d(first)/d{what}"), found, exact, 1e-10);
        }
    }
}

#[test]
fn v09_b_oblique() {
    let (sin, cos) = 30.0_f64.to_radians().sin_cos();
    let touching = oblique_collision(1.0 - 0.2 * cos, [1.0, 0.2 * sin]);
    check(
        "(b)",
        &touching,
        &[[0.5, -0.866_025_403_784_438_65, 0.0], [1.5, 0.866_025_403_784_438_65, 0.0]],
    );
    let exact = [1.879_903_810_567_665_8, 0.608_012_701_892_219_32];
    let miss = |solver: &dyn LcpSolver, dt: f64| {
        let scene = built(&with_dt(oblique_collision(0.0, [1.0, 0.1]), dt));
        let q = run(&scene, solver, steps(1.0, dt)).last().q[1];
        (q.x - exact[0]).hypot(q.y - exact[1])
    };
    for solver in backends() {
        for dt in [1e-2, 1e-3] {
            near("V09 (b) other at T=1, C=5", miss(&*solver, dt), 0.0, 5.0 * dt);
        }
        order("V09 (b) other at T=1", 0.7, |dt| miss(&*solver, dt));
    }
}

#[test]
fn v09_c_spinning_disc() {
    check("(c) mu=0.1", &spinning_disc(0.1), &[[2.36, 2.4, -2.8]]);
    check("(c) mu=0.5", &spinning_disc(0.5), &[[5.0 / 3.0, 2.4, -50.0 / 3.0]]);
}

#[test]
fn v09_d_rod() {
    check(
        "(d)",
        &rod_hit(),
        &[
            [0.0, -0.736_994_219_653_179_19, -3.537_572_254_335_260_1],
            [0.0, -0.052_023_121_387_283_237, 0.0],
        ],
    );
    for solver in backends() {
        let record = first_step(&built(&rod_hit()), &*solver);
        let impulse = record.contact_impulses()[0].normal;
        near("V09 (d) impulse", impulse, 1.473_988_439_306_358_4, 1e-10);
    }
}

#[test]
fn v09_e_head_on() {
    check("(e)", &head_on(0.3), &[[0.0, -0.6, 18.0], [1.0, 0.3, -4.0]]);
    let slip = |after: &State| {
        let v = &after.v;
        v[1].y - 0.15 * v[1].z - v[0].y - 0.1 * v[0].z
    };
    for solver in backends() {
        let after = |mu| first_step(&built(&head_on(mu)), &*solver).after;
        near("V09 (e) sticks at mu=0.3334", slip(&after(0.3334)), 0.0, 1e-10);
        assert!(slip(&after(0.333)) < -1e-4, "V09 (e) slips below mu=1/3");
    }
}

/// V24: the change of the deflection with the impact parameter b = q · 0.2, bodies kept in touch.
#[test]
fn v24_deflection_by_impact_parameter() {
    for solver in backends() {
        for (q, exact) in [
            (0.5, -5.773_502_691_896_257_6),
            (0.9, 14.223_775_499_974_829),
            (0.99, 68.066_773_304_900_413),
        ] {
            let depth = f64::sqrt(1.0 - q * q);
            let scene = built(&oblique_collision(0.0, [0.2 * depth, 0.2 * q]));
            let tape = run(&scene, &*solver, 1);
            let seed = pick(&scene, |s| s.v[0].y = 1.0);
            let direction = [(Param::Position(1, 0), -q / depth), (Param::Position(1, 1), 1.0)];
            let found = slope(&scene, &tape, &seed, &direction);
            near(&format!("V24 dv1y/db, q={q}"), found, exact, 1e-9 * exact.abs());
        }
    }
}
