//! Impulses as results: their derivatives, in closed form and against differences.

use tangency::diff::{Gradient, RolloutVector, RowImpulse};
use tangency::{
    BodyDef, LcpSolver, Param, Rollout, RowSource, Scene, SceneDef, StepRecord,
    gradient_with_impulses, rollout, simulate, tangent_with_impulses,
};
use tangency_bench::finite_difference::derivative;
use tangency_bench::scenes::{
    block, disc, doubled_hinge, floor, material, pendulum, rod_hit, sliding_box, stack,
};
use tangency_bench::signature::signature;

use crate::accurate::accurate;
use crate::engine::{backends, built, near, near_relative, with_dt};
use crate::gradients::battery::battery;
use crate::gradients::numbers::{controls, numbers};
use crate::impacts::resolved;

const G: f64 = 9.81;

/// The gradient of a sum of impulses, each with its weight.
fn of(
    scene: &Scene,
    tape: &Rollout,
    weights: impl Fn(usize, &StepRecord) -> Vec<RowImpulse>,
) -> Gradient {
    gradient_with_impulses(scene, tape, |_, _| None, weights)
        .unwrap_or_else(|error| panic!("{}: {error}", scene.def().name))
}

/// Normal rows of the contacts of a body with a later one, of what was left of the step.
fn normals(record: &StepRecord, body: u32) -> Vec<RowImpulse> {
    let at = |contact: &u32| record.contacts[*contact as usize].feature.id.bodies[0] == body;
    let contacts = (0..).take(record.contacts.len()).filter(at);
    let row =
        |contact| RowImpulse { part: None, source: RowSource::Normal { contact }, value: 1.0 };
    contacts.map(row).collect()
}

/// V19: the floor carries all masses; its force by each of them is g, and that on the top box by the
/// lower one is 0. How two corners share the friction they do not need is nobody's choice.
#[test]
fn floor_under_a_stack() {
    let last = 4;
    for solver in backends() {
        for top in [1.0, 1e3, 1e6] {
            let scene = built(&stack(&[1.0, top]));
            let tape = simulate(&scene, &*solver, last + 1).expect("a run");
            let dt = scene.dt();
            let at_end = |body: u32| {
                move |k: usize, record: &StepRecord| {
                    if k == last { normals(record, body) } else { Vec::new() }
                }
            };
            let record = &tape.records[last];
            let sum = |body| -> f64 {
                let rows = normals(record, body);
                rows.iter().map(|it| record.impulse(it.source).expect("a row")).sum()
            };
            near_relative("floor force", sum(0) / dt, (1.0 + top) * G, 1e-9);
            let floor = of(&scene, &tape, at_end(0));
            near_relative("by the top mass", floor.by.by(&scene, Param::Mass(2)) / dt, G, 1e-8);
            near_relative("by the lower mass", floor.by.by(&scene, Param::Mass(1)) / dt, G, 1e-8);
            let gravity = floor.by.by(&scene, Param::Gravity(1)) / dt;
            near_relative("by gravity", gravity, -(1.0 + top), 1e-8);
            assert_eq!(floor.report.undetermined_impulses, Vec::<usize>::new());
            let between = of(&scene, &tape, at_end(1));
            near_relative("between, top", between.by.by(&scene, Param::Mass(2)) / dt, G, 1e-8);
            near("between, lower", between.by.by(&scene, Param::Mass(1)) / dt, 0.0, 1e-7);
            let one = |k: usize, _: &StepRecord| {
                let source = RowSource::Tangent { contact: 0 };
                let seed = RowImpulse { part: None, source, value: 1.0 };
                if k == last { vec![seed] } else { Vec::new() }
            };
            assert_eq!(of(&scene, &tape, one).report.undetermined_impulses, [last]);
        }
    }
}

