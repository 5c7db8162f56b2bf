//! Impacts between flights, against the motion's closed form.

use tangency::{BodyDef, SceneDef, Stepping};
use tangency_bench::scenes::{billiard, disc, fixed_block, floor, material, plane, unit_scene};

use super::{bounced, dropped, resolved};
use crate::engine::{backends, built, near, run, steps, with_dt};

/// One and two bounces and five: heights of the closed form at every dt.
#[test]
fn heights_are_those_of_the_motion() {
    for solver in backends() {
        for dt in [0.05, 0.005, 0.0007] {
            let scene = built(&with_dt(dropped(0.1, 1.0, 0.0, 0.5), dt));
            let rollout = run(&scene, &*solver, steps(0.98, dt));
            for state in rollout.states().filter(|state| state.time > 0.44) {
                let exact = bounced([1.0, 0.0, 0.5, 9.81, 0.1], [0.0; 5], state.time)[0];
                near("height", state.q[1].y, exact, 1e-12);
            }
        }
        let scene = built(&dropped(0.1, 1.0, 0.0, 0.5));
        near("after 0.75 s", run(&scene, &*solver, 150).last().q[1].y, 0.268_348, 5e-7);
    }
}

/// V28: 1000 m/s onto a wall as thin as the disc.
#[test]
fn nothing_tunnels() {
    let shot =
        BodyDef { mass: Some(1.0), velocity: [1000.0, 0.0], ..disc("shot", 0.01, [0.0, 0.0]) };
    let wall = fixed_block("wall", [0.01, 2.0], [5.005, 0.0]);
    let def = SceneDef { dt: 1.0 / 60.0, ..unit_scene("shot", vec![wall, shot]) };
    let def = resolved(material(def, 0.0, 0.5));
    for solver in backends() {
        let record = run(&built(&def), &*solver, 1).records.remove(0);
        near("time of impact", record.parts[0].dt, 4.99e-3, 1e-15);
        near("speed", record.after.v[1].x, -500.0, 1e-9);
        near("place", record.after.q[1].x, 4.99 - 500.0 * (1.0 / 60.0 - 4.99e-3), 1e-9);
    }
}

/// Beside a wall, past its corner: features are chosen on the way, and nothing is hit.
#[test]
fn what_passes_a_wall_is_not_stopped() {
    let shot =
        BodyDef { mass: Some(1.0), velocity: [1000.0, 0.0], ..disc("shot", 0.01, [0.0, 1.0101]) };
    let wall = fixed_block("wall", [0.01, 2.0], [5.005, 0.0]);
    let def = SceneDef { dt: 1.0 / 60.0, ..unit_scene("passed", vec![wall, shot]) };
    for solver in backends() {
        let record = run(&built(&resolved(def.clone())), &*solver, 1).records.remove(0);
        assert!(record.parts.is_empty(), "{} parts", record.parts.len());
        near("place", record.after.q[1].x, 1000.0 / 60.0, 1e-12);
    }
}

/// e = 1: energy stays for a thousand bounces, some of them with others in one step.
#[test]
fn elastic_bounces_keep_their_energy() {
    for solver in backends() {
        let scene = built(&with_dt(dropped(0.1, 0.2, 0.0, 1.0), 0.01));
        let energy = scene.energy(&scene.initial_state());
        let rollout = run(&scene, &*solver, 28600);
        let counts = rollout.records.iter().map(|record| record.counts(&scene).impacts);
        let bounces: usize = counts.sum();
        assert!(bounces >= 1000, "{bounces} bounces");
        near("energy", scene.energy(rollout.last()), energy, 1e-10 * energy);
        let fall = (2.0 * 0.1 / 9.81_f64).sqrt();
        assert_eq!(bounces, 1 + steps(286.0 - 2.0 * fall, 2.0 * fall), "period of the motion");
    }
}

