//! Derivatives against each other: reverse mode against forward mode, and both against differences
//! of the engine's own rollout.

use tangency_bench::finite_difference::derivative;
use tangency_bench::scenes::{
    falling_disc, hanging_chain_hit, hinge, incline_block, line_collision, oblique_collision,
    pendulum, rod, slender_inertia, sliding_disc, stack,
};
use tangency_core::{Param, SceneDef, StepRecord, WORLD, simulate};
use tangency_diff::StateVector;
use tangency_lcp::LcpSolver;

use crate::run::{Run, by_friction, by_restitution};
use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V38",
    title: "Self-consistency",
    parts: &[
        Part::new("V02", |lab| check(lab, &large_pendulum())),
        Part::new("V04", |lab| check(lab, &bouncing())),
        Part::new("V05", |lab| check(lab, &incline())),
        Part::new("V07", |lab| check(lab, &rolling())),
        Part::new("V09 (a)", |lab| check(lab, &line())),
        Part::new("V09 (b)", |lab| check(lab, &oblique())),
        Part::new("V12", |lab| check(lab, &parallelogram())),
        Part::new("V16 (c)", |lab| check(lab, &chain())),
        Part::new("V19", |lab| check(lab, &heavy_stack())),
        Part::new("checkpoints", checkpoints),
    ],
}];

/// A run, and what it is differentiated by.
struct Question {
    def: SceneDef,
    duration: f64,
    by: Vec<(&'static str, Vec<(Param, f64)>)>,
}

/// No number of the last state is left out: each has its own weight.
fn weights(run: &Run) -> StateVector {
    run.pick(|seed| {
        let numbers = seed.q.iter_mut().chain(&mut seed.v).flat_map(|x| x.iter_mut());
        numbers.enumerate().for_each(|(i, x)| *x = 0.3 + (1.7 * i as f64).sin());
    })
}

fn check(lab: &mut Lab<'_>, question: &Question) -> Result<(), Stop> {
    let run = lab.run(&question.def, question.duration)?;
    let seed = weights(&run);
    let name = &question.def.name;
    for (what, direction) in &question.by {
        let reverse = run.slope(&seed, direction)?;
        let forward = run.tangent(direction)?.last().map_or(f64::NAN, |change| change.dot(&seed));
        let scale = reverse.abs().max(1.0);
        let title = format!("{name}, d/d{what}");
        lab.near(format!("{title}: forward"), forward, reverse, 1e-12 * scale);
        let mut sides = Sides { run: &run, solver: lab.solver(), direction, switched: false };
        let found = derivative(|h| sides.at(h, &seed), 0.0, STEP);
        lab.holds(format!("{title}: same contacts on both sides"), !sides.switched);
        lab.near(format!("{title}: differences"), found.value, reverse, 1e-6 * scale);
    }
    Ok(())
}

/// The largest step of the differences, in units of the direction.
const STEP: f64 = 1e-5;

/// The same run with its numbers moved along a direction.
struct Sides<'a> {
    run: &'a Run,
    solver: &'a dyn LcpSolver,
    direction: &'a [(Param, f64)],
    switched: bool,
}

impl Sides<'_> {
    /// The weighted last state at a distance along the direction; NaN where there is none.
    fn at(&mut self, h: f64, seed: &StateVector) -> f64 {
        let mut scene = self.run.scene.clone();
        for (param, rate) in self.direction {
            let value = scene.get(*param).unwrap_or(f64::NAN);
            if scene.set(*param, value + h * rate).is_err() {
                return f64::NAN;
            }
        }
        let Ok(tape) = simulate(&scene, self.solver, self.run.tape.records.len()) else {
            return f64::NAN;
        };
        let mut pairs = tape.records.iter().zip(&self.run.tape.records);
        self.switched |= !pairs.all(|(one, other)| same_contacts(one, other));
        let last = tape.last();
        let flat = |q: &[nalgebra::Vector3<f64>], by: &[nalgebra::Vector3<f64>]| -> f64 {
            q.iter().zip(by).map(|(q, by)| q.dot(by)).sum()
        };
        flat(&last.q, &seed.q) + flat(&last.v, &seed.v)
    }
}

/// Whether the same contacts act, on the same pieces of their laws.
fn same_contacts(one: &StepRecord, other: &StepRecord) -> bool {
    let acting = |record: &StepRecord| -> Vec<_> {
        let of = |contact: usize| record.contacts[contact].feature.id;
        record.contact_impulses().iter().map(|i| of(i.contact)).collect()
    };
    let modes = |record: &StepRecord| -> Vec<_> {
        record.islands.iter().flat_map(|island| island.solution.modes.clone()).collect()
    };
    acting(one) == acting(other) && modes(one) == modes(other)
}

fn one(param: Param) -> Vec<(Param, f64)> {
    vec![(param, 1.0)]
}

/// Gravity downwards.
fn gravity() -> Vec<(Param, f64)> {
    vec![(Param::Gravity(1), -1.0)]
}

fn large_pendulum() -> Question {
    let (sin, cos) = 2.5_f64.sin_cos();
    let turn = vec![
        (Param::Position(0, 2), 1.0),
        (Param::Position(0, 0), 0.5 * cos),
        (Param::Position(0, 1), 0.5 * sin),
    ];
    // The inertia m L²/12 and the way from pin to centre follow the length.
    let length = vec![
        (Param::Inertia(0), 1.0 / 6.0),
        (Param::AnchorB(0, 0), -0.5),
        (Param::Position(0, 0), 0.5 * sin),
        (Param::Position(0, 1), -0.5 * cos),
    ];
    let mass = vec![(Param::Mass(0), 1.0), (Param::Inertia(0), 1.0 / 12.0)];
    let by = vec![("start angle", turn), ("L", length), ("g", gravity()), ("m", mass)];
    Question { def: SceneDef { dt: 1e-3, ..pendulum(2.5) }, duration: 2.0, by }
}