/// V02 and V22 (b), first step from rest at φ: F = (−¾ m g sin φ cos φ, m g (1 − ¾ sin² φ)), shared by
/// the hinges; by m, by g, and by φ when the rod turns about the hinge.
#[test]
fn hinge_of_a_pendulum() {
    let angle = 2.5_f64;
    let (sin, cos) = angle.sin_cos();
    let force = [-0.75 * G * sin * cos, G * (1.0 - 0.75 * sin * sin)];
    let by_angle = [-0.75 * G * (2.0 * angle).cos(), -0.75 * G * (2.0 * angle).sin()];
    for solver in backends() {
        for hinges in [1, 2] {
            let scene = built(&with_dt(doubled_hinge(angle, hinges), 1e-3));
            let tape = simulate(&scene, &*solver, 1).expect("a run");
            for row in 0..2 {
                let sources = (0..).take(hinges).map(|joint| RowSource::Held { joint, row });
                let sources: Vec<RowSource> = sources.collect();
                let impulse = |s: &RowSource| tape.records[0].impulse(*s).expect("a row");
                let dt = scene.dt();
                let found = sources.iter().map(impulse).sum::<f64>() / dt;
                let exact = force[row as usize];
                near_relative("hinge force", found, exact, 1e-9);
                let seed =
                    |source: &RowSource| RowImpulse { part: None, source: *source, value: 1.0 };
                let seeds: Vec<RowImpulse> = sources.iter().map(seed).collect();
                let Gradient { by, report } = of(&scene, &tape, |_, _| seeds.clone());
                assert_eq!(report.undetermined_impulses, Vec::<usize>::new());
                let by_mass =
                    by.by(&scene, Param::Mass(0)) + by.by(&scene, Param::Inertia(0)) / 12.0;
                near_relative("by mass", by_mass / dt, exact, 1e-8);
                let by_gravity = by.by(&scene, Param::Gravity(1)) / dt;
                near_relative("by gravity", by_gravity, -exact / G, 1e-8);
                let place = |axis: usize| by.by(&scene, Param::Position(0, axis)) / dt;
                let turned = place(2) + 0.5 * (cos * place(0) + sin * place(1));
                near_relative("by the angle", turned, by_angle[row as usize], 1e-6);
            }
        }
    }
}

/// V09 (d): the impulse of an impact, P = (1 + e) v/K with K = 1/m + 1/M + d²/I, is that of a part.
#[test]
fn impulse_of_an_impact() {
    let (m, rod, d, inertia, e, v) = (0.5_f64, 2.0_f64, 0.4, 2.0 / 12.0, 0.7, 3.0);
    let k = 1.0 / m + 1.0 / rod + d * d / inertia;
    let exact = (1.0 + e) * v / k;
    for solver in backends() {
        let mut def = resolved(with_dt(rod_hit(), 0.01));
        def.bodies[1].position[1] = 0.2;
        let scene = built(&def);
        let tape = simulate(&scene, &*solver, 10).expect("a run");
        let hit = |(step, record): (usize, &StepRecord)| {
            let part = record.parts.iter().position(|part| part.hit.is_some())?;
            Some((step, part))
        };
        let (step, part) = tape.records.iter().enumerate().find_map(hit).expect("an impact");
        let source = tape.records[step].parts[part].hit.expect("a row");
        let found = tape.records[step].parts[part].impulse(source).expect("a row");
        near_relative("impulse", found, 1.473_988_439_306_358_4, 1e-10);
        near_relative("closed form", exact, 1.473_988_439_306_358_4, 1e-14);
        let Gradient { by, .. } = of(&scene, &tape, |k, _| {
            let seed = RowImpulse { part: Some(part), source, value: 1.0 };
            if k == step { vec![seed] } else { Vec::new() }
        });
        near_relative("by speed", by.by(&scene, Param::Velocity(1, 1)), -exact / v, 1e-8);
        let by_e = by.by(&scene, Param::Restitution(1)) / scene.pair_restitution(0, 1).d[1];
        near_relative("by restitution", by_e, exact / (1.0 + e), 1e-8);
        let by_mass = by.scene.bodies[1].mass.y;
        near_relative("by the disc's mass", by_mass, exact / (k * m * m), 1e-8);
        let by_inertia = by.by(&scene, Param::Inertia(0));
        near_relative("by the rod's", by_inertia, exact * d * d / (k * inertia * inertia), 1e-8);
        let by_place = by.by(&scene, Param::Position(1, 0));
        near_relative("by where it hits", by_place, -exact * 2.0 * d / (k * inertia), 1e-8);
        near("by when it hits", by.by(&scene, Param::Position(1, 1)), 0.0, 1e-8);
    }
}

