//! Derivatives against each other: reverse mode against forward mode, and both against differences
//! of the engine's own rollout.

use tangency_bench::finite_difference::derivative;
use tangency_core::{Param, State, StepRecord, checkpointed_rollout, simulate};
use tangency_diff::{GradientMode, StateVector, checkpointed_gradient};
use tangency_lcp::LcpSolver;

use crate::lab::recommended;
use crate::run::Run;
use crate::{Case, Lab, Part, Stop};

use super::questions::{self, Question};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V38",
    title: "Self-consistency",
    parts: &[
        Part::new("V02", |lab| check(lab, &questions::large_pendulum())),
        Part::new("V04", |lab| check(lab, &questions::bouncing())),
        Part::new("V05", |lab| check(lab, &questions::incline())),
        Part::new("V07", |lab| check(lab, &questions::rolling())),
        Part::new("V09 (a)", |lab| check(lab, &questions::line())),
        Part::new("V09 (b)", |lab| check(lab, &questions::oblique())),
        Part::new("V12", |lab| check(lab, &questions::parallelogram())),
        Part::new("V16 (c)", |lab| check(lab, &questions::chain())),
        Part::new("V19", |lab| check(lab, &questions::heavy_stack())),
        Part::new("checkpoints", checkpoints),
    ],
}];

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
        lab.near(format!("{title}: differences"), reverse, found.value, 1e-6 * scale);
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

/// The gradient by everything, read off few records and off all of them.
fn checkpoints(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let all = [
        questions::large_pendulum(),
        questions::bouncing(),
        questions::rolling(),
        questions::parallelogram(),
        questions::heavy_stack(),
    ];
    for question in all {
        for def in [question.def.clone(), recommended(question.def.clone())] {
            let run = lab.run(&def, f64::min(question.duration, 0.5))?;
            let (scene, solver, steps) = (&run.scene, lab.solver(), run.tape.records.len());
            let zeros = vec![0.0; scene.controls().len()];
            let control = |_: usize, _: &State| zeros.clone();
            let few =
                checkpointed_rollout(scene, solver, run.tape.initial.clone(), steps, control)?;
            let seed = weights(&run);
            let add = |k: usize, _: &State, bar: &mut StateVector| {
                if k == steps {
                    bar.add(&seed);
                }
            };
            let found = checkpointed_gradient(scene, solver, &few, GradientMode::Exact, add)?;
            let stepping = if def.stepping == question.def.stepping { "" } else { ", accurate" };
            let title = format!("{}{stepping}: checkpointed reverse is the full one", def.name);
            lab.holds(title, found.by == run.gradient(&seed)?.by);
            let most = 2.0 * (steps as f64).sqrt() + 2.0;
            let held = few.most_records() as f64;
            lab.at_least(
                format!("{}{stepping}: 2 √T + 2 less records held", def.name),
                most - held,
                0.0,
            );
        }
    }
    Ok(())
}