fn bouncing() -> Question {
    let by = vec![
        ("height", one(Param::Position(1, 1))),
        ("speed", one(Param::Velocity(1, 1))),
        ("e", by_restitution(0, 1).to_vec()),
        ("g", gravity()),
        ("r", one(Param::Radius(1, 0))),
    ];
    Question { def: SceneDef { dt: 1e-3, ..falling_disc(1.0, 0.8) }, duration: 2.0, by }
}

fn incline() -> Question {
    let angle = 30.0_f64.to_radians();
    let (sin, cos) = angle.sin_cos();
    let by = vec![
        ("mu", by_friction(0, 1).to_vec()),
        ("v0", vec![(Param::Velocity(1, 0), cos), (Param::Velocity(1, 1), sin)]),
        ("g", gravity()),
        ("m", one(Param::Mass(1))),
    ];
    Question { def: SceneDef { dt: 1e-3, ..incline_block(angle, 0.7, 3.0) }, duration: 0.5, by }
}

fn rolling() -> Question {
    let by = vec![
        ("v0", one(Param::Velocity(1, 0))),
        ("w0", one(Param::Velocity(1, 2))),
        ("mu", by_friction(0, 1).to_vec()),
        ("I", one(Param::Inertia(1))),
    ];
    Question { def: SceneDef { dt: 1e-3, ..sliding_disc() }, duration: 1.0, by }
}

/// The masses of two bodies, their common e and their velocities along x.
fn pair_numbers() -> Vec<(&'static str, Vec<(Param, f64)>)> {
    vec![
        ("m1", one(Param::Mass(0))),
        ("m2", one(Param::Mass(1))),
        ("v1", one(Param::Velocity(0, 0))),
        ("v2", one(Param::Velocity(1, 0))),
    ]
}

fn line() -> Question {
    let mut by = pair_numbers();
    by.push(("e", by_restitution(0, 1).to_vec()));
    Question { def: line_collision(), duration: 0.05, by }
}

fn oblique() -> Question {
    let mut by = pair_numbers();
    by.push(("b", one(Param::Position(1, 1))));
    // At e = 1 a difference would leave the range.
    let mut def = SceneDef { dt: 1e-3, ..oblique_collision(0.0, [1.0, 0.1]) };
    def.bodies.iter_mut().for_each(|body| body.restitution = 0.9);
    by.push(("e", by_restitution(0, 1).to_vec()));
    Question { def, duration: 1.0, by }
}

/// V12: three rods of 1 m and 1 kg, pinned side by side, 1.2 rad from hanging, carry a bar of 1 kg.
fn parallelogram() -> Question {
    let (sin, cos) = 1.2_f64.sin_cos();
    let (mut bodies, mut joints) = (Vec::new(), Vec::new());
    for i in 0..3 {
        let x = 0.5 * f64::from(i);
        let name = format!("crank{i}");
        bodies.push(rod(
            &name,
            1.0,
            1.0,
            [x + 0.5 * sin, -0.5 * cos],
            1.2 - 0.5 * std::f64::consts::PI,
        ));
        joints.push(hinge(&format!("top{i}"), WORLD, &name, [x, 0.0]));
        joints.push(hinge(&format!("low{i}"), &name, "bar", [x + sin, -cos]));
    }
    bodies.push(rod("bar", 1.0, 1.0, [0.5 + sin, -cos], 0.0));
    let mut turn = vec![(Param::Position(3, 0), cos), (Param::Position(3, 1), sin)];
    for i in 0..3 {
        turn.push((Param::Position(i, 0), 0.5 * cos));
        turn.push((Param::Position(i, 1), 0.5 * sin));
        turn.push((Param::Position(i, 2), 1.0));
    }
    let by = vec![
        ("start angle", turn),
        ("bar mass", one(Param::Mass(3))),
        ("crank mass", vec![(Param::Mass(0), 1.0), (Param::Inertia(0), slender_inertia(1.0, 1.0))]),
        ("g", gravity()),
    ];
    let def =
        SceneDef { name: "parallelogram".into(), dt: 1e-3, bodies, joints, ..SceneDef::default() };
    Question { def, duration: 1.0, by }
}

fn chain() -> Question {
    let inertia = slender_inertia(1.0, 0.2); // per mass
    let links = (0..10).flat_map(|i| [(Param::Mass(i), 1.0), (Param::Inertia(i), inertia)]);
    let mut def = hanging_chain_hit();
    // At e = 1 a difference would leave the range.
    def.bodies.iter_mut().for_each(|body| body.restitution = 0.9);
    let by = vec![
        ("link mass", links.collect()),
        ("disc mass", one(Param::Mass(10))),
        ("v0", one(Param::Velocity(10, 0))),
        ("e", by_restitution(9, 10).to_vec()),
    ];
    Question { def, duration: 0.01, by }
}

fn heavy_stack() -> Question {
    let by = vec![
        ("top mass", one(Param::Mass(2))),
        ("g", gravity()),
        ("mu", (0..3).map(|i| (Param::Friction(i), 1.0)).collect()),
        ("vx of the top", one(Param::Velocity(2, 0))),
    ];
    Question { def: stack(&[1.0, 1e3]), duration: 1.0, by }
}

fn checkpoints(lab: &mut Lab<'_>) -> Result<(), Stop> {
    lab.open("checkpointed reverse equals full reverse bitwise", "there are no checkpoints yet");
    Ok(())
}