/// A disc falls onto a floor at τ = √(2 (y − r)/g) within a step, on which a box presses all the while:
/// with m g τ before the impact, and m g (dt − τ) after it; dτ/dy = 1/(g τ).
#[test]
fn impulses_that_the_time_of_an_impact_divides() {
    let (mass, dt) = (2.0, 0.1);
    let (y, r) = (0.11, 0.1);
    let tau = (2.0_f64 * (y - r) / G).sqrt();
    let ball = BodyDef { mass: Some(1.0), ..disc("ball", r, [3.0, y]) };
    let slab = BodyDef { mass: Some(mass), ..block("slab", [1.0, 0.2], [0.0, 0.1]) };
    let bodies = vec![floor(), slab, ball];
    let def = material(SceneDef { dt, bodies, ..SceneDef::default() }, 0.0, 0.9);
    for solver in backends() {
        let scene = built(&resolved(def.clone()));
        let tape = simulate(&scene, &*solver, 1).expect("a run");
        let record = &tape.records[0];
        let pressing = |part: Option<usize>| {
            let owner = part.map_or(record, |part| &record.parts[part]);
            let slab = |c: &u32| owner.contacts[*c as usize].feature.id.bodies == [0, 1];
            let contacts = (0..).take(owner.contacts.len()).filter(slab);
            let row =
                |contact| RowImpulse { part, source: RowSource::Normal { contact }, value: 1.0 };
            contacts.map(row).collect::<Vec<_>>()
        };
        for (part, exact, sign) in
            [(Some(0), mass * G * tau, 1.0), (None, mass * G * (dt - tau), -1.0)]
        {
            let owner = part.map_or(record, |part: usize| &record.parts[part]);
            let rows = pressing(part);
            let found: f64 = rows.iter().map(|it| owner.impulse(it.source).expect("a row")).sum();
            near_relative("impulse", found, exact, 1e-9);
            let by = of(&scene, &tape, |_, _| rows.clone()).by;
            let by_height = by.by(&scene, Param::Position(2, 1));
            near_relative("by the height", by_height, sign * mass / tau, 1e-7);
            let mut along = RolloutVector::zeros(&scene, 1);
            along.add(&scene, Param::Position(2, 1), 1.0);
            let (_, pushed) = tangent_with_impulses(&scene, &tape, &along).expect("a tangent");
            let same =
                |it: &&RowImpulse| rows.iter().any(|r| (r.part, r.source) == (it.part, it.source));
            let forward: f64 = pushed[0].iter().filter(same).map(|it| it.value).sum();
            near_relative("forwards", forward, by_height, 1e-12);
        }
    }
}

/// A weight for every row, such that it is the same in every run with the same rows.
fn weights(k: usize, record: &StepRecord) -> Vec<RowImpulse> {
    let own = |part: Option<usize>, record: &StepRecord| -> Vec<RowImpulse> {
        let sources = record.islands.iter().flat_map(|island| &island.sources);
        let phase = 1.7 * part.map_or(0.0, |part| part as f64 + 1.0) + 0.37 * k as f64;
        let seed = |(i, source): (usize, &RowSource)| RowImpulse {
            part,
            source: *source,
            value: (3.1 * i as f64 + phase).sin(),
        };
        sources.enumerate().map(seed).collect()
    };
    let parts = record.parts.iter().enumerate().flat_map(|(k, part)| own(Some(k), part));
    parts.chain(own(None, record)).collect()
}

/// Which impulses a run has.
fn rows(tape: &Rollout) -> Vec<Vec<(Option<usize>, RowSource)>> {
    let of =
        |record: &StepRecord| weights(0, record).iter().map(|it| (it.part, it.source)).collect();
    tape.records.iter().map(of).collect()
}

fn weighted(tape: &Rollout) -> f64 {
    let of = |(k, record): (usize, &StepRecord)| -> f64 {
        let value = |it: &RowImpulse| {
            let owner = it.part.map_or(record, |part| &record.parts[part]);
            it.value * owner.impulse(it.source).expect("a row")
        };
        weights(k, record).iter().map(value).sum()
    };
    tape.records.iter().enumerate().map(of).sum()
}

