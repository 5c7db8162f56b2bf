//! Events between smooth flows, against closed forms.

use std::f64::consts::FRAC_PI_2;

use tangency::{
    BodyDef, JointDef, JointKind, Limits, Motor, Rollout, SceneDef, State, StepRecord, Stepping,
    WORLD,
};
use tangency_bench::scenes::{
    conveyor, disc, falling_disc, groove, hinge, incline_block, ladder, rocking_box, rod,
    sliding_disc, unit_scene,
};

use super::accurate;
use crate::engine::{backends, built, near, run, steps};

/// The parts of a run in the order of time.
fn parts(tape: &Rollout) -> impl Iterator<Item = &StepRecord> {
    tape.records.iter().flat_map(|record| record.parts.iter().chain([record]))
}

/// The first state of a run, ends of parts included, of which something is true.
fn first(tape: &Rollout, holds: impl Fn(&State) -> bool) -> f64 {
    let states = parts(tape).map(|part| &part.after);
    states.into_iter().find(|state| holds(state)).map_or(f64::NAN, |state| state.time)
}

#[track_caller]
fn nothing_fell_back(tape: &Rollout) {
    assert!(tape.records.iter().all(|record| !record.fell_back()), "a step fell back");
}

/// V05 (b): up a slope until it stops and stays.
#[test]
fn a_block_stops_on_a_slope() {
    for solver in backends() {
        for dt in [0.02, 1e-3] {
            let def = incline_block(30.0_f64.to_radians(), 0.7, 3.0);
            let tape = run(&built(&accurate(def, dt)), &*solver, steps(0.5, dt));
            nothing_fell_back(&tape);
            let d = tape.last().q[1] - tape.initial.q[1];
            near("way", d.xy().norm(), 0.414_670_242_627_784_71, 1e-12);
            let stop = first(&tape, |state| state.v[1].norm() < 1e-11);
            near("time", stop, 0.276_446_828_418_523_14, 1e-12);
        }
    }
}

/// V07: a disc slides, then rolls.
#[test]
fn sliding_turns_to_rolling() {
    for solver in backends() {
        for dt in [0.05, 1e-3] {
            let tape = run(&built(&accurate(sliding_disc(), dt)), &*solver, steps(2.0, dt));
            nothing_fell_back(&tape);
            near("x(2)", tape.last().q[1].x, 5.695_775_285_989_353_3, 1e-11);
            near("v(2)", tape.last().v[1].x, 8.0 / 3.0, 1e-12);
            let rolls = first(&tape, |s| (s.v[1].x + 0.25 * s.v[1].z).abs() < 1e-11);
            near("rolls from", rolls, 0.543_662_928_984_029_9, 1e-11);
        }
    }
}

/// V11: a ladder leaves its wall by itself.
#[test]
fn a_ladder_leaves_the_wall() {
    const WALL: u32 = 1;
    for solver in backends() {
        let def = accurate(ladder(70.0_f64.to_radians()), 2e-3);
        let tape = run(&built(&def), &*solver, 400);
        let pushes = |part: &&StepRecord| {
            let of_wall = |contact: usize| part.contacts[contact].feature.id.bodies.contains(&WALL);
            part.contact_impulses().iter().any(|it| of_wall(it.contact) && it.normal > 0.0)
        };
        let pushed = parts(&tape).filter(pushes).last().expect("a push of the wall");
        near("leaves at", pushed.after.time, 0.597_527_806_071_165_34, 1e-8);
        near("angle", -pushed.after.q[2].z, 0.677_005_474_853_489_02, 1e-8);
        near("vx", tape.last().v[2].x, 1.344_952_577_225_293_9, 1e-10);
    }
}

/// V15 (b): a box on a belt slips, then rides along.
#[test]
fn a_box_rides_along() {
    for solver in backends() {
        let tape = run(&built(&accurate(conveyor(), 0.01)), &*solver, 100);
        near("x(1)", tape.last().q[1].x, 1.490_316_004_077_472, 1e-12);
        let rides = first(&tape, |state| (state.v[1].x - 2.0).abs() < 1e-11);
        near("rides from", rides, 0.509_683_995_922_528_03, 1e-12);
    }
}

/// V17 (a): a rocking block, impact by impact.
#[test]
fn a_block_rocks() {
    let tilt = 0.160_875_277_198_321_07;
    for solver in backends() {
        let tape = run(&built(&accurate(rocking_box(tilt), 1e-3)), &*solver, 1000);
        nothing_fell_back(&tape);
        let hits = parts(&tape).filter(|part| part.hit.is_some());
        let times = [0.273_858_974_782_351_64, 0.666_850_965_033_691_34, 0.973_757_194_456_258_35];
        for (hit, exact) in hits.zip(times) {
            near("impact", hit.after.time, exact, 1e-8);
        }
    }
}