/// V10: 9 + 12 impacts with four walls, and where the disc then is.
#[test]
fn a_billiard_ball_goes_its_way() {
    for solver in backends() {
        let scene = built(&with_dt(resolved(billiard([0.3, 0.4], [1.7, 1.1])), 0.02));
        let rollout = run(&scene, &*solver, 500);
        let [x, y, _] = rollout.last().q[4].into();
        near("x", x, 1.8, 1e-10);
        near("y", y, 0.6, 1e-10);
        let impacts = rollout.records.iter().map(|record| record.counts(&scene).impacts);
        assert_eq!(impacts.sum::<usize>(), 21);
    }
}

/// V08: five discs in a row, apart and touching.
#[test]
fn rows_of_discs_pass_speed_on() {
    let row = |gap: f64| {
        let place = |i: usize| if i == 0 { -0.5 } else { (0.2 + gap) * (i - 1) as f64 };
        let ball = |i: usize| BodyDef {
            mass: Some(1.0),
            velocity: [if i == 0 { 1.0 } else { 0.0 }, 0.0],
            ..disc(&format!("ball{i}"), 0.1, [place(i), 0.0])
        };
        let def = unit_scene("row", (0..5).map(ball).collect());
        built(&resolved(with_dt(material(def, 0.0, 1.0), 0.01)))
    };
    for solver in backends() {
        for (gap, speeds) in [(0.01, [0.0, 0.0, 0.0, 0.0, 1.0]), (0.0, [-0.6, 0.4, 0.4, 0.4, 0.4])]
        {
            let rollout = run(&row(gap), &*solver, 60);
            for (v, exact) in rollout.last().v.iter().zip(speeds) {
                near("speed", v.x, exact, 1e-10);
            }
        }
    }
}

/// More impacts than a step is divided for: its rest is of fixed length, and its record says so.
#[test]
fn a_step_of_many_impacts_falls_back() {
    let ball = BodyDef { mass: Some(1.0), velocity: [20.0, 0.0], ..disc("ball", 0.1, [0.0, 0.0]) };
    let walls = [plane("left", [1.0, 0.0], -0.15), plane("right", [-1.0, 0.0], -0.15)];
    let bodies = walls.into_iter().chain([ball]).collect();
    let def = material(with_dt(unit_scene("slot", bodies), 0.1), 0.0, 1.0);
    for solver in backends() {
        for (max_impacts, falls) in [(3, true), (30, false)] {
            let stepping = Stepping::ImpactResolved { max_impacts };
            let scene = built(&SceneDef { stepping, ..def.clone() });
            let record = run(&scene, &*solver, 1).records.remove(0);
            assert_eq!(record.fell_back(), falls);
            assert_eq!(record.counts(&scene).impacts, if falls { 3 } else { 20 });
            let [x, v] = [record.after.q[2].x, record.after.v[2].x];
            assert!(x.abs() <= 0.05 + 1e-9, "{x} is out of the slot");
            assert!(falls || (v.abs() - 20.0).abs() < 1e-12, "speed {v}");
        }
    }
}

/// A box that lands flat touches with two corners at once: one impact, without a turn.
#[test]
fn a_box_lands_flat() {
    let fallen =
        BodyDef { mass: Some(1.0), ..tangency_bench::scenes::block("box", [0.4, 0.2], [0.0, 0.6]) };
    let def = SceneDef { dt: 0.005, bodies: vec![floor(), fallen], ..SceneDef::default() };
    let scene = built(&resolved(material(def, 0.3, 0.5)));
    for solver in backends() {
        let rollout = run(&scene, &*solver, 100);
        let impacts: Vec<_> = rollout.records.iter().flat_map(|r| &r.parts).collect();
        assert_eq!(impacts.iter().filter(|part| part.hit.is_some()).count(), 1);
        let exact = bounced([0.6, 0.0, 0.5, 9.81, 0.1], [0.0; 5], 0.5)[0];
        near("height", rollout.last().q[1].y, exact, 1e-12);
        near("angle", rollout.last().q[1].z, 0.0, 1e-12);
    }
}