fn scenes() -> Vec<(SceneDef, usize)> {
    let flat = battery().into_iter().filter(|entry| entry.except.is_empty());
    let mut all: Vec<(SceneDef, usize)> = flat.map(|entry| (entry.def, entry.steps)).collect();
    all.push((resolved(with_dt(rod_hit(), 0.01)), 12));
    all.push((resolved(with_dt(pendulum(2.0), 0.01)), 12));
    all.push((accurate(pendulum(2.0), 0.01), 12));
    all.push((accurate(rod_hit(), 0.01), 12));
    all.push((accurate(sliding_box(1.5, 0.3, 0.2), 0.01), 12));
    all
}

/// What is wrong with the derivative of weighted impulses by every fifth number, and how many differences
/// it was compared with.
fn defects(def: &SceneDef, steps: usize, solver: &dyn LcpSolver) -> (usize, Vec<String>) {
    let scene = built(def);
    let controls = controls(scene.controls().len(), steps);
    let play = |scene: &Scene| {
        rollout(scene, solver, scene.initial_state(), steps, |k, _| controls[k].clone())
            .unwrap_or_else(|error| panic!("{}: {error}", scene.def().name))
    };
    let tape = play(&scene);
    let Gradient { by, report } = of(&scene, &tape, weights);
    let unique = report.undetermined_impulses.is_empty();
    let (modes, known) = (signature(&tape), rows(&tape));
    let scale = weighted(&tape).abs().max(1e-3);
    let (mut compared, mut found) = (0, Vec::new());
    for param in numbers(&scene).into_iter().step_by(5) {
        let mut along = RolloutVector::zeros(&scene, steps);
        along.add(&scene, param, 1.0);
        let (_, pushed) = tangent_with_impulses(&scene, &tape, &along).expect("a tangent");
        let term = |(k, record)| -> f64 {
            let pairs = weights(k, record);
            let at = |it: &RowImpulse| {
                let same = |p: &&RowImpulse| (p.part, p.source) == (it.part, it.source);
                it.value * pushed[k].iter().find(same).map_or(0.0, |p| p.value)
            };
            pairs.iter().map(at).sum()
        };
        let forward: f64 = tape.records.iter().enumerate().map(term).sum();
        let reverse = by.by(&scene, param);
        let apart = (forward - reverse).abs() / reverse.abs().max(scale);
        if unique && apart > 1e-11 {
            found.push(format!("{}, {param:?}: {reverse}, forwards {forward}", scene.def().name));
        }
        let x = scene.get(param).expect("a number");
        let mut crossed = false;
        let value = |x: f64| {
            let mut changed = scene.clone();
            changed.set(param, x).expect("a value near a good one");
            let tape = play(&changed);
            crossed |= signature(&tape) != modes || rows(&tape) != known;
            weighted(&tape)
        };
        let length = if x.abs() < 1e-3 { 0.1 } else { x.abs() };
        let difference = derivative(value, x, 3e-4 * length).value;
        let off = (difference - reverse).abs() / difference.abs().max(scale);
        compared += usize::from(unique && !crossed);
        if unique && !crossed && off > 1e-7 {
            found.push(format!("{}, {param:?}: {reverse}, not {difference}", scene.def().name));
        }
    }
    (compared, found)
}

#[test]
fn impulses_of_every_scene() {
    for solver in backends() {
        let (mut compared, mut all) = (Vec::new(), Vec::new());
        for (def, steps) in scenes() {
            let (count, found) = defects(&def, steps, &*solver);
            compared.push(count);
            all.extend(found);
        }
        assert!(all.is_empty(), "{}", all.join("\n"));
        let scenes = compared.iter().filter(|count| **count > 0).count();
        assert!(scenes >= 10 && compared.iter().sum::<usize>() >= 60, "{compared:?}");
    }
}

#[test]
fn a_row_that_is_not_there_is_refused() {
    let (solver, scene) = (&backends()[0], built(&pendulum(2.0)));
    let tape = simulate(&scene, &**solver, 2).expect("a run");
    for (part, source) in
        [(None, RowSource::Normal { contact: 0 }), (Some(3), RowSource::Held { joint: 0, row: 0 })]
    {
        let seed = vec![RowImpulse { part, source, value: 1.0 }];
        let error = gradient_with_impulses(&scene, &tape, |_, _| None, |_, _| seed.clone());
        let message = error.expect_err("no such row").to_string();
        assert!(message.contains("has no row"), "{message}");
    }
}