/// V18: a disc spins down in a groove, at both walls.
#[test]
fn a_disc_spins_down_in_a_groove() {
    for solver in backends() {
        let tape = run(&built(&accurate(groove(0.3), 0.01)), &*solver, 60);
        nothing_fell_back(&tape);
        let body = tape.initial.v.len() - 1;
        near("w(0.3)", tape.state(30).v[body].z.abs(), 8.544_870_144_777_93, 1e-10);
        let rests = first(&tape, |state| state.v[body].z.abs() < 1e-10);
        near("rests from", rests, 0.523_782_800_878_924_09, 1e-10);
        near("stays", tape.last().v[body].norm(), 0.0, 1e-12);
    }
}

/// V04: bounces until they come to rest.
#[test]
fn bounces_come_to_rest() {
    for solver in backends() {
        let tape = run(&built(&accurate(falling_disc(1.0, 0.8), 1e-3)), &*solver, 5000);
        nothing_fell_back(&tape);
        for (step, gap) in [
            (1000, 0.468_004_452_526_036_31),
            (2000, 0.260_741_728_327_057_2),
            (3000, 0.068_707_460_965_765_722),
        ] {
            near("gap", tape.state(step).q[1].y - 0.1, gap, 1e-11);
        }
        near("gap(5)", tape.last().q[1].y - 0.1, 0.0, 1e-12);
    }
}

fn axle(motor: Motor, limits: Limits) -> SceneDef {
    let body = BodyDef { mass: Some(2.0), inertia: Some(0.5), ..disc("wheel", 0.3, [0.0; 2]) };
    let motor = Some(motor);
    let kind = JointKind::Revolute { anchor: [0.0; 2], anchor_b: None, limits, motor };
    let bodies = [WORLD.into(), "wheel".into()];
    let axle = JointDef { name: "axle".into(), bodies, kind, collide: false, softness: None };
    SceneDef { joints: vec![axle], ..unit_scene("wheel", vec![body]) }
}

/// ω = τ t/I until the motor's speed is reached, and that from then on: θ = ω (t − ½ t₁).
#[test]
fn a_weak_motor_reaches_its_speed() {
    for solver in backends() {
        for sign in [1.0, -1.0] {
            let motor = Motor { speed: 4.0 * sign, max: Some(1.1) };
            let def = accurate(axle(motor, Limits::default()), 0.05);
            let tape = run(&built(&def), &*solver, 50);
            nothing_fell_back(&tape);
            let reached = 4.0 * 0.5 / 1.1;
            near("speed", tape.last().v[0].z, 4.0 * sign, 1e-14);
            near("angle", tape.last().q[0].z, 4.0 * sign * (2.5 - 0.5 * reached), 1e-13);
        }
    }
}

/// A motor drives its joint into a limit, where it stays.
#[test]
fn a_limit_stops_a_motor() {
    let limits = Limits { lower: None, upper: Some(0.25) };
    for solver in backends() {
        let def = accurate(axle(Motor { speed: 4.0, max: Some(1.0) }, limits), 0.01);
        let tape = run(&built(&def), &*solver, 100);
        nothing_fell_back(&tape);
        // ½ (τ/I) t² = 0.25
        near("reached at", first(&tape, |s| s.time > 0.1 && s.v[0].z.abs() < 1e-13), 0.5, 1e-12);
        near("angle", tape.last().q[0].z, 0.25, 1e-13);
        near("rate", tape.last().v[0].z, 0.0, 1e-13);
    }
}

/// A hanging rod is given a velocity that its hinge does not allow: the hinge takes it away at once.
#[test]
fn velocities_that_contradict_a_joint() {
    let hung = BodyDef { velocity: [0.0, 1.0], ..rod("rod", 1.0, 1.0, [0.0, -0.5], -FRAC_PI_2) };
    let joints = vec![hinge("pin", WORLD, "rod", [0.0, 0.0])];
    let def = SceneDef { bodies: vec![hung], joints, ..SceneDef::default() };
    for solver in backends() {
        let tape = run(&built(&accurate(def.clone(), 0.01)), &*solver, 10);
        near("speed", tape.last().v[0].norm(), 0.0, 1e-12);
    }
}

/// More events than a step is divided for: its rest is of fixed length, and its record says so.
#[test]
fn a_step_of_many_events_falls_back() {
    for solver in backends() {
        for (max_events, falls) in [(0, true), (1, false)] {
            let stepping = Stepping::Accurate { max_events };
            let def = SceneDef { stepping, dt: 0.6, ..falling_disc(1.0, 0.8) };
            let record = run(&built(&def), &*solver, 1).records.remove(0);
            assert_eq!(record.fell_back(), falls, "{max_events} events");
        }
    }
}
